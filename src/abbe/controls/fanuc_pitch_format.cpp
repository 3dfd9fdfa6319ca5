#include <fmt/format.h>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/controls/line_writer.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_fanuc.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

WrittenTables make_fanuc(const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                         const WriterRequest& request) {
  WrittenTables made;
  const auto unit_of = [&](std::size_t axis) { return request.unit_mm * position_unit(machine.axes[axis]); };
  std::vector<FanucPitch> pitches;
  std::vector<double> constants;  // of the tables at their reference positions, where the data are zero
  std::size_t first_point = 0;
  LineTableOptions options = line_options(request, format);
  options.anchors = request.reference_position;
  for (const AxisTable& table : wanted_tables(machine, errors, request, options, made)) {
    const bool rotary = machine.axes[table.input].kind == AxisKind::rotary;
    const double unit = unit_of(table.input), reference = request.reference_position[table.input];
    if (table.modulo && reference != 0) {
      throw InputError({.field = "--reference-position"}, machine.axes[table.input].name + " is endless",
                       "its reference position at zero");
    }
    pitches.push_back(fanuc_pitch(with_sign({table}, request.negate).front(), unit, first_point, reference));
    const FanucPitch& pitch = pitches.back();
    constants.push_back(table.forward[pitch.reference_point - first_point]);
    first_point += table.positions.size();
    made.remarks.push_back(fmt::format(
        "{}: data rounded to {:g} {}; they are zero at the reference position of the control (its parameter 1240, "
        "machine coordinate {:g} {} of the machine file; --reference-position says where else it is), which must be "
        "shifted by {:.2f} {} (the figures above assume that it is)",
        machine.axes[table.input].name, micro_per_unit(rotary) * unit * pitch.magnification, micro_unit(rotary),
        reference / position_unit(machine.axes[table.input]), position_suffix(machine.axes[table.input]),
        micro_per_unit(rotary) * constants.back(), micro_unit(rotary)));
  }
  std::vector<AxisTable> read;
  if (!pitches.empty()) {
    const std::string name = "PITCH.PRM";
    const std::string text = fanuc_pitch_text(pitches, request.names);
    made.files.push_back({name, text});
    for (const FanucPitch& pitch : parse_fanuc_pitch(text, name, request.names)) {
      AxisTable table =
          with_sign({fanuc_table(pitch, unit_of(pitch.axis), request.reference_position[pitch.axis])}, request.negate)
              .front();
      for (std::size_t p = 0; p < pitches.size(); ++p) {
        if (pitches[p].axis != pitch.axis) continue;
        for (double& value : table.forward) value += constants[p];
      }
      table.reverse = table.forward;
      table.modulo = machine.axes[pitch.axis].endless;
      read.push_back(std::move(table));
    }
  }
  made.correction = std::make_unique<AxisTableCorrection>(std::move(read));
  return made;
}

}  // namespace

TableFormat fanuc_pitch_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = "fanuc-pitch";
  format.control = "FANUC";
  format.kind = TableKind::own_axis;
  format.what = "stored pitch error compensation of FANUC as a parameter file: each axis corrects itself";
  format.convention =
      "steps of the correction (minus the error) from point to point in whole detection units times the magnification, "
      "zero at the reference position; straight lines between points";
  format.unverified =
      "the numbers of data blocks (10000 + point) and of the parameters for a given control, the sign (--negate), that "
      "the control interpolates between points, largest step and number of points";
  format.takes = {negate, detection_unit, reference_position, reference, names,
                  axes,   tolerance_mm,   tolerance_rad,      most_nodes};
  format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
    return fmt::format("parameter 1851 of axis {} compensates it, in detection units (sign not verified): {}", axis,
                       lost_motion_words(lost_motion, rotary));
  };
  format.axis_names = "number of the controlled axis";
  format.most_nodes = kFanucPoints;
  format.cannot =
      "an axis is corrected by its own position only, in whole units and zero at its reference position; a constant is "
      "corrected by the reference position";
  format.default_name = [](std::size_t index, const Axis& /*axis*/) { return fmt::format("{}", index + 1); };
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_fanuc(format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
