#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "abbe/errors/chain_plan.h"

namespace abbe {

/// Axis commands of many poses, owned, structure of arrays: axis[i][k], chain order, mm or rad.
struct PoseList {
  std::vector<std::vector<double>> axis;
  /// From which side an axis came: approach[i][k] = +1 or -1, the sign of its last motion, 0 if it is not known. Empty
  /// as a whole where nothing is known. Plans and what is made from poses leave it empty.
  std::vector<std::vector<std::int8_t>> approach{};
  /// Values of measured and lag states: state[j][k], j into Machine::states, in the state's unit (not yet less its
  /// reference). state[j] is empty where that of j is not given; empty as a whole where none is.
  std::vector<std::vector<double>> state{};

  std::size_t count() const { return axis.empty() ? 0 : axis.front().size(); }
  std::vector<double> pose(std::size_t k) const {
    std::vector<double> positions(axis.size());
    for (std::size_t i = 0; i < axis.size(); ++i) positions[i] = axis[i][k];
    return positions;
  }
  void append(const std::vector<double>& positions) {
    axis.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) axis[i].push_back(positions[i]);
  }
};

/// Positions of an axis at all poses of a list: its commands where it is not coupled.
std::vector<double> positions_of_axis(const Machine& machine, const PoseList& poses, std::size_t axis);

/// All combinations of given axis positions; the first axis varies slowest. Nothing but the positions is stored.
struct PoseGrid {
  std::vector<std::vector<double>> values;  ///< [axes] positions per axis, mm or rad

  std::size_t count() const {
    std::size_t product = values.empty() ? 0 : 1;
    for (const std::vector<double>& axis_values : values) product *= axis_values.size();
    return product;
  }
};

/// Poses that are made when they are needed: millions of them need no memory.
struct PoseSource {
  std::size_t axes = 0;
  std::size_t count = 0;
  /// Writes poses first .. first + number - 1 to axis[i][0 .. number - 1]; thread-safe.
  std::function<void(std::size_t first, std::size_t number, double* const* axis)> fill;
  /// Writes values of measured and lag states to state[j][0 .. number - 1], NaN where they are not given; j below
  /// `states`. Null: nothing is given.
  std::function<void(std::size_t first, std::size_t number, double* const* state)> fill_states{};
  std::size_t states = 0;  ///< of the machine; 0 without fill_states
};

/// @param list  must outlive the source
PoseSource pose_source(const PoseList& list);
PoseSource pose_source(PoseGrid grid);
/// The same poses, all at the same values of measured and lag states.
/// @param values  [states] in the unit of each state
PoseSource at_states(PoseSource poses, std::vector<double> values);

/// Sides from which the axes come if the poses are visited in their order, straight from one to the next: the sign of
/// an axis's last motion; 0 before its first.
std::vector<std::vector<std::int8_t>> approach_in_order(const PoseList& poses);

/// Adds to `all` the poses of `more`, which may know the approach or not. A state that only one of them has is not
/// given at the poses of the other: NaN there.
void join_poses(PoseList& all, const PoseList& more);

/// Joins names of readings, [count] each or empty: what has none gets empty ones beside the other's.
void join_labels(std::vector<std::string>& all, std::size_t count, const std::vector<std::string>& more,
                 std::size_t more_count);

/// Evenly spread positions from `from` to `to`, both included; one position: the middle.
std::vector<double> evenly_spaced(double from, double to, std::size_t count);

}  // namespace abbe
