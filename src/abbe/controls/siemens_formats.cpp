#include <fmt/format.h>

#include <algorithm>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/controls/line_writer.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_siemens.h"

namespace abbe {
namespace {

WrittenTables make_siemens(bool cross, const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                           const WriterRequest& request) {
  WrittenTables made;
  const std::vector<AxisTable> tables = wanted_tables(machine, errors, request, line_options(request, format), made);
  std::vector<AxisTable> read;
  if (!tables.empty()) {
    const std::string name = cross ? "CEC.INI" : "EEC.INI";
    const std::string text =
        cross ? siemens_cec_text(with_sign(tables, request.negate), request.names, request.first_table)
              : siemens_eec_text(tables, request.names, request.encoder);
    read = cross ? with_sign(parse_siemens_cec(text, name, request.names), request.negate)
                 : parse_siemens_eec(text, name, request.names);
    made.files.push_back({name, text});
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

TableFormat siemens_cec_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = "siemens-cec";
  format.control = "SINUMERIK";
  format.kind = TableKind::axis_pairs;
  format.what = "sag and angularity compensation of SINUMERIK ($AN_CEC): each axis corrects itself and the linear axes";
  format.convention =
      "the value is the correction (minus the error), mm or degrees, added to the position setpoint of the output axis "
      "at the setpoint of the input axis. Straight lines between points, the end values outside";
  format.unverified =
      "the sign of the value: the manual says that the setpoint is altered by it; check the first move (--negate)";
  format.takes = {first_table, negate, reference, names, axes, tolerance_mm, tolerance_rad, most_nodes};
  format.axis_names = "machine axis name (AX1, X1)";
  format.most_nodes = 2000;
  format.cannot =
      "each table depends on the position of one axis, and tables add up: an angle times a lever that another axis "
      "changes is corrected only on the lines through the reference pose, and orientation is not corrected";
  format.directions = true;
  format.backlash = [](const std::string& axis, double /*lost_motion*/, bool /*rotary*/) {
    return fmt::format("in tables of direction 1 and -1; MD32450 $MA_BACKLASH of {} stays as it was", axis);
  };
  format.default_name = [](std::size_t index, const Axis& /*axis*/) { return fmt::format("AX{}", index + 1); };
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_siemens(true, format, machine, errors, request);
  };
  return format;
}

TableFormat siemens_eec_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = "siemens-eec";
  format.control = "SINUMERIK";
  format.kind = TableKind::own_axis;
  format.what = "encoder (leadscrew) error compensation of SINUMERIK ($AA_ENC_COMP): each axis corrects itself";
  format.convention =
      "the value is the error (actual minus nominal), mm or degrees, added to the actual position: a positive value "
      "moves the axis in the negative direction. Straight lines between points, the end values outside";
  format.takes = {encoder, reference, names, axes, tolerance_mm, tolerance_rad, most_nodes};
  format.axis_names = "machine axis name (X1)";
  format.most_nodes = 5000;
  format.cannot =
      "an axis is corrected by its own position only: errors across it are not corrected, and an angle times a lever "
      "is corrected only on the line through the reference pose";
  format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
    return fmt::format("MD32450 $MA_BACKLASH of {} compensates it: {}", axis, lost_motion_words(lost_motion, rotary));
  };
  format.default_name = [](std::size_t /*index*/, const Axis& axis) {
    return axis.name.size() == 1 ? axis.name + "1" : axis.name;
  };
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_siemens(false, format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
