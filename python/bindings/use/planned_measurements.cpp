#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bindings/arrays_of_each.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/tables.h"
#include "bindings/use/measurement_request.h"

namespace abbe::python {
namespace {

/// What words stand for. @throws InputError that names them all
template <class Value>
Value named_value(const char* name, const std::string& word, std::optional<Value> (*find)(const std::string&),
                  const std::vector<std::string>& known) {
  if (const std::optional<Value> value = find(word)) return *value;
  refuse_word(name, word, known);
}

PlannedMeasurement planned_of(const Machine& machine, const ReadingsToTake& readings, const std::string& dialect,
                              const std::string& name, std::map<std::string, std::string> words,
                              std::optional<int> decimals, bool machine_coordinates,
                              std::optional<double> feed_mm_per_min, double dwell_s, double reading_s,
                              const std::string& trigger, std::optional<int> trigger_number, double pulse_s,
                              const std::string& stop_at, bool shorten, const AxisPositions& start,
                              ObstacleBoxes obstacle_boxes_mm, ObstacleMeshes obstacle_meshes, double tool_radius_mm,
                              double tool_length_mm, double clearance_mm, AxisPositions clear_at,
                              double linear_speed_mm_per_s, double rotary_speed_deg_per_s,
                              const std::optional<std::string>& readings_file) {
  const NcDialect control = named_value("dialect", dialect, &nc_dialect, nc_dialect_names());
  const NcTrigger on = named_value("trigger", trigger, &nc_trigger, nc_trigger_names());
  const MeasurementSections sections =
      named_value("stop_at", stop_at, &measurement_sections, measurement_section_names());
  MeasurementRequest request = measurement_request(machine, readings, readings_file,
                                                   {std::move(obstacle_boxes_mm), std::move(obstacle_meshes),
                                                    tool_radius_mm, tool_length_mm, clearance_mm, std::move(clear_at)},
                                                   {std::move(words), decimals, feed_mm_per_min, dwell_s});
  request.program.dialect = control;
  request.program.name = nc_program_name(name);
  request.program.machine_coordinates = machine_coordinates;
  request.program.reading = standing_time("reading_s", reading_s);
  request.program.trigger = on;
  if (trigger_number) {
    request.program.number = static_cast<int>(number_within("trigger_number", *trigger_number, 0, 99999));
  }
  request.program.pulse = standing_time("pulse_s", pulse_s);
  request.sections = sections;
  request.shorten = shorten;
  request.start = axis_positions(machine, "start", start);
  request.linear_speed = number_within("linear_speed_mm_per_s", linear_speed_mm_per_s, 1e-9, 1e9);
  request.rotary_speed = number_within("rotary_speed_deg_per_s", rotary_speed_deg_per_s, 1e-9, 1e9) * kDegree;
  return computed([&] { return plan_measurement(request); });
}

nb::object rows_of(const std::vector<std::vector<double>>& poses, std::size_t axes) {
  std::vector<double> values;
  for (const std::vector<double>& pose : poses) values.insert(values.end(), pose.begin(), pose.end());
  return array_of(std::move(values), {poses.size(), axes});
}

nb::object planned_positions(const PlannedMeasurement& planned) {
  std::vector<std::vector<double>> poses;
  for (const PlannedReading& reading : planned.readings) poses.push_back(reading.pose);
  return rows_of(poses, planned.machine.axes.size());
}

void bind_planned_readings(nb::module_& module) {
  nb::class_<PlannedReading>(module, "PlannedReading", "A reading of a measuring program.")
      .def_ro("number", &PlannedReading::number, "Row of the readings, from 1.")
      .def_prop_ro(
          "line",
          [](const PlannedReading& r) { return r.listed.line > 0 ? std::optional(r.listed.line) : std::nullopt; },
          "Line of the file, from 1; None: in no file.")
      .def_prop_ro("setup", [](const PlannedReading& r) { return r.listed.setup; })
      .def_prop_ro("station", [](const PlannedReading& r) { return r.listed.station; })
      .def_prop_ro(
          "target", [](const PlannedReading& r) { return r.listed.what; }, "Reflector, item or target.")
      .def_prop_ro("point", [](const PlannedReading& r) { return r.listed.point; })
      .def_prop_ro(
          "position_mm_rad", [](const PlannedReading& r) { return copied_array(r.pose); },
          nb::sig("def position_mm_rad(self) -> numpy.ndarray"), "[axes] commands as the program states them.")
      .def_prop_ro(
          "via_mm_rad", [](const PlannedReading& r) { return rows_of(r.via, r.pose.size()); },
          nb::sig("def via_mm_rad(self) -> numpy.ndarray"), "[k, axes] commands on the way to it; k = 0: straight.")
      .def("__repr__", [](const PlannedReading& r) {
        return fmt::format("<abbe.PlannedReading {}: {} poses on the way>", r.number, r.via.size());
      });
  nb::class_<PlannedSection>(module, "MeasurementSection", "Readings that are taken without a stop of the program.")
      .def_ro("setup", &PlannedSection::setup, "Empty: not stated.")
      .def_ro("station", &PlannedSection::station)
      .def_ro("words", &PlannedSection::words, "What the program tells the operator.")
      .def_ro("first", &PlannedSection::first, "Index of its first reading in readings.")
      .def_ro("count", &PlannedSection::count, "Number of its readings.")
      .def("__repr__", [](const PlannedSection& s) {
        return fmt::format("<abbe.MeasurementSection '{}': {} readings>", s.words, s.count);
      });
}

void bind_contents(nb::class_<PlannedMeasurement>& bound) {
  bound.def_ro("machine", &PlannedMeasurement::machine)
      .def_ro("dialect", &PlannedMeasurement::dialect)
      .def_prop_ro(
          "program",
          [](const PlannedMeasurement& p) { return p.refused.empty() ? std::optional(p.program) : std::nullopt; },
          "Text of the program; None: refused.")
      .def_prop_ro(
          "refused", [](const PlannedMeasurement& p) { return argument_words(p.refused); },
          "Why there is no program: the readings, the obstacle and where; empty: there is one.")
      .def_prop_ro(
          "notes",
          [](const PlannedMeasurement& p) {
            std::vector<std::string> notes;
            for (const std::string& note : p.notes) notes.push_back(argument_words(note));
            return notes;
          },
          "What the operator has to know, a sentence each.")
      .def_ro("readings", &PlannedMeasurement::readings, "In the order of the program.")
      .def_ro("sections", &PlannedMeasurement::sections, "The program stops before each if there are several.")
      .def_ro("obstacles", &PlannedMeasurement::obstacles, "Names of those that were checked.")
      .def_prop_ro("positions_mm_rad", &planned_positions, nb::sig("def positions_mm_rad(self) -> numpy.ndarray"),
                   "[n, axes] commands of the readings, rounded as in the program, mm or rad.")
      .def_prop_ro(
          "finished_s",
          [](const PlannedMeasurement& p) {
            return numbers_of_each(
                p.readings, [&](const PlannedReading& r) { return p.refused.empty() ? r.finished : std::nan(""); });
          },
          nb::sig("def finished_s(self) -> numpy.ndarray"),
          "[n] time from the start of the program to the end of each reading, s; NaN: refused.")
      .def_prop_ro(
          "time_s",
          [](const PlannedMeasurement& p) { return p.refused.empty() ? std::optional(p.time) : std::nullopt; },
          "Of the program, s, without acceleration and without stops for the operator; None: refused.")
      .def_prop_ro("ways_around", &PlannedMeasurement::ways_around, "Ways that are not straight.");
}

}  // namespace

void bind_planned_measurements(nb::module_& module) {
  bind_planned_readings(module);
  nb::class_<PlannedMeasurement> bound(module, "PlannedMeasurement",
                                       "An NC program that takes readings. Made by plan_measurement().");
  bind_contents(bound);
  add_tables(bound, "measurement_frame", nullptr);
  add_json(bound, &planned_measurement_json);
  bound.def("text", &planned_measurement_text, "What `abbe program` prints.")
      .def(
          "sheet_html",
          [](const PlannedMeasurement& p) {
            program_or_refusal(p.program, p.refused);
            return planned_measurement_sheet(p);
          },
          "The sheet for the operator, HTML, for paper of size A4. Raises InputError if the program is refused.")
      .def(
          "write",
          [](const PlannedMeasurement& p, const std::filesystem::path& path, bool overwrite) {
            write_text(path, program_or_refusal(p.program, p.refused), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes the program, whole or not at all. Raises InputError if it is refused.")
      .def(
          "write_sheet",
          [](const PlannedMeasurement& p, const std::filesystem::path& path, bool overwrite) {
            program_or_refusal(p.program, p.refused);
            write_text(path, planned_measurement_sheet(p), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, "Writes sheet_html() (*.html), whole or not at all.")
      .def("__len__", [](const PlannedMeasurement& p) { return p.readings.size(); })
      .def("__repr__", [](const PlannedMeasurement& p) {
        return fmt::format("<abbe.PlannedMeasurement for {}: {} readings{}>", p.dialect, p.readings.size(),
                           p.refused.empty() ? "" : ", refused");
      });
  module.def(
      "plan_measurement", &planned_of, nb::arg("machine"), nb::arg("readings"), nb::arg("dialect"), nb::kw_only(),
      nb::arg("name") = "MEASURE", nb::arg("words") = std::map<std::string, std::string>{},
      nb::arg("decimals") = nb::none(), nb::arg("machine_coordinates") = false, nb::arg("feed_mm_per_min") = nb::none(),
      nb::arg("dwell_s") = 2.0, nb::arg("reading_s") = 0.0, nb::arg("trigger") = "dwell",
      nb::arg("trigger_number") = nb::none(), nb::arg("pulse_s") = 0.1, nb::arg("stop_at") = "stations",
      nb::arg("shorten") = false, nb::arg("start") = AxisPositions{}, nb::arg("obstacle_boxes_mm") = ObstacleBoxes{},
      nb::arg("obstacle_meshes") = ObstacleMeshes{}, nb::arg("tool_radius_mm") = 0.0, nb::arg("tool_length_mm") = 0.0,
      nb::arg("clearance_mm") = 0.0, nb::arg("clear_at") = AxisPositions{}, nb::arg("linear_speed_mm_per_s") = 100.0,
      nb::arg("rotary_speed_deg_per_s") = 30.0, nb::arg("readings_file") = nb::none(),
      "An NC program that drives a machine to readings and stands still at each: `abbe program`.\n\n"
      "readings: a file (*.csv), a StudyPlan, or positions [n, axes], mm or rad. dialect: 'iso', 'linuxcnc',\n"
      "'heidenhain', 'siemens' or 'fanuc'. name: of the program, for controls that want one. words: {'C1': 'C'}, "
      "words\n"
      "of axes. decimals: of mm and degrees, 1 to 9; else what the control takes. machine_coordinates: moves past all\n"
      "zero offsets. feed_mm_per_min: else rapid traverse. dwell_s, reading_s: standing still before and after the\n"
      "trigger, which is 'dwell' (none), 'm-function' or 'output' with trigger_number; an output is on for pulse_s.\n"
      "stop_at: where the program stops for the operator, 'stations', 'setups' or 'none'. shorten: readings between\n"
      "two stops in an order of short travel. start: {'X_mm': 0, ...}, where all axes stand before the program.\n\n"
      "obstacle_boxes_mm: [('table', (x0, y0, z0, x1, y1, z1))], boxes on 'base' (machine frame), 'table' (workpiece\n"
      "frame) or an axis (machine frame, all axes at zero); obstacle_meshes: [('table', Mesh or file)], mm. The tool "
      "is\n"
      "what is within tool_radius_mm of a line of tool_length_mm from the functional point towards the spindle. Where\n"
      "a straight way touches, it retracts by clearance_mm, or axes go to clear_at, {'Z_mm': 0}.\n"
      "linear_speed_mm_per_s, rotary_speed_deg_per_s: of rapid moves, for the time. readings_file: name of the\n"
      "readings for texts. Raises InputError. What is not clear is in the result: refused. Method:\n"
      "docs/measuring-programs.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> program = abbe.plan_measurement(mill, [[0, 0, 0], [100, 50, -20]], 'linuxcnc', dwell_s=3)\n"
      ">>> program.refused, len(program), program.time_s\n"
      "('', 2, 7.0)\n"
      ">>> print('\\n'.join(program.program.splitlines()[-4:-1]))\n"
      "(reading 2)\n"
      "G0 X100.000000 Y50.000000 Z-20.000000\n"
      "G4 P3\n");
}

}  // namespace abbe::python
