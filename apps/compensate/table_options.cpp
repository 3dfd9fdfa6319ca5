#include "compensate/table_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "abbe/formats/input_error.h"
#include "abbe/formats/number_text.h"

namespace abbe {

std::vector<double> reference_pose(const Machine& machine, std::vector<double> positions,
                                   const std::vector<std::string>& at) {
  for (const std::string& text : at) {
    const auto fail = [&](const std::string& problem) {
      throw InputError({.field = "--at " + text}, problem, "AXIS_unit=position, such as X_mm=300 or A_deg=0");
    };
    const std::size_t equals = text.find('='), underscore = text.rfind('_', equals);
    if (equals == std::string::npos || underscore == std::string::npos) fail("not understood");
    const std::size_t axis = machine.find_axis(text.substr(0, underscore));
    if (axis == Machine::npos) fail("the machine has no axis '" + text.substr(0, underscore) + "'");
    const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
    const std::string unit = text.substr(underscore + 1, equals - underscore - 1);
    if (unit != (rotary ? "deg" : "mm")) {
      fail(fmt::format("unit '{}' for a {} axis", unit, rotary ? "rotary" : "linear"));
    }
    double value = 0;
    if (parse_number(std::string_view(text).substr(equals + 1), 0, value) != NumberProblem::none) fail("not a number");
    if (rotary) value *= std::numbers::pi / 180;
    const Axis& one = machine.axes[axis];
    if (!one.endless && (value < one.travel_min || value > one.travel_max)) fail("outside the axis's travel");
    positions[axis] = value;
  }
  return positions;
}

std::vector<bool> chosen_axes(const Machine& machine, const std::vector<std::string>& names) {
  std::vector<bool> chosen(machine.axes.size(), names.empty());
  for (const std::string& name : names) {
    const std::size_t axis = machine.find_axis(name);
    if (axis == Machine::npos) {
      throw InputError({.field = "--axis " + name}, "the machine has no such axis", machine.chain());
    }
    chosen[axis] = true;
  }
  return chosen;
}

std::vector<TableAxisName> table_axis_names(const Machine& machine, const TableFormat& format,
                                            const std::vector<std::string>& names) {
  // Controls count their axes by letter, X Y Z A B C U V W, whatever carries what.
  std::vector<std::size_t> order(machine.axes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto rank = [&](std::size_t i) {
    const std::string letters = "XYZABCUVWPQRDE";
    return std::pair(letters.find(machine.axes[i].name[0]), machine.axes[i].name);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  std::vector<TableAxisName> known;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Axis& axis = machine.axes[order[k]];
    const std::string name = format.default_name ? format.default_name(k, axis) : axis.name;
    known.push_back({order[k], name, axis.kind == AxisKind::rotary});
  }
  for (const std::string& text : names) {
    const auto fail = [&](const std::string& problem) {
      throw InputError({.field = "--name " + text}, problem,
                       "AXIS=NAME, such as X=X1; here the " +
                           (format.axis_names.empty() ? "format names no axes" : format.axis_names));
    };
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) fail("not understood");
    const std::size_t axis = machine.find_axis(text.substr(0, equals));
    if (axis == Machine::npos) fail("the machine has no axis '" + text.substr(0, equals) + "'");
    const std::string name = text.substr(equals + 1);
    const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (name.empty() || name.size() > 32 || !plain) fail("not a name of letters and digits");
    for (TableAxisName& one : known) {
      if (one.axis == axis) one.name = name;
    }
  }
  for (std::size_t a = 0; a < known.size(); ++a) {
    if (find_table_axis(known, known[a].name) != &known[a]) {
      throw InputError({.field = "--name"}, "two axes are called " + known[a].name, "different names");
    }
  }
  return known;
}

}  // namespace abbe
