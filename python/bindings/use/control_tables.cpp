#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/set.h>
#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "abbe/controls/table_map.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/geometry/angle_units.h"
#include "bindings/files.h"
#include "bindings/use/carried_figures.h"
#include "bindings/use/table_result.h"

namespace abbe::python {
namespace {

struct TableArguments {
  AxisPositions at;
  std::vector<std::string> axes;
  std::map<std::string, std::string> names;
  std::optional<double> interpolation_um, interpolation_urad;
  std::optional<std::size_t> max_points, positions;
  std::optional<double> limit_um, limit_urad;
  double least_reduction_percent = 1, leave_out = 0;
  std::optional<int> type;
  std::optional<std::size_t> first_table, encoder;
  bool negate = false, negate_own = false;
  std::optional<double> detection_unit_um;
  AxisPositions reference_position;
};

/// Settings that are given, which the format has to have a use for.
std::set<TableSetting> given_settings(const TableArguments& given) {
  std::set<TableSetting> settings;
  const auto add = [&](bool is_given, TableSetting setting) {
    if (is_given) settings.insert(setting);
  };
  add(given.type.has_value(), TableSetting::type);
  add(given.first_table.has_value(), TableSetting::first_table);
  add(given.encoder.has_value(), TableSetting::encoder);
  add(given.negate, TableSetting::negate);
  add(given.negate_own, TableSetting::negate_own);
  add(given.detection_unit_um.has_value(), TableSetting::detection_unit);
  add(!given.reference_position.empty(), TableSetting::reference_position);
  add(!given.at.empty(), TableSetting::reference);
  add(!given.names.empty(), TableSetting::names);
  add(!given.axes.empty(), TableSetting::axes);
  add(given.interpolation_um.has_value(), TableSetting::tolerance_mm);
  add(given.interpolation_urad.has_value(), TableSetting::tolerance_rad);
  add(given.max_points.has_value(), TableSetting::most_nodes);
  return settings;
}

std::optional<double> scaled(std::optional<double> value, double unit) {
  if (value) *value *= unit;
  return value;
}

TableResult tables_of(const MachineErrors& errors, const std::string& format, const TableArguments& given,
                      bool accept_misfit, const std::string& errors_file) {
  naming_arguments([&] { refuse_settings_of_other_formats(table_format(format), given_settings(given)); });
  require_trusted(errors, accept_misfit, errors_file);
  if (!(given.least_reduction_percent >= 0 && given.least_reduction_percent <= 100)) {
    throw InputError({.field = "least_reduction_percent"}, fmt::format("is {}", given.least_reduction_percent),
                     "0 to 100");
  }
  ControlTableRequest request;
  request.format = format;
  request.machine = errors.machine;
  request.errors = errors.set();
  request.errors_file = errors_file;
  request.covariance = errors.file.covariance;
  request.reference = axis_positions(errors.machine, "at", given.at);
  request.reference_position = axis_positions(errors.machine, "reference_position", given.reference_position);
  request.axes = given.axes;
  for (const auto& [axis, name] : given.names) request.names.push_back({axis, name});
  request.tolerance_mm = scaled(given.interpolation_um, 1e-3);
  request.tolerance_rad = scaled(given.interpolation_urad, 1e-6);
  request.most_nodes = given.max_points;
  request.type = given.type;
  request.encoder = given.encoder;
  request.first_table = given.first_table;
  request.negate = given.negate;
  request.negate_own = given.negate_own;
  request.detection_unit_mm = scaled(given.detection_unit_um, 1e-3);
  request.positions = given.positions;
  request.limit_mm = scaled(given.limit_um, 1e-3);
  request.limit_rad = scaled(given.limit_urad, 1e-6);
  request.least_reduction = 0.01 * given.least_reduction_percent;
  request.leave_out_below = given.leave_out;
  TableResult result{errors.machine, {}, partial_errors(errors.machine, errors.file)};
  result.made = computed([&] { return make_control_tables(request); });
  return result;
}

std::string refusal(const ControlTables& made) {
  std::string words;
  for (const std::string& reason : made.refused) words += (words.empty() ? "" : "; ") + reason;
  if (!made.too_few_nodes.empty()) words += (words.empty() ? "" : "; ") + made.too_few_nodes;
  return argument_words(words);
}

std::vector<std::string> write_tables(const TableResult& result, const std::filesystem::path& folder) {
  refuse_to_write(refusal(result.made));
  std::vector<std::string> written;
  if (result.made.files.empty()) return written;
  ResultsFolder output(folder);
  for (const ControlFile& file : result.made.files) {
    output.write(file.name, file.text);
    written.push_back((folder / file.name).string());
  }
  output.commit();
  return written;
}

void write_table_file(const TableResult& result, const std::filesystem::path& path, bool overwrite) {
  refuse_to_write(refusal(result.made));
  if (result.made.files.size() != 1) {
    throw InputError({.file = path.string()}, fmt::format("{} files are to be written", result.made.files.size()),
                     "write(folder), or one axis with axes=[...]");
  }
  write_text(path, result.made.files.front().text, overwrite);
}

TableReport report(const TableResult& result, const std::vector<std::string>& written) {
  return {result.machine, result.made, result.partial, written};
}

void bind_figures(nb::class_<TableResult>& bound) {
  bound
      .def_prop_ro(
          "tables", [](const TableResult& r) { return r.made.tables; }, "Figures of every table.")
      .def_prop_ro(
          "left_out", [](const TableResult& r) { return r.made.left_out; },
          "Tables that were left out because of their uncertainty.")
      .def_prop_ro(
          "left_out_kept", [](const TableResult& r) { return r.made.left_out_kept; },
          "Tables that are small by themselves, but not together.")
      .def_prop_ro(
          "reversals",
          [](const TableResult& r) {
            std::map<std::string, std::string> notes;
            for (const ControlNote& note : r.made.reversals) notes[note.name] = note.words;
            return notes;
          },
          "Where reversal values are, or what of the control takes them.")
      .def_prop_ro(
          "left_by_tables_mm", [](const TableResult& r) { return r.made.left_by_tables; },
          "Volumetric error that these tables leave, the datum fitted.")
      .def_prop_ro(
          "uncertainty_mm", [](const TableResult& r) { return r.made.uncertainty; },
          "Standard uncertainty of the displacement that is corrected; None: not stated.")
      .def_prop_ro(
          "largest_mm", [](const TableResult& r) { return std::pair(r.made.largest_mm, r.made.largest_mm_at); },
          "Largest sum of corrections of one linear axis, and where.")
      .def_prop_ro(
          "largest_rad", [](const TableResult& r) { return std::pair(r.made.largest_rad, r.made.largest_rad_at); },
          "Largest sum of corrections of one rotary axis, and where.");
}

}  // namespace

void bind_control_tables(nb::module_& module) {
  bind_table_parts(module);
  nb::class_<TableResult> bound(
      module, "ControlTables",
      "Correction tables for a control, and what they do and do not carry. Made by control_tables().");
  bound
      .def_prop_ro(
          "files",
          [](const TableResult& r) {
            nb::dict files;
            for (const ControlFile& file : r.made.files) files[nb::str(file.name.c_str())] = text_of_bytes(file.text);
            return files;
          },
          nb::sig("def files(self) -> dict[str, str]"),
          "Texts of the files by their names; empty where says_no, and where there is nothing to correct.")
      .def_prop_ro(
          "too_few_nodes", [](const TableResult& r) { return argument_words(r.made.too_few_nodes); },
          "Why not, although nothing is refused: there is no room for the nodes that are needed.")
      .def_prop_ro(
          "format", [](const TableResult& r) { return r.made.format; }, nb::rv_policy::copy,
          "The format that the tables are in.")
      .def(
          "map_csv", [](const TableResult& r) { return map_csv(control_table_map(r.machine, r.made)); },
          "Map of the deviations without tables, with tables and ideal, as CSV.")
      .def(
          "map_vtk",
          [](const TableResult& r) {
            const std::string text = map_vtk(control_table_map(r.machine, r.made));
            return nb::bytes(text.data(), text.size());
          },
          "The same as a VTK XML file: .vts where map_is_structured, else .vtu.")
      .def_prop_ro("map_is_structured",
                   [](const TableResult& r) { return map_is_structured(control_table_map(r.machine, r.made)); })
      .def(
          "text",
          [](const TableResult& r, const std::vector<std::string>& written) { return table_text(report(r, written)); },
          nb::arg("written") = std::vector<std::string>{},
          "What `abbe compensate table` prints. written: names of files, as write() returns them.")
      .def(
          "to_dict",
          [](const TableResult& r, const std::vector<std::string>& written) {
            return python_value(table_json(report(r, written)));
          },
          nb::arg("written") = std::vector<std::string>{},
          nb::sig("def to_dict(self, written: Sequence[str] = []) -> dict[str, typing.Any]"),
          "The same as `abbe compensate table --json`.")
      .def("write", &write_tables, nb::arg("folder"),
           "Writes the files to a new or empty folder, or one with older results, whole or not at all.\n\n"
           "Returns their names. Raises InputError if the tables must not be used, and for another folder.")
      .def("write_file", &write_table_file, nb::arg("path"), nb::arg("overwrite") = false,
           "Writes the only file. Raises InputError if there are several, or if it must not be used.")
      .def("__repr__", [](const TableResult& r) {
        return fmt::format("<abbe.ControlTables for {}: {} files, {} tables{}>",
                           r.made.format ? r.made.format->name : "no control", r.made.files.size(),
                           r.made.tables.size(), r.made.says_no() ? ", refused" : "");
      });
  bind_figures(bound);
  add_carried_figures(bound, "tables", "without tables", "with these tables");
  module.def(
      "control_tables",
      [](const MachineErrors& errors, const std::string& format, AxisPositions at, std::vector<std::string> axes,
         std::map<std::string, std::string> names, std::optional<double> interpolation_um,
         std::optional<double> interpolation_urad, std::optional<std::size_t> max_points,
         std::optional<std::size_t> positions, std::optional<double> limit_um, std::optional<double> limit_urad,
         double least_reduction_percent, double leave_out, std::optional<int> type,
         std::optional<std::size_t> first_table, std::optional<std::size_t> encoder, bool negate, bool negate_own,
         std::optional<double> detection_unit_um, AxisPositions reference_position, bool accept_misfit,
         const std::string& errors_file) {
        return tables_of(errors, format,
                         {std::move(at), std::move(axes), std::move(names), interpolation_um, interpolation_urad,
                          max_points, positions, limit_um, limit_urad, least_reduction_percent, leave_out, type,
                          first_table, encoder, negate, negate_own, detection_unit_um, std::move(reference_position)},
                         accept_misfit, errors_file);
      },
      nb::arg("errors"), nb::arg("format"), nb::kw_only(), nb::arg("at") = AxisPositions{},
      nb::arg("axes") = std::vector<std::string>{}, nb::arg("names") = std::map<std::string, std::string>{},
      nb::arg("interpolation_um") = nb::none(), nb::arg("interpolation_urad") = nb::none(),
      nb::arg("max_points") = nb::none(), nb::arg("positions") = nb::none(), nb::arg("limit_um") = nb::none(),
      nb::arg("limit_urad") = nb::none(), nb::arg("least_reduction_percent") = 1.0,
      nb::arg("leave_out_below_uncertainty") = 0.0, nb::arg("type") = nb::none(), nb::arg("first_table") = nb::none(),
      nb::arg("encoder") = nb::none(), nb::arg("negate") = false, nb::arg("negate_own") = false,
      nb::arg("detection_unit_um") = nb::none(), nb::arg("reference_position") = AxisPositions{},
      nb::arg("accept_misfit") = false, nb::arg("errors_file") = "errors.toml",
      "Correction tables for a control, read back and tried in a simulated control.\n\n"
      "format: a name of table_formats(), such as 'linuxcnc'. at: {'Z_mm': -100}, where an axis stands while another\n"
      "one moves. axes: only tables over their positions. names: {'X': 'X1'}, what the control calls an axis.\n"
      "interpolation_um, interpolation_urad: largest error of straight lines between nodes. max_points: room for\n"
      "nodes. positions: per axis of the grid where deviations are stated. limit_um, limit_urad: larger corrections\n"
      "are refused; least_reduction_percent: as are tables that remove less of the error. type (linuxcnc),\n"
      "first_table (siemens-cec), encoder (siemens-eec), negate, negate_own (heidenhain-kinematics-comp),\n"
      "detection_unit_um and reference_position (FANUC): refused with other formats. Raises InputError.\n"
      "Formats and method: docs/controller-tables.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_motion('EXX', coefficients_um=[0, 20])\n"
      ">>> tables = abbe.control_tables(errors, 'linuxcnc')\n"
      ">>> tables.refused, list(tables.files)\n"
      "([], ['X.comp'])\n");
  module.def(
      "table_formats", [] { return table_formats(); }, "All formats of control_tables().");
}

}  // namespace abbe::python
