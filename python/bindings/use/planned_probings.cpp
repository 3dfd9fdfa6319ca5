#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "abbe/study/planning/planned_probing.h"
#include "bindings/arrays_of_each.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/use/measurement_request.h"

namespace abbe::python {
namespace {

/// A program of touches, and the words of its axes, by which its log is read.
struct ProbingResult {
  PlannedProbing planned;
  std::map<std::string, std::string> words;
};

/// Lengths of a touch and feeds towards the ball.
double touch_number(const char* name, double value) { return number_within(name, value, 1e-3, 1e4); }

ProbingResult probing_of(const Machine& machine, const ReadingsToTake& readings,
                         const std::array<double, 4>& probe_ball_mm, double tip_radius_mm, int touches_per_ball,
                         double pre_touch_mm, double over_travel_mm, double probing_feed_mm_per_min,
                         const std::string& probe_log, std::map<std::string, std::string> words,
                         std::optional<int> decimals, std::optional<double> feed_mm_per_min, double dwell_s,
                         ObstacleBoxes obstacle_boxes_mm, ObstacleMeshes obstacle_meshes, double tool_radius_mm,
                         double tool_length_mm, double clearance_mm, AxisPositions clear_at,
                         const std::optional<std::string>& readings_file) {
  MeasurementRequest measurement =
      measurement_request(machine, readings, readings_file,
                          {std::move(obstacle_boxes_mm), std::move(obstacle_meshes), tool_radius_mm, tool_length_mm,
                           clearance_mm, std::move(clear_at)},
                          {std::move(words), decimals, feed_mm_per_min, dwell_s});
  measurement.program.dialect = NcDialect::linuxcnc;
  ProbingRequest request = probing_request(measurement);
  request.ball_centre = {probe_ball_mm[0], probe_ball_mm[1], probe_ball_mm[2]};
  request.ball_radius = probe_ball_mm[3];
  request.tip_radius = touch_number("tip_radius_mm", tip_radius_mm);
  request.touches = static_cast<std::size_t>(number_within("touches_per_ball", touches_per_ball, 4, 99));
  request.before = touch_number("pre_touch_mm", pre_touch_mm);
  request.beyond = touch_number("over_travel_mm", over_travel_mm);
  request.program.probing_feed = touch_number("probing_feed_mm_per_min", probing_feed_mm_per_min) / 60;
  request.program.log = probe_log;
  return {computed([&] { return plan_probing(request); }), request.program.words};
}

std::string touches_of(const ProbingResult& result) {
  program_or_refusal(result.planned.program, result.planned.refused);
  return planned_touches_csv(result.planned.machine, result.planned.touches);
}

std::string readings_of_log(const ProbingResult& result, const nb::object& log, const std::string& log_file) {
  program_or_refusal(result.planned.program, result.planned.refused);
  return probed_touches_csv(result.planned.machine, result.planned.touches, "touches_csv()", bytes_of_text(log, "log"),
                            log_file, result.words);
}

void bind_touches(nb::class_<ProbingResult>& bound) {
  bound
      .def_prop_ro(
          "positions_mm_rad",
          [](const ProbingResult& r) {
            std::vector<double> values;
            for (const PlannedTouch& touch : r.planned.touches) {
              values.insert(values.end(), touch.pose.begin(), touch.pose.end());
            }
            return array_of(std::move(values), {r.planned.touches.size(), r.planned.machine.axes.size()});
          },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"),
          "[n, axes] commands at which the probe should touch, in the order of the program, mm or rad.")
      .def_prop_ro(
          "approaches",
          [](const ProbingResult& r) { return vectors_of_each(r.planned.touches, &PlannedTouch::approach); },
          nb::sig("def approaches(self) -> numpy.ndarray"),
          "[n, 3] unit vectors from the probe towards the ball, frame of the tool.")
      .def_prop_ro(
          "names",
          [](const ProbingResult& r) {
            std::vector<std::string> names;
            for (const PlannedTouch& touch : r.planned.touches) names.push_back(touch.point);
            return names;
          },
          "[n] 'reading 1, touch 2'.")
      .def_prop_ro(
          "ball_positions", [](const ProbingResult& r) { return r.planned.positions; },
          "Number of positions of the ball.")
      .def_prop_ro(
          "ways_around", [](const ProbingResult& r) { return r.planned.ways_around; },
          "Ways between them that are not straight.")
      .def("__len__", [](const ProbingResult& r) { return r.planned.touches.size(); });
}

}  // namespace

void bind_planned_probings(nb::module_& module) {
  nb::class_<ProbingResult> bound(module, "PlannedProbing",
                                  "A program for LinuxCNC that touches a ball. Made by plan_probing().");
  bind_touches(bound);
  add_json(bound, [](const ProbingResult& r) { return planned_probing_json(r.planned); });
  bound.def_prop_ro("machine", [](const ProbingResult& r) { return r.planned.machine; })
      .def_prop_ro(
          "program",
          [](const ProbingResult& r) {
            return r.planned.refused.empty() ? std::optional(r.planned.program) : std::nullopt;
          },
          "Text of the program; None: refused.")
      .def_prop_ro(
          "refused", [](const ProbingResult& r) { return argument_words(r.planned.refused); },
          "Why there is no program: the reading and what is not clear or out of reach; empty: there is one.")
      .def(
          "text", [](const ProbingResult& r) { return planned_probing_text(r.planned); },
          "What `abbe program --probe-ball-mm` prints; empty if it is refused.")
      .def("touches_csv", &touches_of, "The touches as CSV, with which `abbe import --touches` reads the log.")
      .def("readings_csv", &readings_of_log, nb::arg("log"), nb::kw_only(), nb::arg("log_file") = "log",
           "Readings of a touch probe as CSV, from the log that LinuxCNC wrote (PROBEOPEN), text or bytes.\n\n"
           "log_file: its name for messages. Raises InputError with the line that does not belong to its touch.")
      .def(
          "write",
          [](const ProbingResult& r, const std::filesystem::path& path, bool overwrite) {
            write_text(path, program_or_refusal(r.planned.program, r.planned.refused), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes the program (*.ngc), whole or not at all. Raises InputError if it is refused.")
      .def(
          "write_touches",
          [](const ProbingResult& r, const std::filesystem::path& path, bool overwrite) {
            write_text(path, touches_of(r), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, "Writes touches_csv() (*.csv), whole or not at all.")
      .def("__repr__", [](const ProbingResult& r) {
        return fmt::format("<abbe.PlannedProbing: {} touches at {} positions{}>", r.planned.touches.size(),
                           r.planned.positions, r.planned.refused.empty() ? "" : ", refused");
      });
  module.def(
      "plan_probing", &probing_of, nb::arg("machine"), nb::arg("readings"), nb::arg("probe_ball_mm"), nb::kw_only(),
      nb::arg("tip_radius_mm") = 3.0, nb::arg("touches_per_ball") = 5, nb::arg("pre_touch_mm") = 3.0,
      nb::arg("over_travel_mm") = 2.0, nb::arg("probing_feed_mm_per_min") = 60.0, nb::arg("probe_log") = "touches.txt",
      nb::arg("words") = std::map<std::string, std::string>{}, nb::arg("decimals") = nb::none(),
      nb::arg("feed_mm_per_min") = nb::none(), nb::arg("dwell_s") = 2.0, nb::arg("obstacle_boxes_mm") = ObstacleBoxes{},
      nb::arg("obstacle_meshes") = ObstacleMeshes{}, nb::arg("tool_radius_mm") = 0.0, nb::arg("tool_length_mm") = 0.0,
      nb::arg("clearance_mm") = 0.0, nb::arg("clear_at") = AxisPositions{}, nb::arg("readings_file") = nb::none(),
      "A program for LinuxCNC that touches a ball on the table: `abbe program --probe-ball-mm`.\n\n"
      "readings: as for plan_measurement(); the ball is touched at their positions of the rotary axes, and linear "
      "axes\n"
      "follow it. probe_ball_mm: (x, y, z, radius), centre in the workpiece frame. tip_radius_mm: of the stylus tip,\n"
      "whose centre is the functional point. touches_per_ball: one along the tool, the others around it. "
      "pre_touch_mm:\n"
      "between tip and ball where a touch begins. over_travel_mm: distance behind the surface where the control gives "
      "up.\n"
      "probing_feed_mm_per_min: of a touch. probe_log: file that the control writes. dwell_s: standing still before a\n"
      "touch. The other arguments are those of plan_measurement(). Raises InputError. What is not clear or out of "
      "reach\n"
      "is in the result: refused. Method: docs/measuring-programs.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w C' X' Y' b Z t\")\n"
      ">>> turns = abbe.positions(mill, C_deg=[0, 90, 180])\n"
      ">>> program = abbe.plan_probing(mill, turns, (50, 0, 60, 12.5), clearance_mm=50)\n"
      ">>> program.refused, len(program), program.ball_positions\n"
      "('', 15, 3)\n");
}

}  // namespace abbe::python
