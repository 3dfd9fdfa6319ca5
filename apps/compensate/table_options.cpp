#include "compensate/table_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/input_error.h"
#include "axis_option.h"
#include "compensate/joint_order.h"

namespace abbe {

std::vector<double> pose_option(const Machine& machine, const std::string& option, std::vector<double> positions,
                                const std::vector<std::string>& at) {
  for (const std::string& text : at) {
    const HeldAxis at_position = axis_option(machine, option, text);
    const Axis& axis = machine.axes[at_position.axis];
    if (!axis.endless && (at_position.position < axis.travel_min || at_position.position > axis.travel_max)) {
      throw InputError({.field = option + " " + text}, "outside the axis's travel", "a position within it");
    }
    positions[at_position.axis] = at_position.position;
  }
  return positions;
}

std::vector<double> machine_zero(const Machine& machine) {
  std::vector<double> zero;
  for (const Axis& axis : machine.axes) {
    zero.push_back(axis.endless ? 0 : std::clamp(0.0, axis.travel_min, axis.travel_max));
  }
  return zero;
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

const std::vector<FormatOption>& format_options() {
  static const std::vector<FormatOption> kOptions = [] {
    const auto all_but = [](const std::vector<std::string>& others) {
      std::vector<std::string> names;
      for (const TableFormat& format : table_formats()) {
        if (std::find(others.begin(), others.end(), format.name) == others.end()) names.push_back(format.name);
      }
      return names;
    };
    const std::vector<std::string> with_nodes = all_but({"klipper", "marlin"});
    return std::vector<FormatOption>{
        {"--type", {"linuxcnc"}},
        {"--first-table", {"siemens-cec"}},
        {"--encoder", {"siemens-eec"}},
        {"--negate", {"siemens-cec", "heidenhain", "fanuc-pitch", "fanuc-3d"}},
        {"--detection-unit-um", {"fanuc-pitch", "fanuc-3d"}},
        {"--reference-position", {"fanuc-pitch", "fanuc-3d"}},
        {"--at", all_but({"beckhoff-isg", "etalon"})},
        {"--name", with_nodes},
        {"--axis", with_nodes},
        {"--interpolation-um", with_nodes},
        {"--interpolation-urad", all_but({"klipper", "marlin", "fanuc-3d"})},
        {"--max-points", with_nodes},
    };
  }();
  return kOptions;
}

void refuse_options_of_other_formats(const TableFormat& format, const std::vector<std::string>& given) {
  for (const FormatOption& option : format_options()) {
    if (std::find(given.begin(), given.end(), option.name) == given.end()) continue;
    if (std::find(option.formats.begin(), option.formats.end(), format.name) != option.formats.end()) continue;
    std::string others;
    for (const std::string& name : option.formats) others += (others.empty() ? "" : ", ") + name;
    throw InputError({.field = option.name}, "would change nothing in tables for " + format.name,
                     "--for " + others + "; or to leave it out");
  }
}

std::vector<TableAxisName> table_axis_names(const Machine& machine, const TableFormat& format,
                                            const std::vector<std::string>& names) {
  const std::vector<std::size_t> order = joint_order(machine);
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
    const bool number = std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (format.axis_names.starts_with("number") && (!number || name.size() > 4)) fail("'" + name + "' is not a number");
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
