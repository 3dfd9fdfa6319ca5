#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// States: what an error of a machine may depend on besides the command of its own axis. docs/kinematics.md derives the
// torque of gravity, docs/conventions.md says how errors use states.

namespace abbe {

struct Machine;

/// Where the value of a state comes from.
enum class StateKind {
  measured,  ///< a channel that is given with every pose: a temperature, a load, a speed
  lag,       ///< a measured channel behind a first-order lag, given with every pose too
  axis,      ///< the position of an axis
  approach,  ///< from which side an axis came: +1, -1, 0 where that is not known
  gravity,   ///< torque of point masses about the line of an axis, by nominal kinematics
  product    ///< product of two other states
};

/// No machine has more states than this: room for working arrays without allocation.
inline constexpr std::size_t kMaxStates = 16;

/// Index of no state.
inline constexpr std::size_t kNoState = static_cast<std::size_t>(-1);

/// A point mass that an axis carries.
struct GravityLoad {
  std::size_t carried_by = 0;                       ///< index into Machine::axes
  double mass_kg = 0;                               ///< kg, above 0
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< mm, machine frame with all axes at zero
  bool operator==(const GravityLoad&) const = default;
};

/// Something that errors depend on. An error with a state is proportional to its factor, value less reference: 0 at the
/// reference, and 1 where the value is one unit above it.
///
/// The value is in `unit` for measured and lag, mm or rad for axis, N m for gravity, without unit for approach. A
/// product has the product of its two factors, which must not be products themselves.
struct MachineState {
  std::string name;  ///< letters, digits and _; unique in its machine
  StateKind kind = StateKind::measured;
  std::string unit{};                ///< measured and lag: one of kStateUnits
  double reference = 0;              ///< measured, lag, axis: value at which the factor is 0
  std::size_t axis = 0;              ///< axis, approach: whose; gravity: about whose line; index into Machine::axes
  std::size_t first = kNoState;      ///< lag: the measured state behind which it is; product: a factor
  std::size_t second = kNoState;     ///< product: the other factor; may be the same
  double time_constant = 0;          ///< lag: s, above 0
  std::vector<GravityLoad> loads{};  ///< gravity: at least one, each carried by the axis or by one that it carries
  bool operator==(const MachineState&) const = default;
};

/// Units of measured states; "1" is a pure number.
inline constexpr std::string_view kStateUnits[] = {"degC", "K", "Nm", "N", "kg", "rpm", "s", "1"};

/// Whether the value has to be given with every pose (measured, lag). That of an approach is 0 where it is not given.
inline bool is_input(StateKind kind) { return kind == StateKind::measured || kind == StateKind::lag; }

/// "measured", "lag", ...
const char* state_kind_name(StateKind kind);

/// Unit of the factor in words: "K", "mm", "rad", "N m", "1", "kg N m". A difference of degC is in K.
std::string factor_unit(const Machine& machine, std::size_t state);

/// Name of its column in files of readings: "ambient_degC"; the name alone where the unit is "1".
std::string state_column(const MachineState& state);

/// Index of the state of that name, or kNoState.
std::size_t find_state(const Machine& machine, std::string_view name);

/// Whether a factor changes with the commands: axis, gravity, and products with one of these.
bool depends_on_commands(const Machine& machine, std::size_t state);

/// Factor of a state at one pose.
///
/// @param commands      in chain order, [axes], mm or rad
/// @param given         [states] values of measured and lag states in their unit and sides of approach, NaN where not
///                      given (others are not read); or empty: nothing is given
/// @param by_commands   if not null: d(factor)/d(command), becomes [axes], per mm or rad
/// @returns NaN where an input state is not given
double state_factor(const Machine& machine, std::size_t state, std::span<const double> commands,
                    std::span<const double> given, std::vector<double>* by_commands = nullptr);

/// Factors of all states at one pose, [states].
std::vector<double> state_factors(const Machine& machine, std::span<const double> commands,
                                  std::span<const double> given);

/// A channel behind a first-order lag: tau dy/dt + y = u, exact for u piecewise linear between the times.
///
/// The lag starts in equilibrium with the first value.
/// @param time_s  [n], not decreasing
/// @param value   [n]
/// @return [n], in the unit of the values
std::vector<double> lagged(std::span<const double> time_s, std::span<const double> value, double time_constant_s);

}  // namespace abbe
