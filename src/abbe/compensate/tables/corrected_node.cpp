#include "abbe/compensate/tables/corrected_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/errors/error_states.h"

namespace abbe {

NodeCorrection::NodeCorrection(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
                               const std::vector<double>& rest, const CorrectionOptions& options,
                               double tool_length_share)
    : machine_(machine),
      errors_(errors),
      options_(options),
      tool_length_share_(tool_length_share),
      kinematics_(machine, words, rest),
      nominal_(machine, ErrorSet{}, Body::tool, Body::workpiece) {
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (!words.moves(i)) held_.push_back(i);
  }
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] != 0 && machine.states[j].kind == StateKind::approach) approaches_.push_back(j);
  }
  problem_ = CompensatedInverse(machine, errors, options, held_).problem();
}

std::size_t NodeCorrection::tool(const std::array<double, 3>& length) {
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (tools_[i].length == length) return i;
  }
  Machine with_tool = machine_;
  // A longer tool has its functional point further from the spindle: opposite to the offset of the axes.
  const Eigen::Vector3d longer(length[0], length[1], length[2]);
  with_tool.tool_offset -= longer;
  const Eigen::Vector3d point = with_tool.tool_offset;
  ErrorSet errors = errors_;
  errors.tool_offset_error -= tool_length_share_ * longer;
  tools_.push_back({length, point, std::make_unique<CompensatedInverse>(with_tool, errors, options_, held_)});
  return tools_.size() - 1;
}

void NodeCorrection::correct(ProgramCoordinates coordinates, std::size_t tool, std::span<CorrectedNode> nodes,
                             const AxisApproach& approach) const {
  for (std::size_t first = 0; first < nodes.size(); first += ChainPlan::kBlockSize) {
    const std::size_t count = std::min(ChainPlan::kBlockSize, nodes.size() - first);
    correct_block(coordinates, tools_[tool], approach, nodes.subspan(first, count));
  }
}

CorrectedNode NodeCorrection::after(ProgramCoordinates coordinates, std::size_t tool, const CorrectedNode& node,
                                    const AxisApproach& approach) const {
  CorrectedNode result;
  result.words = node.words;
  correct_block(coordinates, tools_[tool], approach, {&result, 1});
  return result;
}

void NodeCorrection::correct_block(ProgramCoordinates coordinates, const Tool& tool, const AxisApproach& approach,
                                   std::span<CorrectedNode> nodes) const {
  using NodeLanes = std::array<double, ChainPlan::kBlockSize>;
  const std::size_t n = machine_.axes.size(), count = nodes.size();
  std::array<NodeLanes, kMaxAxes> in, out;
  std::array<const double*, kMaxAxes> commands, moved;
  std::array<double*, kMaxAxes> corrected;
  std::array<CorrectionStatus, ChainPlan::kBlockSize> status;
  NodeLanes point_left, orientation;
  for (std::size_t i = 0; i < n; ++i) {
    commands[i] = in[i].data();
    moved[i] = corrected[i] = out[i].data();
  }
  for (std::size_t k = 0; k < count; ++k) {
    CorrectedNode& node = nodes[k];
    kinematics_.axes(coordinates, tool.point, node.words, node.position.data());
    for (std::size_t i = 0; i < n; ++i) in[i][k] = node.position[i];
  }
  std::array<NodeLanes, kMaxStates> sides;
  std::array<const double*, kMaxStates> states{};
  for (const std::size_t j : approaches_) {
    std::fill_n(sides[j].begin(), count, static_cast<double>(approach[machine_.states[j].axis]));
    states[j] = sides[j].data();
  }
  const std::size_t given = approaches_.empty() ? 0 : machine_.states.size();
  tool.inverse->correct({{commands.data(), n}, count, {states.data(), given}},
                        {{corrected.data(), n}, status.data(), point_left.data(), orientation.data()});

  std::array<NodeLanes, 3> start, before, after;
  for (std::size_t i = 0; i < 3; ++i) {
    std::fill_n(start[i].begin(), count, tool.point[static_cast<Eigen::Index>(i)]);
  }
  const ConstPointArrays from{start[0].data(), start[1].data(), start[2].data()};
  nominal_.transform({{commands.data(), n}, count}, from, {before[0].data(), before[1].data(), before[2].data()});
  nominal_.transform({{moved.data(), n}, count}, from, {after[0].data(), after[1].data(), after[2].data()});

  const WordAxes& words = kinematics_.words();
  for (std::size_t k = 0; k < count; ++k) {
    CorrectedNode& node = nodes[k];
    node.status = status[k];
    node.position_left = point_left[k];
    node.orientation_left = orientation[k];
    for (std::size_t i = 0; i < n; ++i) node.corrected_position[i] = out[i][k];
    for (std::size_t i = 0; i < 3; ++i) node.shift[i] = after[i][k] - before[i][k];
    node.corrected = node.words;
    for (std::size_t i = 0; i < kAxisWords; ++i) {
      // By the difference, so that words without a correction stay as they are to the last bit.
      const std::size_t axis = words.axis[i];
      if (axis != Machine::npos) node.corrected[i] += node.corrected_position[axis] - node.position[axis];
    }
    if (coordinates == ProgramCoordinates::tool_centre) {
      for (std::size_t i = 0; i < 3; ++i) node.corrected[i] = node.words[i] + node.shift[i];
    }
  }
}

CorrectedNode NodeCorrection::offset(ProgramCoordinates coordinates, std::size_t tool, const CorrectedNode& node,
                                     const std::array<double, kMaxAxes>& added) const {
  CorrectedNode result = node;
  bool any = false;
  for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
    if (added[i] == 0) continue;
    any = true;
    const Axis& axis = machine_.axes[i];
    double& position = result.corrected_position[i];
    position += added[i];
    if (axis.endless || (position >= axis.travel_min && position <= axis.travel_max)) continue;
    const double wanted = position;
    position = std::clamp(position, axis.travel_min, axis.travel_max);
    result.position_left +=
        axis.kind == AxisKind::linear ? std::abs(position - wanted) : std::numeric_limits<double>::quiet_NaN();
    if (node.point_reached()) result.status = CorrectionStatus::outside_travel;
  }
  if (!any) return result;
  const WordAxes& words = kinematics_.words();
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    const std::size_t axis = words.axis[i];
    if (axis != Machine::npos && added[axis] != 0) {
      result.corrected[i] += result.corrected_position[axis] - node.corrected_position[axis];
    }
  }
  std::array<std::array<double, 2>, kMaxAxes> positions;
  std::array<const double*, kMaxAxes> commands;
  for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
    positions[i] = {node.corrected_position[i], result.corrected_position[i]};
    commands[i] = positions[i].data();
  }
  std::array<std::array<double, 2>, 3> start, seen;
  for (std::size_t i = 0; i < 3; ++i) start[i].fill(tools_[tool].point[static_cast<Eigen::Index>(i)]);
  nominal_.transform({{commands.data(), machine_.axes.size()}, 2}, {start[0].data(), start[1].data(), start[2].data()},
                     {seen[0].data(), seen[1].data(), seen[2].data()});
  for (std::size_t i = 0; i < 3; ++i) {
    const double moved = seen[i][1] - seen[i][0];
    result.shift[i] += moved;
    if (coordinates == ProgramCoordinates::tool_centre) result.corrected[i] = node.corrected[i] + moved;
  }
  return result;
}

}  // namespace abbe
