#include "compensate/axis_table_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/compensate/line_tables.h"
#include "abbe/compensate/point_correction.h"
#include "abbe/errors/reversal.h"
#include "abbe/formats/table_linuxcnc.h"
#include "abbe/formats/table_siemens.h"
#include "compensate/reversal_words.h"

namespace abbe {
namespace {

constexpr double kDecimalStep_mm = 1e-3;
constexpr double kDecimalStep_rad = 3.14159265358979323846 / 180 * 1e-3;

std::string table_name(const Machine& machine, const AxisTable& table) {
  const std::string& input = machine.axes[table.input].name;
  return table.input == table.output ? input : input + " for " + machine.axes[table.output].name;
}

/// Every k-th position within the travel, so that long tables are looked at in at most some forty places.
std::vector<std::size_t> some_of(const std::vector<double>& positions, const KnownTravel& travel) {
  std::vector<std::size_t> chosen;
  const std::size_t stride = positions.size() / 40 + 1;
  for (std::size_t k = 0; k < positions.size(); k += stride) {
    if (positions[k] >= travel.from - 1e-9 && positions[k] <= travel.to + 1e-9) chosen.push_back(k);
  }
  return chosen;
}

TableSummary summary_of(const Machine& machine, const ErrorSet& known, const AxisTable& table,
                        double interpolation_error, bool within, const std::vector<double>& reference, bool cross) {
  TableSummary summary;
  summary.name = table_name(machine, table);
  summary.nodes = table.positions.size();
  summary.step = table.positions.size() > 1 ? table.positions[1] - table.positions[0] : 0;
  summary.step_is_angle = machine.axes[table.input].kind == AxisKind::rotary;
  summary.is_angle = machine.axes[table.output].kind == AxisKind::rotary;
  summary.interpolation_error = interpolation_error;
  summary.within = within;
  for (std::size_t k = 0; k < table.positions.size(); ++k) {
    const double larger = std::max(std::abs(table.forward[k]), std::abs(table.reverse[k]));
    if (larger < summary.largest) continue;
    summary.largest = larger;
    summary.largest_at = table.positions[k];
  }
  const bool directions = table.forward != table.reverse;
  const std::vector<std::size_t> chosen = some_of(table.positions, known_travel(machine, known, table.input));
  for (const std::size_t k : chosen) {
    summary.positions.push_back(table.positions[k]);
    summary.corrections.push_back(table.forward[k]);
  }
  for (const std::size_t k : chosen) {
    if (directions) summary.corrections.push_back(table.reverse[k]);
  }
  summary.values = [&machine, reference, cross, directions, input = table.input, output = table.output,
                    positions = summary.positions](const ErrorSet& errors) {
    std::vector<double> values = line_correction(machine, errors, reference, input, output, positions, cross);
    if (!directions) return values;
    const std::size_t count = values.size();
    const double half = 0.5 * reversal_of(errors, input);
    for (std::size_t k = 0; k < count; ++k) {
      values.push_back(values[k] + half);
      values[k] -= half;
    }
    return values;
  };
  return summary;
}

}  // namespace

LineTableOptions line_options(const TableRequest& request, const TableFormat& format) {
  LineTableOptions options;
  options.reference = request.reference;
  options.axes = request.axes;
  options.directions = format.directions;
  options.tolerance_mm = request.tolerance_mm;
  options.tolerance_rad = request.tolerance_rad;
  options.most_nodes = request.most_nodes > 0 ? std::min(request.most_nodes, format.most_nodes) : format.most_nodes;
  options.nodes = request.nodes > 0 ? std::min(request.nodes, options.most_nodes) : 0;
  options.step_multiple_mm = kDecimalStep_mm;
  options.step_multiple_rad = kDecimalStep_rad;
  // Below the last digit that is written there is nothing to correct.
  options.negligible_mm = 1e-7;
  options.negligible_rad = 1e-9;
  return options;
}

std::vector<AxisTable> wanted_tables(const Machine& machine, const ErrorSet& errors, const TableRequest& request,
                                     const LineTableOptions& options, ControllerTables& made) {
  const LineTables found = line_tables(machine, errors, options);
  std::vector<AxisTable> tables;
  for (std::size_t t = 0; t < found.tables.size(); ++t) {
    TableSummary summary = summary_of(machine, errors, found.tables[t], found.interpolation_error[t], found.within[t],
                                      request.reference, options.cross);
    if (request.left_out.count(summary.name) != 0) continue;
    made.tables.push_back(std::move(summary));
    tables.push_back(found.tables[t]);
  }
  return tables;
}

std::vector<AxisTable> with_sign(std::vector<AxisTable> tables, bool negate) {
  for (AxisTable& table : tables) {
    for (double& value : table.forward) value = negate ? -value : value;
    for (double& value : table.reverse) value = negate ? -value : value;
  }
  return tables;
}

namespace {

ControllerTables make_linuxcnc(const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                               const TableRequest& request) {
  ControllerTables made;
  const auto type = static_cast<LinuxCncCompensation>(request.type);
  std::vector<AxisTable> read;
  for (const AxisTable& table : wanted_tables(machine, errors, request, line_options(request, format), made)) {
    const TableAxisName& axis = table_axis(request.names, table.input);
    const std::string text = linuxcnc_text(table, axis.rotary, type);
    const std::string name = machine.axes[table.input].name + ".comp";
    made.files.emplace_back(name, text);
    read.push_back(parse_linuxcnc(text, name, axis.rotary, type));
    read.back().input = read.back().output = table.input;
    made.remarks.push_back(
        fmt::format("[JOINT_{}] COMP_FILE = {}, COMP_FILE_TYPE = {}, and no BACKLASH", axis.name, name, request.type));
    if (machine.axes[table.input].endless) {
      made.remarks.push_back(
          fmt::format("outside 0 to 360 degrees LinuxCNC keeps the end values for {}", machine.axes[table.input].name));
    }
  }
  if (!read.empty())
    made.remarks.emplace_back(
        "[TRAJ] LINEAR_UNITS = mm, ANGULAR_UNITS = degree: the files are in these, not in inches");
  made.correction = std::make_unique<AxisTableCorrection>(std::move(read));
  return made;
}

ControllerTables make_siemens(bool cross, const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                              const TableRequest& request) {
  ControllerTables made;
  LineTableOptions options = line_options(request, format);
  options.cross = cross;
  const std::vector<AxisTable> tables = wanted_tables(machine, errors, request, options, made);
  std::vector<AxisTable> read;
  if (!tables.empty()) {
    const std::string name = cross ? "CEC.INI" : "EEC.INI";
    const std::string text =
        cross ? siemens_cec_text(with_sign(tables, request.negate), request.names, request.first_table)
              : siemens_eec_text(tables, request.names, request.encoder);
    read = cross ? with_sign(parse_siemens_cec(text, name, request.names), request.negate)
                 : parse_siemens_eec(text, name, request.names);
    made.files.emplace_back(name, text);
    made.remarks.emplace_back(
        std::string(cross ? "MD32711 $MA_CEC_SCALING_SYSTEM_METRIC" : "MD10240 $MN_SCALING_SYSTEM_IS_METRIC") +
        " = 1: values in mm and degrees, not in inches");
    std::size_t longest = 0;
    for (const AxisTable& table : tables) longest = std::max(longest, table.positions.size());
    if (cross) {
      made.remarks.push_back(fmt::format(
          "tables {} to {}: MD18342 $MN_MM_CEC_MAX_POINTS at least {}; enabled by SD41300 $SN_CEC_TABLE_ENABLE and "
          "MD32710 $MA_CEC_ENABLE",
          request.first_table, request.first_table + tables.size() - 1, longest));
    } else {
      made.remarks.push_back(fmt::format(
          "MD38000 $MA_MM_ENC_COMP_MAX_POINTS at least {}; enabled by MD32700 $MA_ENC_COMP_ENABLE", longest));
    }
  }
  made.correction = std::make_unique<AxisTableCorrection>(std::move(read));
  return made;
}

}  // namespace

TableFormat linuxcnc_format() {
  TableFormat format;
  format.name = "linuxcnc";
  format.what = "COMP_FILE of LinuxCNC 2.9, one file per joint";
  format.convention =
      "type 1: nominal position, forward and reverse trim, mm or degrees; the trim is the correction (minus the error) "
      "and is added to the motor command. Type 0: nominal and actual positions, actual = nominal + error. Straight "
      "lines between points, the end values outside";
  format.axis_names = "number of the joint";
  format.file_per_axis = true;
  format.most_nodes = kLinuxCncPoints;
  format.cannot =
      "a joint is corrected by its own position only, so errors across it are not, and an angle times a lever only on "
      "the line "
      "through the reference pose";
  format.directions = true;
  format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
    return fmt::format("in the forward and reverse columns of joint {}; without COMP_FILE its BACKLASH would be {}",
                       axis, lost_motion_words(lost_motion, rotary));
  };
  format.default_name = [](std::size_t index, const Axis& /*axis*/) { return fmt::format("{}", index); };
  format.make = [format](const Machine& machine, const ErrorSet& errors, const TableRequest& request) {
    return make_linuxcnc(format, machine, errors, request);
  };
  return format;
}

TableFormat siemens_cec_format() {
  TableFormat format;
  format.name = "siemens-cec";
  format.what = "sag and angularity compensation of SINUMERIK ($AN_CEC), every axis for itself and for the linear axes";
  format.convention =
      "the value is the correction (minus the error), mm or degrees, added to the position setpoint of the output axis "
      "at the setpoint of the input axis. Straight lines between points, the end values outside";
  format.unverified =
      "the sign of the value: the manual says that the setpoint is altered by it; check the first move (--negate)";
  format.axis_names = "machine axis name (AX1, X1)";
  format.most_nodes = 2000;
  format.cannot =
      "tables add up, each of one axis's position: an angle times a lever that another axis changes is right "
      "only on the lines through the reference pose, and orientation is not corrected";
  format.directions = true;
  format.backlash = [](const std::string& axis, double /*lost_motion*/, bool /*rotary*/) {
    return fmt::format("in tables of direction 1 and -1; MD32450 $MA_BACKLASH of {} stays as it was", axis);
  };
  format.default_name = [](std::size_t index, const Axis& /*axis*/) { return fmt::format("AX{}", index + 1); };
  format.make = [format](const Machine& machine, const ErrorSet& errors, const TableRequest& request) {
    return make_siemens(true, format, machine, errors, request);
  };
  return format;
}

TableFormat siemens_eec_format() {
  TableFormat format;
  format.name = "siemens-eec";
  format.what = "encoder (leadscrew) error compensation of SINUMERIK ($AA_ENC_COMP), every axis for itself";
  format.convention =
      "the value is the error (actual minus nominal), mm or degrees, added to the actual position: a positive value "
      "moves the axis in the negative direction. Straight lines between points, the end values outside";
  format.axis_names = "machine axis name (X1)";
  format.most_nodes = 5000;
  format.cannot =
      "an axis is corrected by its own position only, so errors across it are not, and an angle times a lever only on "
      "the "
      "line through the reference pose";
  format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
    return fmt::format("MD32450 $MA_BACKLASH of {} takes it: {}", axis, lost_motion_words(lost_motion, rotary));
  };
  format.default_name = [](std::size_t /*index*/, const Axis& axis) {
    return axis.name.size() == 1 ? axis.name + "1" : axis.name;
  };
  format.make = [format](const Machine& machine, const ErrorSet& errors, const TableRequest& request) {
    return make_siemens(false, format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
