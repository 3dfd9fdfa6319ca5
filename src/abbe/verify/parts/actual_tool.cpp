#include "abbe/verify/parts/actual_tool.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/reversal.h"

namespace abbe {

ToolPlaces actual_tool(const Machine& machine, const ErrorSet& errors, const PoseList& commands) {
  if (commands.axis.size() != machine.axes.size()) {
    throw std::invalid_argument("actual tool: commands do not fit the machine's axes");
  }
  const std::size_t count = commands.count();
  const ReversalShift reversal(errors);
  PoseList reached;
  reached.axis = commands.axis;
  if (reversal.acts_on(commands)) {
    for (std::size_t i = 0; i < reached.axis.size(); ++i) {
      for (std::size_t k = 0; k < count; ++k) reached.axis[i][k] += reversal.shift(commands, i, k);
    }
  }
  std::vector<const double*> pointers;
  for (const std::vector<double>& values : reached.axis) pointers.push_back(values.data());
  const Eigen::Vector3d start = machine.tool_offset + errors.tool_offset_error;
  std::array<std::vector<double>, 3> from, to;
  std::array<std::vector<double>, 9> turned;
  RotationArrays rotation;
  for (std::size_t c = 0; c < 3; ++c) {
    from[c].assign(count, start[static_cast<int>(c)]);
    to[c].resize(count);
  }
  for (std::size_t e = 0; e < 9; ++e) {
    turned[e].resize(count);
    rotation.r[e] = turned[e].data();
  }
  ToolPlaces tool;
  const auto columns = static_cast<Eigen::Index>(count);
  tool.point.resize(3, columns);
  tool.direction.resize(3, columns);
  tool.covered.resize(count);
  if (count == 0) return tool;
  const GivenStates given(machine, errors);
  std::vector<std::size_t> all(given.any() ? count : 0);
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<double> states;
  std::vector<const double*> state;
  given.gather(commands, all, states, state);
  const ChainPlan plan(machine, errors, Body::tool, Body::workpiece);
  plan.transform({pointers, count, state}, {from[0].data(), from[1].data(), from[2].data()},
                 {to[0].data(), to[1].data(), to[2].data()}, rotation, tool.covered.data());
  for (std::size_t k = 0; k < count; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto row = static_cast<Eigen::Index>(c);
      tool.point(row, column) = to[c][k];
      tool.direction(row, column) = turned[3 * c][k] * machine.tool_direction[0] +
                                    turned[3 * c + 1][k] * machine.tool_direction[1] +
                                    turned[3 * c + 2][k] * machine.tool_direction[2];
    }
  }
  return tool;
}

PoseList positions_with_play(const ErrorSet& errors, const PoseList& commands) {
  PoseList positions;
  positions.axis = commands.axis;
  for (const Reversal& reversal : errors.reversals) {
    const double half = std::abs(reversal.value) / 2;
    if (half == 0 || reversal.axis >= positions.axis.size() || positions.count() == 0) continue;
    std::vector<double>& values = positions.axis[reversal.axis];
    double behind = values.front();
    for (double& value : values) {
      behind = std::max(value - half, std::min(value + half, behind));
      value = reversal.value < 0 ? behind : 2 * value - behind;
    }
  }
  return positions;
}

}  // namespace abbe
