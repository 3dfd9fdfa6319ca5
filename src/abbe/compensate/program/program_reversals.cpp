#include "abbe/compensate/program/program_reversals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

constexpr double kSamePlace = 1e-6;  // mm or rad; between two ways of reckoning one

/// Longest lever of the functional point of the machine's tool about a rotary axis over the travel, mm: at places that
/// are as good as any.
double longest_lever(const Machine& machine, const PieceBounder& bounder, std::size_t axis) {
  constexpr int kPlaces = 256;
  RandomStream random(1);
  std::vector<double> positions(machine.axes.size());
  ChainLevers levers;
  double longest = 1;
  for (int k = 0; k < kPlaces; ++k) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Axis& one = machine.axes[i];
      const bool limited = !one.endless && one.travel_max > one.travel_min;
      const double half = one.kind == AxisKind::rotary ? std::numbers::pi : 0;
      positions[i] = limited ? random.uniform(one.travel_min, one.travel_max) : random.uniform(-half, half);
    }
    bounder.levers(positions.data(), machine.tool_offset, levers);
    longest = std::max(longest, levers.from_line[axis]);
  }
  return longest;
}

/// Axes on whose side of approach errors depend: 1 or 0, [axes].
std::vector<std::uint8_t> axes_with_sides(const Machine& machine, const ErrorSet& errors) {
  std::vector<std::uint8_t> axes(machine.axes.size(), 0);
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] != 0 && machine.states[j].kind == StateKind::approach) axes[machine.states[j].axis] = 1;
  }
  return axes;
}

}  // namespace

void ProgramWay::clear() {
  nodes.clear();
  shares.clear();
  first.clear();
  approach.clear();
}

ProgramReversals::ProgramReversals(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
                                   const PieceBounder& bounder, double dead_band, double dead_band_turn)
    : directions_(std::vector<double>{}), dead_band_(dead_band), dead_band_turn_(dead_band_turn) {
  std::vector<std::uint8_t> with_sides = axes_with_sides(machine, errors);
  const bool sides = std::any_of(with_sides.begin(), with_sides.end(), [](std::uint8_t axis) { return axis != 0; });
  std::vector<double> dead_bands;
  const auto add = [&](std::size_t axis, double value) {
    axes_.push_back({axis, value, dead_band_of(axis, 0)});
    dead_bands.push_back(axes_.back().dead_band);
    with_sides[axis] = 0;
  };
  for (std::size_t i = 0; i < machine.axes.size() && (sides || !errors.reversals.empty()); ++i) {
    rotary_.push_back(machine.axes[i].kind == AxisKind::rotary);
    lever_.push_back(rotary_.back() ? longest_lever(machine, bounder, i) : 1.0);
  }
  for (const Reversal& reversal : errors.reversals) {
    if (reversal.value != 0 && words.moves(reversal.axis)) add(reversal.axis, reversal.value);
  }
  for (std::size_t i = 0; i < with_sides.size(); ++i) {
    if (with_sides[i] != 0 && words.moves(i)) add(i, 0);
  }
  directions_ = AxisDirections(dead_bands);
  stood_.assign(axes_.size(), 0.0);
}

PlayBounds ProgramReversals::play(bool lags_count) const {
  PlayBounds play;
  play.lags_count = lags_count;
  for (const ReversalAxis& axis : axes_) {
    play.offset[axis.axis] = 0.5 * std::abs(axis.value);
    play.lag[axis.axis] = axis.dead_band;
    play.any = true;
  }
  return play;
}

double ProgramReversals::dead_band_of(std::size_t axis, double tool_length) const {
  if (!rotary_[axis]) return dead_band_;
  // A tool that is longer by a vector has its functional point further from any line by no more than that.
  return std::min(dead_band_ / (lever_[axis] + tool_length), dead_band_turn_);
}

void ProgramReversals::take_tool(const std::array<double, 3>& length) {
  if (length == tool_length_) return;
  tool_length_ = length;
  const double longer = Eigen::Vector3d(length[0], length[1], length[2]).norm();
  for (std::size_t r = 0; r < axes_.size(); ++r) directions_.set_dead_band(r, dead_band_of(axes_[r].axis, longer));
}

void ProgramReversals::follow(std::span<const ProgramMove> moves, ProgramWay& way) {
  way.approach.assign(way.nodes.size(), AxisApproach{});
  for (std::size_t m = 0; m + 1 < way.first.size(); ++m) {
    take_tool(moves[m].tool_length);
    for (std::size_t k = way.first[m]; k < way.first[m + 1]; ++k) {
      const CorrectedNode& node = way.nodes[k];
      for (std::size_t r = 0; r < axes_.size(); ++r) {
        const std::size_t axis = axes_[r].axis;
        const double position = node.corrected_position[axis];
        if (k > way.first[m]) {
          directions_.move(r, position);
        } else if (!directions_.stands(r) || !(std::abs(node.position[axis] - stood_[r]) <= kSamePlace)) {
          directions_.stand(r, position);
        }
        stood_[r] = node.position[axis];
        way.approach[k][axis] = directions_.direction(r);
      }
    }
  }
}

double ProgramReversals::moved(const CorrectedNode& from, const CorrectedNode& to) const {
  double squares = 0, turned = 0;
  for (std::size_t i = 0; i < lever_.size(); ++i) {
    const double way = lever_[i] * (to.corrected_position[i] - from.corrected_position[i]);
    if (rotary_[i]) {
      turned = std::max(turned, std::abs(way));
    } else {
      squares += way * way;
    }
  }
  return std::max(std::sqrt(squares), turned);
}

CorrectedNode ProgramReversals::commanded(const NodeCorrection& correction, const ProgramMove& move, std::size_t tool,
                                          const CorrectedNode& node, const AxisApproach& approach) const {
  std::array<double, kMaxAxes> added{};
  for (const ReversalAxis& axis : axes_) added[axis.axis] = axis.offset(approach[axis.axis]);
  if (!correction.has_approaches()) return correction.offset(move.coordinates, tool, node, added);
  return correction.offset(move.coordinates, tool, correction.after(move.coordinates, tool, node, approach), added);
}

bool ProgramReversals::only_turns(const CorrectedNode& from, const CorrectedNode& to) const {
  for (std::size_t i = 0; i < rotary_.size(); ++i) {
    if (!rotary_[i] && std::abs(to.corrected_position[i] - from.corrected_position[i]) > kNoMotion_mm) return false;
  }
  return true;
}

void ProgramReversals::steps(const NodeCorrection& correction, const ProgramMove& move, std::size_t tool,
                             const ProgramWay& way, std::size_t index, std::vector<ProgramStep>& steps) const {
  steps.clear();
  for (std::size_t k = way.first[index] + 1; k < way.first[index + 1]; ++k) {
    const AxisApproach& approach = way.approach[k];
    AxisApproach taken = way.approach[k - 1];
    for (const ReversalAxis& axis : axes_) {
      if (approach[axis.axis] == taken[axis.axis]) continue;
      double way_there = lever_[axis.axis] * std::abs(axis.offset(approach[axis.axis]) - axis.offset(taken[axis.axis]));
      bool rotary = rotary_[axis.axis];
      CorrectedNode before;
      if (correction.has_approaches()) before = commanded(correction, move, tool, way.nodes[k - 1], taken);
      taken[axis.axis] = approach[axis.axis];
      const CorrectedNode after = commanded(correction, move, tool, way.nodes[k - 1], taken);
      if (correction.has_approaches()) {
        // Other axes may move as well, or none at all.
        if (after.corrected == before.corrected) continue;
        way_there = moved(before, after);
        rotary = only_turns(before, after);
      }
      steps.push_back({after, axis.axis, rotary, way_there, k, taken});
    }
    steps.push_back(
        {commanded(correction, move, tool, way.nodes[k], approach), ProgramStep::npos, false, 0, k, approach});
  }
}

}  // namespace abbe
