#include <fmt/format.h>

#include <string_view>

#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/error_tables.h"
#include "abbe/controls/error_model_writer.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_volumetric.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

void check_model(const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
  if (errors.composition.order != ErrorOrder::iso || errors.composition.first_order) {
    throw InputError({.field = "--for"}, "these errors are not in the composition `iso`",
                     "errors of ISO 230-1: the control composes them itself");
  }
  for (const TableAxisName& axis : request.names) {
    if (axis.name.size() != 1 || std::string_view("XYZABC").find(axis.name[0]) == std::string_view::npos) {
      throw InputError({.field = "--name " + machine.axes[axis.axis].name + "=" + axis.name},
                       "the format knows no such axis", "one of the letters X Y Z A B C");
    }
  }
}

void add_summaries(const Machine& machine, const ErrorSet& written, const BuiltErrorTables& built,
                   const ErrorTableOptions& options, WrittenTables& made) {
  for (std::size_t t = 0; t < built.tables.tables.size(); ++t) {
    const ErrorTable& table = built.tables.tables[t];
    for (std::size_t c = 0; c < table.components.size(); ++c) {
      const Component component = table.components[c];
      std::vector<double> corrections = table.values[c];
      for (double& value : corrections) value = -value;
      WrittenTable summary =
          summary_of(error_motion_name(machine, table.axis, component), table.positions, corrections);
      summary.step_is_angle = machine.axes[table.axis].kind == AxisKind::rotary;
      summary.is_angle = is_rotation(component);
      summary.interpolation_error = built.interpolation_error[t][c];
      summary.within = summary.interpolation_error <= (summary.is_angle ? options.tolerance_rad : options.tolerance_mm);
      summary.values = [axis = table.axis, component, positions = summary.positions](const ErrorSet& errors) {
        std::vector<double> values;
        for (const double q : positions) {
          values.push_back(-errors.evaluate(axis, q)[static_cast<std::size_t>(component)]);
        }
        return values;
      };
      made.tables.push_back(std::move(summary));
    }
  }
  for (const LocationError& location : written.locations) made.tables.push_back(summary_of(machine, location));
}

/// Configuration list with the documented names: axes by number in the order X Y Z A B C, sides, file.
std::string isg_list(const Machine& machine, const WriterRequest& request) {
  std::string text = "# Volumetric compensation of " + machine.chain() + "; logical axis numbers have to be set\n";
  text += fmt::format("workpiece_axes           {}\n", machine.workpiece_axis_count());
  std::size_t number = 0;
  for (const TableAxisName& axis : request.names) text += fmt::format("{:<24} {}\n", axis.name, ++number);
  return text +
         "Interpolation            GRID\nfile[0]                  volcomp.csv\nfile_format[0]           ISG_CSV\n";
}

WrittenTables make_volumetric(bool isg, const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                              const WriterRequest& request) {
  check_model(machine, errors, request);
  const ErrorSet written = wanted_errors(machine, errors, request);
  WrittenTables made;
  std::unique_ptr<PointCorrection> correction;
  if (request.nodes > 0 || (written.motions.empty() && written.locations.empty())) {
    correction = std::make_unique<PointCorrection>(machine, written);
  } else {
    ErrorTableOptions options;
    options.tolerance_mm = request.tolerance_mm;
    options.tolerance_rad = request.tolerance_rad;
    options.most_nodes = request.most_nodes > 0 ? request.most_nodes : format.most_nodes;
    const BuiltErrorTables built = build_error_tables(machine, written, options);
    add_summaries(machine, written, built, options, made);
    const std::string name = isg ? "volcomp.csv" : "etalon.txt";
    const std::string text = isg ? isg_csv_text(built.tables, request.names) : etalon_text(built.tables, request.names);
    const ErrorTables read = isg ? parse_isg_csv(text, name, request.names) : parse_etalon(text, name, request.names);
    made.files.push_back({name, text});
    if (isg) {
      made.files.push_back({"volcomp.lis", isg_list(machine, request)});
      std::size_t rows = built.tables.locations.empty() ? 0 : 1;
      for (const ErrorTable& table : built.tables.tables) rows += table.positions.size();
      made.remarks.push_back(
          fmt::format("vol_comp[0].max_records at least {}; chain of the machine: {}", rows, machine.chain()));
    }
    correction = std::make_unique<PointCorrection>(machine, errors_of(read));
  }
  correction->set_rotary_corrected(false);
  made.correction = std::move(correction);
  return made;
}

}  // namespace

TableFormat beckhoff_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = "beckhoff-isg";
  format.control = "Beckhoff TwinCAT, ISG";
  format.kind = TableKind::error_model;
  format.what =
      "volumetric compensation of Beckhoff (TF5280) and ISG controls: error motions and position errors, ISG_CSV";
  format.convention =
      "values are errors (actual minus nominal), mm and rad, at positions in mm and degrees; the control computes the "
      "correction of X, Y and Z from them with its own model and straight lines between positions";
  format.unverified =
      "that the control composes error motions as ISO 230-1 does with the reference points of the machine file "
      "(alternative_model), its kinematic chain (Chain), how it counts the sign of errors of axes that carry the "
      "workpiece, and position errors (it offers `negate` per axis); that it takes errors where the corrected axes "
      "stand";
  format.takes = {names, axes, tolerance_mm, tolerance_rad, most_nodes};
  format.axis_names = "letter X Y Z A B C";
  format.most_nodes = 10000;
  format.cannot =
      "tool offset errors are not written, and the control corrects only X, Y and Z: the direction of the tool is not "
      "corrected";
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_volumetric(true, format, machine, errors, request);
  };
  return format;
}

TableFormat etalon_format() {
  TableFormat format = beckhoff_format();
  format.name = "etalon";
  format.control = "ISG, exchange format of Etalon";
  format.what = "exchange format of Etalon, variant \"Vendor\": one grid of points per error motion, position errors";
  format.unverified += "; of the exchange format only what the manual of the ISG control shows is known";
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_volumetric(false, format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
