#include "abbe/formats/machine/axis_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {

AxisNumbers axis_numbers_option(const Machine& machine, const std::string& option, const std::string& text,
                                const std::string& expected) {
  const auto fail = [&](const std::string& problem) {
    throw InputError({.field = option + " " + text}, problem, expected);
  };
  const std::size_t equals = text.find('='), underscore = text.rfind('_', equals);
  if (equals == std::string::npos || underscore == std::string::npos) fail("not understood");
  AxisNumbers result;
  result.axis = machine.find_axis(text.substr(0, underscore));
  if (result.axis == Machine::npos) fail("the machine has no axis '" + text.substr(0, underscore) + "'");
  const Axis& axis = machine.axes[result.axis];
  const std::string unit = text.substr(underscore + 1, equals - underscore - 1);
  if (unit != position_suffix(axis)) {
    fail(fmt::format("unit '{}' for a {} axis", unit, axis.kind == AxisKind::rotary ? "rotary" : "linear"));
  }
  result.unit = position_unit(axis);
  for (std::size_t start = equals + 1; start <= text.size();) {
    const std::size_t end = std::min(text.find(':', start), text.size());
    double value = 0;
    if (parse_number(std::string_view(text).substr(start, end - start), 0, value) != NumberProblem::none) {
      fail("not a number");
    }
    if (!(std::abs(value) <= kLargestInput)) fail("too large");
    result.numbers.push_back(value);
    start = end + 1;
  }
  return result;
}

HeldAxis axis_option(const Machine& machine, const std::string& option, const std::string& text) {
  const std::string expected = "AXIS_unit=position, such as C2_deg=30 or X_mm=100";
  const AxisNumbers given = axis_numbers_option(machine, option, text, expected);
  if (given.numbers.size() != 1) throw InputError({.field = option + " " + text}, "not a number", expected);
  return {given.axis, given.numbers[0] * given.unit};
}

std::vector<HeldAxis> axis_options(const Machine& machine, const std::string& option,
                                   const std::vector<std::string>& texts) {
  std::vector<HeldAxis> given;
  for (const std::string& text : texts) given.push_back(axis_option(machine, option, text));
  return given;
}

}  // namespace abbe
