#include "axis_option.h"

#include <fmt/format.h>

#include <numbers>

#include "abbe/formats/input_error.h"
#include "abbe/formats/number_text.h"

namespace abbe {

HeldAxis axis_option(const Machine& machine, const std::string& option, const std::string& text) {
  const auto fail = [&](const std::string& problem) {
    throw InputError({.field = option + " " + text}, problem, "AXIS_unit=position, such as C2_deg=30 or X_mm=100");
  };
  const std::size_t equals = text.find('='), underscore = text.rfind('_', equals);
  if (equals == std::string::npos || underscore == std::string::npos) fail("not understood");
  const std::size_t axis = machine.find_axis(text.substr(0, underscore));
  if (axis == Machine::npos) fail("the machine has no axis '" + text.substr(0, underscore) + "'");
  const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
  const std::string unit = text.substr(underscore + 1, equals - underscore - 1);
  if (unit != (rotary ? "deg" : "mm")) fail(fmt::format("unit '{}' for a {} axis", unit, rotary ? "rotary" : "linear"));
  double value = 0;
  if (parse_number(std::string_view(text).substr(equals + 1), 0, value) != NumberProblem::none) fail("not a number");
  return {axis, rotary ? value * std::numbers::pi / 180 : value};
}

}  // namespace abbe
