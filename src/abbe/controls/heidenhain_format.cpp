#include <fmt/format.h>

#include <algorithm>

#include "abbe/controls/line_writer.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_heidenhain.h"

namespace abbe {
namespace {

WrittenTables make_heidenhain(const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                              const WriterRequest& request) {
  WrittenTables made;
  const std::vector<AxisTable> tables = wanted_tables(machine, errors, request, line_options(request, format), made);
  const double sign = request.negate ? 1 : -1;
  std::vector<AxisTable> read;
  std::vector<std::size_t> inputs;
  std::vector<HeidenhainAssignment> assigned;
  for (const AxisTable& table : tables) {
    if (std::find(inputs.begin(), inputs.end(), table.input) == inputs.end()) inputs.push_back(table.input);
  }
  for (const std::size_t input : inputs) {
    std::vector<AxisTable> of_input;
    for (const AxisTable& table : tables) {
      if (table.input == input) of_input.push_back(table);
    }
    const std::string name = table_axis(request.names, input).name + ".COM";
    const std::string text = heidenhain_com_text(of_input, request.names, sign);
    made.files.push_back({name, text});
    assigned.push_back({table_axis(request.names, input).name, name});
    for (AxisTable& table : parse_heidenhain_com(text, name, input, request.names, sign)) {
      // A rotary axis has entries from 0 to 360 degrees, and repeats itself.
      table.modulo = machine.axes[input].endless;
      read.push_back(std::move(table));
    }
  }
  if (!inputs.empty()) made.files.push_back({"CONFIG.CMA", heidenhain_assignment_text(assigned)});
  made.correction = std::make_unique<AxisTableCorrection>(std::move(read));
  return made;
}

}  // namespace

TableFormat heidenhain_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = "heidenhain";
  format.control = "HEIDENHAIN";
  format.kind = TableKind::axis_pairs;
  format.what =
      "compensation-value tables of HEIDENHAIN (*.COM, CONFIG.CMA): each axis corrects itself and the linear axes";
  format.convention =
      "AXISPOS in mm or degrees from the machine datum; values are errors (actual minus nominal), mm or degrees; "
      "straight "
      "lines between points";
  format.unverified =
      "header and end of the text (BEGIN, NR, [END]); the sign of the values (--negate); that the end values hold "
      "outside; BACKLASH is not written";
  format.takes = {negate, reference, names, axes, tolerance_mm, tolerance_rad, most_nodes};
  format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
    return fmt::format(
        "handled by the backlash compensation of {} (column BACKLASH or its parameter; sign not verified): {}", axis,
        lost_motion_words(lost_motion, rotary));
  };
  format.axis_names = "axis key of CfgAxes/axisList";
  format.most_nodes = kHeidenhainPoints;
  format.cannot =
      "each table depends on the position of one axis, and tables add up: an angle times a lever that another axis "
      "changes is corrected only on the lines through the reference pose, and the direction of the tool is not "
      "corrected";
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_heidenhain(format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
