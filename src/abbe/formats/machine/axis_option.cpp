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

std::vector<std::size_t> axes_named(const Machine& machine, const std::string& option,
                                    const std::vector<std::string>& names) {
  std::vector<std::size_t> axes;
  for (const std::string& name : names) {
    axes.push_back(machine.find_axis(name));
    if (axes.back() != Machine::npos) continue;
    throw InputError({.field = option + " " + name}, "the machine has no such axis", machine.chain());
  }
  return axes;
}

void take_range_option(const Machine& machine, const std::string& text, std::vector<std::optional<AxisRange>>& ranges) {
  const std::string expected = "AXIS_unit=from:to or AXIS_unit=position, such as X_mm=-100:100";
  const auto [axis, unit, numbers] = axis_numbers_option(machine, "--range", text, expected);
  if (numbers.size() > 2 || !(numbers.size() == 1 || numbers[0] < numbers[1])) {
    throw InputError({.field = "--range " + text}, "needs a position, or two with the smaller one first", expected);
  }
  const Axis& moved = machine.axes[axis];
  if (!moved.endless && !(numbers.front() * unit >= moved.travel_min && numbers.back() * unit <= moved.travel_max)) {
    throw InputError({.field = "--range " + text}, "outside the axis's travel",
                     fmt::format("positions within the travel, {:g} to {:g} in this unit", moved.travel_min / unit,
                                 moved.travel_max / unit));
  }
  ranges[axis] =
      numbers.size() == 1 ? AxisRange::fixed(numbers[0] * unit) : AxisRange{numbers[0] * unit, numbers[1] * unit, 2, 0};
}

void take_grid_option(const Machine& machine, const std::string& text, std::vector<std::optional<AxisRange>>& grid) {
  const std::string expected = "AXIS_unit=from:to:count or AXIS_unit=position, such as X_mm=0:1400:9";
  const auto fail = [&](const std::string& problem) {
    throw InputError({.field = "--grid " + text}, problem, expected);
  };
  const auto [axis, unit, numbers] = axis_numbers_option(machine, "--grid", text, expected);
  if (grid[axis]) fail("axis " + machine.axes[axis].name + " was given before");
  if (numbers.size() == 1) {
    grid[axis] = AxisRange::fixed(numbers[0] * unit);
  } else if (numbers.size() == 3 && numbers[2] >= 2 && numbers[2] <= 1e6 && numbers[2] == std::floor(numbers[2])) {
    grid[axis] = AxisRange{numbers[0] * unit, numbers[1] * unit, static_cast<std::size_t>(numbers[2]), 0};
  } else {
    fail("one or three numbers are needed, the count a whole number from 2 to 1,000,000");
  }
}

}  // namespace abbe
