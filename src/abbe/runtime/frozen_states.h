#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "abbe/runtime/abbe_runtime_states.h"
#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_pose.h"

namespace abbe {

inline constexpr std::size_t kFrozenStates = ABBE_RUNTIME_STATES;
inline constexpr std::size_t kNoFactor = kFrozenStates;  ///< of an error: it is not multiplied

/// A point mass of a gravity state.
struct FrozenLoad {
  std::size_t axis = 0;  ///< that carries it
  Triple weight{};       ///< force in N times 0.001, so that torques of arms in mm are in N m
  Triple point{};        ///< mm, all axes at zero
};

struct FrozenState {
  enum class Kind : std::uint8_t { measured, lag, axis, gravity };
  Kind kind = Kind::measured;
  char name[frozen::kStateName + 1] = {};
  std::size_t unit = 0;      ///< index into kStateUnits of state.h
  double reference = 0;      ///< measured, lag, axis
  std::size_t of = 0;        ///< lag: state of its channel; axis, gravity: the axis
  double from = 0, to = 0;   ///< measured, lag: range; axis: commands beyond take the end of it
  double time_constant = 0;  ///< lag, s
  std::size_t place = 0;     ///< measured, lag: among the channels, the lags
  std::size_t first_load = 0, loads = 0;
};

/// Product of the factors of one or two states: all given ones, or all computed at the pose.
struct FrozenFactor {
  std::size_t first = 0, second = kNoFactor;
  double largest = 0;  ///< given: the point moves by so much per unit at most, mm
};

/// Coefficients of a group per unit of a factor.
struct FrozenBlock {
  std::size_t group = 0, factor = 0;
  const double* coefficients = nullptr;
};

/// What location errors do to the line of an axis.
struct LineErrors {
  Triple shift{0, 0, 0}, tilt{0, 0, 0};  // mm, rad
  double zero = 0;                       // mm or rad

  void add(double factor, const LineErrors& other) {
    shift = shift + factor * other.shift;
    tilt = tilt + factor * other.tilt;
    zero += factor * other.zero;
  }
};

struct FrozenLocation {
  std::size_t axis = 0, factor = kNoFactor, pose = kNoFactor;
  LineErrors line;
};

/// Errors with factors that are computed at the pose, with given states put in.
struct FrozenPosed {
  const FrozenStates* states = nullptr;
  const FrozenGroup* group = nullptr;                       ///< all groups of the machine
  std::array<LineErrors, frozen::kMostLocations> location;  ///< as FrozenStates::location, times their given factors
  std::array<LineErrors, kFrozenAxes> line;                 ///< sum of those without a factor of the pose
};

/// States of a file and what depends on them.
struct FrozenStates {
  std::size_t count = 0, channels = 0, lags = 0;
  std::array<FrozenState, kFrozenStates> state;
  std::array<std::size_t, kFrozenStates> channel{}, lag{};  ///< places in `state`
  std::size_t factors = 0, poses = 0;
  std::array<FrozenFactor, kFrozenStates> factor, pose;  ///< given; computed at the pose
  std::size_t loads = 0;
  std::array<FrozenLoad, frozen::kMostLoads> load;
  std::size_t groups = 0;                                         ///< all
  std::array<std::size_t, kFrozenAxes> first_group{}, of_axis{};  ///< groups with a factor of the pose, per axis
  std::array<std::uint8_t, frozen::kMostGroups> pose_of{};        ///< index into `pose`
  std::size_t blocks = 0, locations = 0;
  std::array<FrozenBlock, frozen::kMostBlocks> block;
  std::array<FrozenLocation, frozen::kMostLocations> location;
  std::array<bool, kFrozenAxes> located{};  ///< lines that move with the pose
  std::array<bool, kFrozenAxes> placed{};   ///< lines that move with given states
  FrozenPosed posed;                        ///< of the file itself: given states put in where there are none
};

/// The line of an axis with location errors: Rz Ry Rx of the tilt, then the shift (docs/conventions.md).
void displace(const LineErrors& line, FrozenAxis& axis);

/// Factors that are computed at the pose, [poses]: by nominal kinematics at these commands.
void pose_factors(const abbe_runtime& machine, const FrozenStates& states, const FrozenCommands& commands,
                  double* factors);

/// Puts values of the given factors into a machine that is a copy of the one that was read.
///
/// @param factors  [factors]
/// @param group    [groups] of `live`; coefficients of those with blocks are written to where they point
void put_in(const abbe_runtime& read, const FrozenStates& states, const double* factors, FrozenGroup* group,
            FrozenPosed& posed, abbe_runtime& live);

}  // namespace abbe
