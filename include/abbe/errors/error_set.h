#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "abbe/errors/basis.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// The six components of an error motion, in the order of ISO 230-1: translations along, rotations about X, Y, Z.
enum class Component { X, Y, Z, A, B, C };
inline constexpr int kComponentCount = 6;
inline bool is_rotation(Component component) { return static_cast<int>(component) >= 3; }
char component_letter(Component component);

/// One term of an error motion E<component><axis>: coefficients times basis functions of that axis's position.
///
/// Several terms with the same axis and component add up (a polynomial plus the screw's harmonics, say). A term with a
/// state is multiplied with the factor of that state (MachineState); its coefficients are per unit of the factor.
struct ErrorMotion {
  std::size_t axis = 0;  ///< index into Machine::axes
  Component component = Component::X;
  Basis basis;
  std::vector<double> coefficients;          ///< [basis.size()], mm or rad, actual minus nominal
  std::vector<double> standard_uncertainty;  ///< [basis.size()] or empty, mm or rad
  std::size_t state = kNoState;              ///< index into Machine::states; kNoState: the term is not multiplied
  bool operator==(const ErrorMotion&) const = default;
};

/// One location error E<component>0<axis>, constant: the axis average line is displaced by it, nothing else moves while
/// the axis is at zero.
///
/// With L = [Rz Ry Rx of (EA0, EB0, EC0) | (EX0, EY0, EZ0)] about Axis::point the nominal motion M(q) becomes L M(q)
/// L^-1. The part along (about) the axis's own direction is its zero position error instead: M(q + value), for rotary
/// EC0C, for linear EX0X. An axis parallel to none of X, Y, Z has it as a part of several components (LocationEffect).
/// Where a component can have no effect it is not valid (see location_error_is_valid). With a state the value is per
/// unit of its factor: the axis line stands elsewhere at every pose.
struct LocationError {
  std::size_t axis = 0;
  Component component = Component::A;
  double value = 0;                 ///< mm or rad
  double standard_uncertainty = 0;  ///< mm or rad, 0: not stated
  std::size_t state = kNoState;     ///< index into Machine::states; kNoState: constant
  bool operator==(const LocationError&) const = default;
};

/// Reversal of one axis: its position depends on the direction of approach (lost motion, backlash).
///
/// Reversal value B = position after an approach in positive direction less that after one in negative direction
/// (ISO 230-2:2014, 3.11); lost motion makes it negative. At a command q the axis stands as if q + approach B / 2 had
/// been commanded, approach = +1, -1, or 0 where the side is not known: error motions are means of both directions.
struct Reversal {
  std::size_t axis = 0;             ///< index into Machine::axes
  double value = 0;                 ///< B, mm or rad
  double standard_uncertainty = 0;  ///< mm or rad, 0: not stated
  bool operator==(const Reversal&) const = default;
};

/// Order of E(q) and the motion of its axis, see docs/conventions.md. `iso` is the convention of this project:
/// linear T(q) E(q), rotary E(q) T(q). The others exist to reproduce published work.
enum class ErrorOrder { iso, after_motion, before_motion };

struct Composition {
  ErrorOrder order = ErrorOrder::iso;
  /// Replace Rz Ry Rx by I + skew(EA, EB, EC): only to reproduce papers, and only from a carried frame towards the bed.
  bool first_order = false;
  bool operator==(const Composition&) const = default;
};

/// All geometric errors of one machine: values of every coefficient, in a fixed order.
struct ErrorSet {
  std::vector<ErrorMotion> motions;
  std::vector<LocationError> locations;
  std::vector<Reversal> reversals;                              ///< at most one per axis
  Eigen::Vector3d tool_offset_error = Eigen::Vector3d::Zero();  ///< mm, added to Machine::tool_offset
  Composition composition;

  /// Number of coefficients: those of all motions in order, then locations, reversals, the tool offset error (3).
  std::size_t parameter_count() const;
  std::vector<double> parameters() const;                  ///< mm or rad, [parameter_count()]
  void set_parameters(const std::vector<double>& values);  ///< [parameter_count()]

  /// Sum of all terms of the six components of one axis at one of its positions; mm, rad.
  /// @param factors  [states] of the machine (state_factors()); where they are not given, components that have a term
  ///                 with a state are NaN
  std::array<double, kComponentCount> evaluate(std::size_t axis, double position,
                                               std::span<const double> factors = {}) const;

  /// True where every term of that axis covers the position (no extrapolation).
  bool covers(std::size_t axis, double position) const;
};

/// ErrorSet::covers() of all axes, at the positions that they have at commands in chain order.
bool covers_commands(const Machine& machine, const ErrorSet& errors, std::span<const double> commands);

/// "EXX", "EAC2": E + component + axis name; "EXX*ambient" with a state.
std::string error_motion_name(const Machine& machine, std::size_t axis, Component component,
                              std::size_t state = kNoState);
/// "EC0Y": E + component + 0 + axis name; "EC0Y*ambient" with a state.
std::string location_error_name(const Machine& machine, std::size_t axis, Component component,
                                std::size_t state = kNoState);
/// "reversal_X".
std::string reversal_name(const Machine& machine, std::size_t axis);
/// Names in the order of ErrorSet::parameters(): "EXX[P2]", "EXX*ambient[P2]", "EC0Y", "reversal_X", "tool_X".
std::vector<std::string> parameter_names(const Machine& machine, const ErrorSet& errors);
/// True for parameters in rad, false for mm (with a state: per unit of its factor); order of ErrorSet::parameters().
std::vector<bool> parameters_are_angles(const Machine& machine, const ErrorSet& errors);

/// Parses "EXX" or "EC0Y" against the axes of a machine.
/// @returns false if the text names no error of this machine
bool parse_error_name(const Machine& machine, const std::string& text, std::size_t& axis, Component& component,
                      bool& is_location);

/// What one unit (mm or rad) of a location error does to its axis.
///
/// With u the axis's direction, turned round if its largest component is negative, a rotation r of a rotary axis tilts
/// its line by r - (r . u) u and adds r . u to its position; a translation of a linear axis adds r . u to its position.
/// What an axis can have is therefore the same in every machine frame.
struct LocationEffect {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< of the axis line
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();   ///< of the axis line, about X, Y, Z
  double zero_position = 0;                         ///< added to the command
};
LocationEffect location_effect(const Axis& axis, Component component);

/// Roll of a linear axis about its own direction, shift of a linear axis line and shift of a rotary axis line along
/// itself have no effect and are not location errors. For directions not parallel to X, Y or Z all components are
/// valid; the combinations without effect are then found by the gauge analysis.
bool location_error_is_valid(const Axis& axis, Component component);

/// True if the component does nothing but add to the position of its axis: the zero position error.
bool is_zero_position_error(const Axis& axis, Component component);

}  // namespace abbe
