#include <fmt/format.h>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/controls/line_writer.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_linuxcnc.h"

namespace abbe {
namespace {

WrittenTables make_linuxcnc(const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                            const WriterRequest& request) {
  WrittenTables made;
  const auto type = static_cast<LinuxCncCompensation>(request.type);
  std::vector<AxisTable> read;
  for (const AxisTable& table : wanted_tables(machine, errors, request, line_options(request, format), made)) {
    const TableAxisName& axis = table_axis(request.names, table.input);
    const std::string text = linuxcnc_text(table, axis.rotary, type);
    const std::string name = machine.axes[table.input].name + ".comp";
    made.files.push_back({name, text});
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

}  // namespace

TableFormat linuxcnc_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = "linuxcnc";
  format.control = "LinuxCNC";
  format.kind = TableKind::own_axis;
  format.what = "COMP_FILE of LinuxCNC 2.9, one file per joint";
  format.convention =
      "type 1: nominal position, forward and reverse trim, mm or degrees; the trim is the correction (minus the error) "
      "and is added to the motor command. Type 0: nominal and actual positions, actual = nominal + error. Straight "
      "lines between points, the end values outside";
  format.takes = {type, reference, names, axes, tolerance_mm, tolerance_rad, most_nodes};
  format.axis_names = "number of the joint";
  format.file_per_axis = true;
  format.most_nodes = kLinuxCncPoints;
  format.cannot =
      "a joint is corrected by its own position only: errors across it are not corrected, and an angle times a lever "
      "is corrected only on the line through the reference pose";
  format.directions = true;
  format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
    return fmt::format("in the forward and reverse columns of joint {}; without COMP_FILE its BACKLASH would be {}",
                       axis, lost_motion_words(lost_motion, rotary));
  };
  format.default_name = [](std::size_t index, const Axis& /*axis*/) { return fmt::format("{}", index); };
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_linuxcnc(format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
