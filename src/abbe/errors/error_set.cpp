#include "abbe/errors/error_set.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

/// 0, 1, 2 if the axis is parallel to X, Y, Z, else -1.
int principal_direction(const Axis& axis) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(std::abs(axis.direction[k]) - 1.0) < 1e-12) return k;
  }
  return -1;
}

std::string state_suffix(const Machine& machine, std::size_t state) {
  return state == kNoState ? std::string() : "*" + machine.states.at(state).name;
}

}  // namespace

char component_letter(Component component) { return "XYZABC"[static_cast<int>(component)]; }

std::size_t ErrorSet::parameter_count() const {
  std::size_t count = locations.size() + reversals.size() + 3;
  for (const ErrorMotion& motion : motions) count += motion.coefficients.size();
  return count;
}

std::vector<double> ErrorSet::parameters() const {
  std::vector<double> values;
  values.reserve(parameter_count());
  for (const ErrorMotion& motion : motions) {
    values.insert(values.end(), motion.coefficients.begin(), motion.coefficients.end());
  }
  for (const LocationError& location : locations) values.push_back(location.value);
  for (const Reversal& reversal : reversals) values.push_back(reversal.value);
  for (int k = 0; k < 3; ++k) values.push_back(tool_offset_error[k]);
  return values;
}

void ErrorSet::set_parameters(const std::vector<double>& values) {
  assert(values.size() == parameter_count());
  std::size_t next = 0;
  for (ErrorMotion& motion : motions) {
    for (double& coefficient : motion.coefficients) coefficient = values[next++];
  }
  for (LocationError& location : locations) location.value = values[next++];
  for (Reversal& reversal : reversals) reversal.value = values[next++];
  for (int k = 0; k < 3; ++k) tool_offset_error[k] = values[next++];
}

std::array<double, kComponentCount> ErrorSet::evaluate(std::size_t axis, double position,
                                                       std::span<const double> factors) const {
  std::array<double, kComponentCount> sum{};
  for (const ErrorMotion& motion : motions) {
    if (motion.axis != axis) continue;
    double value = motion.basis.evaluate(position, motion.coefficients);
    if (motion.state != kNoState) {
      value *= factors.empty() ? std::numeric_limits<double>::quiet_NaN() : factors[motion.state];
    }
    sum[static_cast<std::size_t>(motion.component)] += value;
  }
  return sum;
}

bool ErrorSet::covers(std::size_t axis, double position) const {
  for (const ErrorMotion& motion : motions) {
    if (motion.axis == axis && !motion.basis.covers(position)) return false;
  }
  return true;
}

bool covers_commands(const Machine& machine, const ErrorSet& errors, std::span<const double> commands) {
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (!errors.covers(i, commands[i] + coupled_part(machine, i, commands.data()))) return false;
  }
  return true;
}

std::string error_motion_name(const Machine& machine, std::size_t axis, Component component, std::size_t state) {
  return std::string("E") + component_letter(component) + machine.axes[axis].name + state_suffix(machine, state);
}

std::string location_error_name(const Machine& machine, std::size_t axis, Component component, std::size_t state) {
  return std::string("E") + component_letter(component) + "0" + machine.axes[axis].name + state_suffix(machine, state);
}

std::string reversal_name(const Machine& machine, std::size_t axis) { return "reversal_" + machine.axes[axis].name; }

std::vector<std::string> parameter_names(const Machine& machine, const ErrorSet& errors) {
  std::vector<std::string> names;
  names.reserve(errors.parameter_count());
  for (const ErrorMotion& motion : errors.motions) {
    const bool rotary = machine.axes[motion.axis].kind == AxisKind::rotary;
    const std::string name = error_motion_name(machine, motion.axis, motion.component, motion.state);
    for (std::size_t k = 0; k < motion.coefficients.size(); ++k) {
      names.push_back(name + "[" + motion.basis.function_name(k, rotary) + "]");
    }
  }
  for (const LocationError& location : errors.locations) {
    names.push_back(location_error_name(machine, location.axis, location.component, location.state));
  }
  for (const Reversal& reversal : errors.reversals) names.push_back(reversal_name(machine, reversal.axis));
  for (const char* name : {"tool_X", "tool_Y", "tool_Z"}) names.emplace_back(name);
  return names;
}

std::vector<bool> parameters_are_angles(const Machine& machine, const ErrorSet& errors) {
  std::vector<bool> angles;
  angles.reserve(errors.parameter_count());
  for (const ErrorMotion& motion : errors.motions) {
    angles.insert(angles.end(), motion.coefficients.size(), is_rotation(motion.component));
  }
  // Zero position errors of rotary axes are the rotation component about the axis, so the component decides here too.
  for (const LocationError& location : errors.locations) angles.push_back(is_rotation(location.component));
  for (const Reversal& reversal : errors.reversals) {
    angles.push_back(machine.axes[reversal.axis].kind == AxisKind::rotary);
  }
  angles.insert(angles.end(), 3, false);
  return angles;
}

bool parse_error_name(const Machine& machine, const std::string& text, std::size_t& axis, Component& component,
                      bool& is_location) {
  if (text.size() < 3 || text[0] != 'E') return false;
  const std::size_t letter = std::string("XYZABC").find(text[1]);
  if (letter == std::string::npos) return false;
  component = static_cast<Component>(letter);
  is_location = text[2] == '0';
  axis = machine.find_axis(std::string_view(text).substr(is_location ? 3 : 2));
  return axis != Machine::npos;
}

LocationEffect location_effect(const Axis& axis, Component component) {
  const int k = static_cast<int>(component) % 3;
  const int principal = principal_direction(axis);
  const bool rotary = axis.kind == AxisKind::rotary;
  const bool turns = is_rotation(component);
  const Eigen::Vector3d unit = Eigen::Vector3d::Unit(k);
  LocationEffect effect;
  if (turns == rotary) {
    if (principal >= 0) {
      effect.zero_position = k == principal ? 1 : 0;
    } else {
      Eigen::Index nearest = 0;
      axis.direction.cwiseAbs().maxCoeff(&nearest);
      effect.zero_position = axis.direction[nearest] < 0 ? -axis.direction[k] : axis.direction[k];
    }
  }
  if (!turns) {
    if (rotary && k != principal) effect.shift = unit;
  } else if (k != principal) {
    // u u' is the same for both signs of the direction.
    effect.tilt = unit;
    if (rotary && principal < 0) effect.tilt -= axis.direction[k] * axis.direction;
  }
  return effect;
}

bool location_error_is_valid(const Axis& axis, Component component) {
  const LocationEffect effect = location_effect(axis, component);
  return !effect.shift.isZero(0) || !effect.tilt.isZero(0) || effect.zero_position != 0;
}

bool is_zero_position_error(const Axis& axis, Component component) {
  const LocationEffect effect = location_effect(axis, component);
  return effect.zero_position != 0 && effect.shift.isZero(0) && effect.tilt.isZero(0);
}

}  // namespace abbe
