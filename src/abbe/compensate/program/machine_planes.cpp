#include "abbe/compensate/program/machine_planes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe {
namespace {

constexpr double kSameTurn = 1e-9;  // rad

InverseOptions held_axes(const Machine& machine, const WordAxes& words) {
  InverseOptions options;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (!words.moves(i)) options.held.push_back({i, 0});
  }
  options.reference.assign(machine.axes.size(), 0.0);
  return options;
}

std::vector<std::size_t> rotary_axes(const Machine& machine, const WordAxes& words) {
  std::vector<std::size_t> rotary;
  // Those of the workpiece first, and from the bed outwards.
  const std::size_t carried = machine.workpiece_axis_count();
  for (std::size_t i = carried; i-- > 0;) rotary.push_back(i);
  for (std::size_t i = carried; i < machine.axes.size(); ++i) rotary.push_back(i);
  std::erase_if(rotary, [&](std::size_t i) { return machine.axes[i].kind != AxisKind::rotary || !words.moves(i); });
  return rotary;
}

double from_whole_turn(double angle) { return std::abs(std::remainder(angle, 2 * std::numbers::pi)); }

}  // namespace

MachinePlanes::MachinePlanes(const Machine& machine, const WordAxes& words)
    : machine_(machine),
      kinematics_(machine, words, {}),
      inverse_(machine, held_axes(machine, words)),
      rotary_(rotary_axes(machine, words)),
      problem_(inverse_.problem()) {
  if (!problem_.empty()) return;
  if (!kinematics_.has_tool_centre()) {
    problem_ = "its words X, Y and Z are not three independent linear axes without a rotary axis between them";
  } else if (rotary_.empty() || rotary_.size() > 2) {
    problem_ = "words of the program move " + std::to_string(rotary_.size()) + " rotary axes, not one or two";
  }
}

Eigen::Vector3d MachinePlanes::point(const WordValues& words, const Eigen::Vector3d& tool) const {
  std::array<double, kMaxAxes> position{};
  kinematics_.axes(ProgramCoordinates::axes, tool, words, position.data());
  const RigidTransform pose = nominal_workpiece_from_tool(machine_, {position.data(), machine_.axes.size()});
  return pose * (tool - machine_.tool_offset);
}

void MachinePlanes::turn_with_workpiece(const WordValues& at_zero, const std::array<double, 3>& tool,
                                        WordValues& words) const {
  const Eigen::Vector3d length = machine_.tool_offset - Eigen::Vector3d(tool[0], tool[1], tool[2]);
  WordValues there = words;
  std::copy_n(at_zero.begin() + 3, 3, there.begin() + 3);
  const Eigen::Vector3d place = point(there, length);
  there = words;
  for (std::size_t k = 0; k < 3; ++k) there[k] = place[static_cast<Eigen::Index>(k)];
  std::array<double, kMaxAxes> position{};
  kinematics_.axes(ProgramCoordinates::tool_centre, length, there, position.data());
  for (std::size_t k = 0; k < 3; ++k) words[k] = position[kinematics_.words().axis[k]];
}

std::string MachinePlanes::turn_tool(ProgramCoordinates coordinates, const std::array<double, 3>& direction,
                                     const WordValues& at_zero, WordValues& words) const {
  Eigen::Vector3d wanted(direction[0], direction[1], direction[2]);
  if (coordinates == ProgramCoordinates::axes) {
    WordValues there{};
    std::copy_n(at_zero.begin() + 3, 3, there.begin() + 3);
    const Eigen::Vector3d zero = point(there, machine_.tool_offset);
    Eigen::Matrix3d by_word;
    for (std::size_t k = 0; k < 3; ++k) {
      there[k] = 1000;
      by_word.col(static_cast<Eigen::Index>(k)) = (point(there, machine_.tool_offset) - zero) / 1000;
      there[k] = 0;
    }
    wanted = by_word * wanted;
  }
  std::array<double, kMaxAxes> start{};
  kinematics_.axes(ProgramCoordinates::axes, machine_.tool_offset, words, start.data());
  const PoseTarget target = PoseTarget::at(point(words, machine_.tool_offset), wanted.normalized());
  InverseResult result;
  inverse_.solve(target, start.data(), result);
  const InverseSolution* best = nullptr;
  bool beyond = false;
  const auto keys = [&](const InverseSolution& solution) {
    std::array<double, 4> key{};
    for (std::size_t k = 0; k < rotary_.size(); ++k) {
      key[k] = std::abs(solution.position[rotary_[k]] - start[rotary_[k]]);
      key[2 + k] = from_whole_turn(solution.position[rotary_[k]]);
    }
    return key;
  };
  const auto is_nearer = [&](const InverseSolution& a, const InverseSolution& b) {
    const std::array<double, 4> one = keys(a), other = keys(b);
    for (std::size_t k = 0; k < one.size(); ++k) {
      if (std::abs(one[k] - other[k]) > kSameTurn) return one[k] < other[k];
    }
    return false;
  };
  for (const InverseSolution& solution : result.solutions) {
    const bool within = std::all_of(rotary_.begin(), rotary_.end(),
                                    [&](std::size_t i) { return std::abs(solution.excess[i]) <= kSameTurn; });
    beyond = beyond || !within;
    if (within && (best == nullptr || is_nearer(solution, *best))) best = &solution;
  }
  if (best == nullptr) {
    return beyond ? "the rotary axes would leave their travel" : "the rotary axes cannot turn the tool so";
  }
  for (std::size_t k = 3; k < 6; ++k) {
    const std::size_t axis = kinematics_.words().axis[k];
    if (axis != Machine::npos && machine_.axes[axis].kind == AxisKind::rotary) words[k] = best->position[axis];
  }
  return {};
}

}  // namespace abbe
