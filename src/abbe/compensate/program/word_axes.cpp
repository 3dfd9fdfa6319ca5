#include "abbe/compensate/program/word_axes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "abbe/machine/inverse_plan.h"

namespace abbe {
namespace {

constexpr const char* kNames[kAxisWords] = {"X", "Y", "Z", "A", "B", "C", "U", "V", "W"};

/// From the frame on the axis's tool side to that on its workpiece side; `factor` -1: back.
void carry(const Axis& axis, double command, double factor, Eigen::Vector3d& x) {
  const double motion = factor * chain_sign(axis) * command;
  if (axis.kind == AxisKind::linear) {
    x += motion * axis.direction;
    return;
  }
  const Eigen::Vector3d across = axis.direction.cross(x - axis.point);
  const double half = std::sin(0.5 * motion);
  x += std::sin(motion) * across + 2 * half * half * axis.direction.cross(across);
}

}  // namespace

bool WordAxes::moves(std::size_t index) const { return std::find(axis.begin(), axis.end(), index) != axis.end(); }

const char* axis_word_text(AxisWord word) { return kNames[static_cast<std::size_t>(word)]; }

WordAxes word_axes_by_name(const Machine& machine) {
  WordAxes words;
  for (std::size_t i = 0; i < kAxisWords; ++i) words.axis[i] = machine.find_axis(kNames[i]);
  return words;
}

WordKinematics::WordKinematics(const Machine& machine, const WordAxes& words, std::vector<double> rest)
    : machine_(machine), words_(words), rest_(std::move(rest)) {
  rest_.resize(machine.axes.size(), 0.0);
  Eigen::Matrix3d directions;
  std::size_t last = 0;
  first_ = machine.axes.size();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t axis = words.axis[i];
    if (axis >= machine.axes.size() || machine.axes[axis].kind != AxisKind::linear) return;
    directions.col(static_cast<Eigen::Index>(i)) = chain_sign(machine.axes[axis]) * machine.axes[axis].direction;
    first_ = std::min(first_, axis);
    last = std::max(last, axis);
  }
  for (std::size_t i = first_; i < last; ++i) {
    if (machine.axes[i].kind == AxisKind::rotary) return;
  }
  if (std::abs(directions.determinant()) < 1e-6) return;
  inverse_ = directions.inverse();
  has_tool_centre_ = true;
}

void WordKinematics::axes(ProgramCoordinates coordinates, const Eigen::Vector3d& tool, const WordValues& words,
                          double* result) const {
  std::copy(rest_.begin(), rest_.end(), result);
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (words_.axis[i] != Machine::npos) result[words_.axis[i]] = words[i];
  }
  if (coordinates == ProgramCoordinates::tool_centre && has_tool_centre_) solve_point(tool, words, result);
}

void WordKinematics::solve_point(const Eigen::Vector3d& tool, const WordValues& words, double* result) const {
  // The point from both ends of the chain to where X, Y, Z stand; what is between is theirs.
  for (std::size_t i = 0; i < 3; ++i) result[words_.axis[i]] = 0;
  Eigen::Vector3d from_tool = machine_.tool_reference + tool;
  for (std::size_t i = machine_.axes.size(); i-- > first_;) carry(machine_.axes[i], result[i], 1, from_tool);
  Eigen::Vector3d from_work = machine_.bed_from_workpiece * Eigen::Vector3d(words[0], words[1], words[2]);
  for (std::size_t i = 0; i < first_; ++i) carry(machine_.axes[i], result[i], -1, from_work);
  const Eigen::Vector3d solved = inverse_ * (from_work - from_tool);
  for (std::size_t i = 0; i < 3; ++i) result[words_.axis[i]] = solved[static_cast<Eigen::Index>(i)];
}

}  // namespace abbe
