#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Direction of the last motion of every axis: +1, -1, 0 where it is not known or does not matter.
using AxisApproach = std::array<std::int8_t, kMaxAxes>;

/// An axis whose direction is followed: it has a reversal value (errors/reversal.h), or errors depend on its approach.
struct ReversalAxis {
  std::size_t axis = 0;
  double value = 0;      ///< B, mm or rad; 0: none
  double dead_band = 0;  ///< mm or rad; moving back by no more than this is not a reversal

  /// Added to the command so that the axis reaches its position after an approach in that direction; mm or rad.
  double offset(int direction) const { return -0.5 * value * direction; }
  bool operator==(const ReversalAxis&) const = default;
};

/// Follows in which direction axes move, with a dead band: a direction lasts until the axis has come back from the
/// furthest place it reached in it by more than the dead band. An axis that does not move keeps its direction; before
/// it has moved by more than the dead band it has none.
///
/// While the axis counts as moving in a direction, it is never further behind that furthest place than the dead band.
/// Play therefore keeps it from its commanded position by no more than the dead band.
class AxisDirections {
 public:
  /// @param dead_bands  [axes followed] mm or rad
  explicit AxisDirections(const std::vector<double>& dead_bands);

  /// Takes effect from the next motion; mm or rad.
  void set_dead_band(std::size_t i, double dead_band) { state_[i].dead_band = dead_band; }

  /// The axis is at a position; how it got there is not known.
  void stand(std::size_t i, double position);
  /// The axis moves straight to a position. A change of direction counts from where the axis is now.
  void move(std::size_t i, double position);

  std::int8_t direction(std::size_t i) const { return state_[i].direction; }
  bool stands(std::size_t i) const { return state_[i].seen; }

 private:
  struct State {
    double dead_band = 0;
    double lowest = 0, highest = 0;  ///< since the direction began
    std::int8_t direction = 0;
    bool seen = false;
  };
  std::vector<State> state_;
};

}  // namespace abbe
