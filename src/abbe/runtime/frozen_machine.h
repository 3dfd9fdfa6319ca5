#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "abbe/runtime/abbe_runtime.h"
#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_uncertainty.h"

namespace abbe {

inline constexpr std::size_t kFrozenAxes = ABBE_RUNTIME_AXES;

/// Three numbers; plain, so that nothing between a controller and its numbers can allocate or throw.
struct Triple {
  double x, y, z;  // not set unless asked for: arrays of them are made in every call
};
inline Triple operator+(const Triple& a, const Triple& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Triple operator-(const Triple& a, const Triple& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Triple operator*(double f, const Triple& a) { return {f * a.x, f * a.y, f * a.z}; }
inline double dot(const Triple& a, const Triple& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double length(const Triple& a) { return std::sqrt(dot(a, a)); }
inline Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Columns of a rotation.
struct Turned {
  Triple x, y, z;
};
inline Triple operator*(const Turned& r, const Triple& a) { return a.x * r.x + a.y * r.y + a.z * r.z; }
inline Triple times_inverse(const Turned& r, const Triple& a) { return {dot(r.x, a), dot(r.y, a), dot(r.z, a)}; }

/// Cosine and sine.
struct CosineSine {
  double c, s;
};

/// Functions of one axis position whose sums give all six components of its error motion at once.
struct FrozenGroup {
  enum class Kind : std::uint8_t { chebyshev, fourier, piecewise_cubic };
  Kind kind = Kind::chebyshev;
  bool everywhere = false;    ///< periodic: no end of range
  bool same_turn = false;     ///< fourier of period 2 pi, everywhere: its first harmonic is that of the axis command
  bool whole_turns = false;   ///< everywhere, of a rotary axis: a whole number of periods makes a turn
  std::size_t functions = 0;  ///< chebyshev, fourier: functions; piecewise: intervals
  double lowest = 0;          ///< positions beyond these two take the errors of the end
  double highest = 0;
  double scale = 0, shift = 0;         ///< chebyshev: s = scale q + shift; fourier: scale = 2 pi / period
  double period = 0;                   ///< fourier; piecewise: 0 if it does not repeat
  double origin = 0, per_spacing = 0;  ///< piecewise; per_spacing 0: the nodes are not evenly spaced
  const double* nodes = nullptr;       ///< [functions + 1]
  /// [functions][6] (piecewise: [functions][4][6], rising powers of the part of the interval): the six components
  const double* coefficients = nullptr;
};

struct FrozenAxis {
  bool rotary = false, tool_side = false, error_first = false, endless = false;
  double sense = 1;                            ///< displacement of the carried body = sense * command
  double chain_sign = 1;                       ///< of the tool side against the workpiece side
  Triple direction{}, point{};                 ///< nominal
  Triple actual_direction{}, actual_centre{};  ///< with location errors
  double zero_position = 0;                    ///< added to the command
  CosineSine zero_turn{1, 0};                  ///< of it
  double map_min = 0, map_max = 0, travel_min = 0, travel_max = 0;
  char letter = 'X';
  int number = 0;
  std::size_t first_group = 0, groups = 0;
  std::size_t solved = kNotSolved;  ///< place among the axes solved from the point
  static constexpr std::size_t kNotSolved = 3;
};

/// Position of `axis` = its command + ratio times the command of `of`.
struct FrozenCoupling {
  std::size_t axis = 0, of = 0;
  double ratio = 0;
};

struct FrozenStates;
struct FrozenPosed;

/// Axes that together do one thing.
struct FrozenChoice {
  std::size_t count = 0;
  std::array<std::size_t, 3> axis{};
};

}  // namespace abbe

/// A frozen compensation, ready to be used: everything behind the handle of abbe_runtime.h.
struct abbe_runtime {
  std::size_t axes = 0;
  std::array<abbe::FrozenAxis, abbe::kFrozenAxes> axis;
  const abbe::FrozenGroup* group = nullptr;
  abbe::FrozenChoice solved;   ///< three linear axes, or none: found from the point of the tool
  abbe::FrozenChoice turning;  ///< rotary axes that correct the orientation, up to two
  abbe::FrozenChoice
      reaching;  ///< axes that correct the point; linear, the last may be the rotary one of a polar machine
  std::array<double, 3> reaching_unit{};       ///< mm or rad that count as 1 mm
  bool reaching_linear = false;                ///< the same three axes are solved and correct
  double largest_turn = 0, largest_shift = 0;  ///< rad, mm: bounds of a correction
  /// Singular values of the nominal derivative (per unit of an axis: no unit) below these say nothing of the actual
  /// machine's: turns and shifts are bounded there however small the error is.
  double least_turning = 0, least_reaching = 0;
  abbe::Triple tool_reference{}, tool{}, tool_error{}, tool_direction{};
  double tool_length_min = 0, tool_length_max = 0;
  abbe::Triple world_zero{};          ///< of the world in the workpiece frame
  abbe::Turned workpiece_from_bed{};  ///< with all axes at zero
  abbe::Triple workpiece_from_bed_shift{};
  abbe::FrozenUncertainty uncertainty;
  abbe_runtime_information information{};
  const abbe::FrozenStates* states = nullptr;  ///< null: no error depends on one
  const abbe::FrozenPosed* posed = nullptr;    ///< null: no error has a factor that is computed at the pose
  std::size_t couplings = 0;
  std::array<abbe::FrozenCoupling, abbe::frozen::kMostCouplings> coupling;
  bool needs_states = false;  ///< errors depend on given states, which have not been put in
};
