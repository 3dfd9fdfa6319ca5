#include "abbe/controls/writer_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "abbe/compensate/tables/line_tables.h"
#include "abbe/controls/joint_order.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

std::set<TableSetting> settings_of(const ControlTableRequest& request) {
  std::set<TableSetting> given;
  const auto add = [&](TableSetting setting, bool is_given) {
    if (is_given) given.insert(setting);
  };
  add(TableSetting::type, request.type.has_value());
  add(TableSetting::first_table, request.first_table.has_value());
  add(TableSetting::encoder, request.encoder.has_value());
  add(TableSetting::negate, request.negate);
  add(TableSetting::negate_own, request.negate_own);
  add(TableSetting::detection_unit, request.detection_unit_mm.has_value());
  add(TableSetting::reference_position, !request.reference_position.empty());
  add(TableSetting::reference, !request.reference.empty());
  add(TableSetting::names, !request.names.empty());
  add(TableSetting::axes, !request.axes.empty());
  add(TableSetting::tolerance_mm, request.tolerance_mm.has_value());
  add(TableSetting::tolerance_rad, request.tolerance_rad.has_value());
  add(TableSetting::most_nodes, request.most_nodes.has_value());
  return given;
}

/// The machine's zero, or the end of the travel that is next to it.
std::vector<double> machine_zero(const Machine& machine) {
  std::vector<double> zero;
  for (const Axis& axis : machine.axes) {
    zero.push_back(axis.endless ? 0 : std::clamp(0.0, axis.travel_min, axis.travel_max));
  }
  return zero;
}

std::vector<double> moved_to(const Machine& machine, TableSetting setting, std::vector<double> positions,
                             const std::vector<HeldAxis>& given) {
  for (const HeldAxis& one : given) {
    if (one.axis >= machine.axes.size()) {
      throw InputError({.field = setting_option(setting)}, fmt::format("the machine has no axis {}", one.axis),
                       "an index into its axes");
    }
    const Axis& axis = machine.axes[one.axis];
    const bool within = axis.endless || (one.position >= axis.travel_min && one.position <= axis.travel_max);
    if (!within) {
      throw InputError({.field = fmt::format("{} {}_{}={:g}", setting_option(setting), axis.name, position_suffix(axis),
                                             one.position / position_unit(axis))},
                       "outside the axis's travel", "a position within it");
    }
    positions[one.axis] = one.position;
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

/// A name that a control can have for an axis. @throws InputError
void check_axis_name(const Machine& machine, const TableFormat& format, const ControlAxisName& given) {
  const auto fail = [&](const std::string& problem) {
    throw InputError({.field = "--name " + given.axis + "=" + given.name}, problem, axis_names_expected(format));
  };
  if (machine.find_axis(given.axis) == Machine::npos) fail("the machine has no axis '" + given.axis + "'");
  const std::string& name = given.name;
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
  if (name.empty() || name.size() > 32 || !plain) fail("not a name of letters and digits");
  const bool number = std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (format.axis_names.starts_with("number") && (!number || name.size() > 4)) fail("'" + name + "' is not a number");
  if (format.axis_names.ends_with("counted from 1") && name.find_first_not_of('0') == std::string::npos) {
    fail("axes are counted from 1");
  }
}

}  // namespace

std::string axis_names_expected(const TableFormat& format) {
  return "AXIS=NAME, such as X=X1; here the " +
         (format.axis_names.empty() ? "format names no axes" : format.axis_names);
}

std::vector<TableAxisName> control_axis_names(const Machine& machine, const TableFormat& format,
                                              const std::vector<ControlAxisName>& given) {
  const std::vector<std::size_t> order = joint_order(machine);
  std::vector<TableAxisName> known;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Axis& axis = machine.axes[order[k]];
    const std::string name = format.default_name ? format.default_name(k, axis) : axis.name;
    known.push_back({order[k], name, axis.kind == AxisKind::rotary});
  }
  for (const ControlAxisName& one : given) {
    check_axis_name(machine, format, one);
    const std::size_t axis = machine.find_axis(one.axis);
    for (TableAxisName& candidate : known) {
      if (candidate.axis == axis) candidate.name = one.name;
    }
  }
  for (const TableAxisName& one : known) {
    if (find_table_axis(known, one.name) != &one) {
      throw InputError({.field = "--name"}, "two axes are called " + one.name, "different names");
    }
  }
  return known;
}

WriterRequest writer_request(const ControlTableRequest& request, const TableFormat& format) {
  refuse_settings_of_other_formats(format, settings_of(request));
  const Machine& machine = request.machine;
  WriterRequest filled;
  filled.tolerance_mm = request.tolerance_mm.value_or(format.default_tolerance_mm);
  filled.tolerance_rad = request.tolerance_rad.value_or(filled.tolerance_rad);
  if (!(filled.tolerance_mm > 0 && filled.tolerance_rad > 0)) {
    throw InputError({.field = "--interpolation-um, --interpolation-urad"}, "not above zero", "a positive number");
  }
  filled.reference =
      moved_to(machine, TableSetting::reference, middle_of_travel(machine, request.errors), request.reference);
  filled.reference_position =
      moved_to(machine, TableSetting::reference_position, machine_zero(machine), request.reference_position);
  filled.axes = chosen_axes(machine, request.axes);
  filled.names = control_axis_names(machine, format, request.names);
  if (request.most_nodes && *request.most_nodes < 2) {
    throw InputError({.field = fmt::format("--max-points {}", *request.most_nodes)}, "is no table", "at least 2 nodes");
  }
  filled.most_nodes = request.most_nodes.value_or(0);
  filled.type = request.type.value_or(filled.type);
  if (filled.type != 0 && filled.type != 1) throw InputError({.field = "--type"}, "unknown type", "0 or 1");
  filled.encoder = request.encoder.value_or(0);
  if (filled.encoder > 1) throw InputError({.field = "--encoder"}, "unknown measuring system", "0 or 1");
  filled.first_table = request.first_table.value_or(0);
  if (filled.first_table > 999) throw InputError({.field = "--first-table"}, "too large", "0 to 999");
  filled.negate = request.negate;
  filled.negate_own = request.negate_own;
  filled.unit_mm = request.detection_unit_mm.value_or(filled.unit_mm);
  if (!(filled.unit_mm >= 1e-6 && filled.unit_mm <= 1e-2)) {
    throw InputError({.field = "--detection-unit-um"}, "out of range", "0.001 to 10 um");
  }
  return filled;
}

}  // namespace abbe
