#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "abbe/study/compensation/planned_path.h"
#include "bindings/arrays_of_each.h"
#include "bindings/files.h"
#include "bindings/use/curves.h"
#include "bindings/use/path_parts.h"

namespace abbe::python {
namespace {

double not_below_zero(double value, const char* name) {
  if (value >= 0 && std::isfinite(value)) return value;
  throw InputError({.field = name}, fmt::format("is {}", value), "zero or more");
}

PlannedPath plan_path_of(const Machine& machine, const NamedCurve& curve, const MachineErrors* errors,
                         const PlacementFile* placement, std::optional<double> feed_mm_per_min,
                         const AxisPositions& hold, const AxisPositions& start, double retract_mm, double tolerance_um,
                         bool accept_misfit, const std::string& errors_file, const std::string& placement_file) {
  PathRequest request;
  request.machine = machine;
  if (errors != nullptr) {
    require_same_machine(machine, errors->machine, "errors");
    require_trusted(*errors, accept_misfit, errors_file);
    request.errors = errors->file;
    request.errors_file = errors_file;
  }
  if (placement != nullptr) {
    request.placement = *placement;
    request.placement_file = placement_file;
  }
  request.curve = curve_on(curve, machine);
  if (request.curve.points.empty()) throw InputError({.field = "curve"}, "has no points", "a curve");
  request.curve_file = curve.file;
  request.feed = feed_of(feed_mm_per_min);
  request.retract = not_below_zero(retract_mm, "retract_mm");
  request.tolerance = 1e-3 * not_below_zero(tolerance_um, "tolerance_um");
  request.held = axis_positions(machine, "hold", hold);
  request.start = axis_positions(machine, "start", start);
  return computed([&] { return plan_path(request); });
}

void require_path(const PlannedPath& planned) {
  if (!planned.has_path()) throw InputError({.field = "refused"}, argument_words(planned.refused));
}

std::string program_of_path(const PlannedPath& planned, const std::string& name,
                            const std::map<std::string, std::string>& words, int decimals, bool feed_per_minute,
                            const std::vector<std::string>& comments) {
  require_path(planned);
  if (decimals < 1 || decimals > 12) {
    throw InputError({.field = "decimals"}, fmt::format("is {}", decimals), "1 to 12");
  }
  PathProgramOptions options;
  options.decimals = decimals;
  options.inverse_time = !feed_per_minute;
  options.words = program_words(planned.machine, words);
  options.comments = comments;
  return planned_path_file(planned, name, options);
}

std::string page_of_path(const PlannedPath& planned, const std::optional<std::filesystem::path>& part) {
  require_path(planned);
  return computed([&] {
    if (!part) return planned_path_page(planned);
    const MeshFile mesh = read_mesh(*part);
    return planned_path_page(planned, &mesh, part->string());
  });
}

nb::object path_commands(const PlannedPath& planned) {
  const std::size_t axes = planned.machine.axes.size(), count = planned.commands.size();
  std::vector<double> values;
  for (const std::vector<double>& row : planned.commands) values.insert(values.end(), row.begin(), row.end());
  return array_of(std::move(values), {count, axes});
}

void bind_steps(nb::class_<PlannedPath>& bound) {
  bound
      .def_prop_ro("positions_mm_rad", &path_commands, nb::sig("def positions_mm_rad(self) -> numpy.ndarray"),
                   "[steps, axes] commands as the control is to have them, mm or rad.")
      .def_prop_ro(
          "working", [](const PlannedPath& p) { return flags_of_each(p.path.steps, &ToolPathStep::working); },
          nb::sig("def working(self) -> numpy.ndarray"),
          "[steps] whether the tool works on the way there; else a rapid move.")
      .def_prop_ro(
          "length_mm", [](const PlannedPath& p) { return numbers_of_each(p.path.steps, &ToolPathStep::length); },
          nb::sig("def length_mm(self) -> numpy.ndarray"), "[steps] along the curve, of moves at work.")
      .def_prop_ro(
          "feed_mm_per_min",
          [](const PlannedPath& p) {
            return numbers_of_each(p.path.steps, [](const ToolPathStep& s) { return 60 * s.feed; });
          },
          nb::sig("def feed_mm_per_min(self) -> numpy.ndarray"), "[steps]")
      .def_prop_ro(
          "dwell_s", [](const PlannedPath& p) { return numbers_of_each(p.path.steps, &ToolPathStep::dwell); },
          nb::sig("def dwell_s(self) -> numpy.ndarray"), "[steps]")
      .def_prop_ro(
          "point",
          [](const PlannedPath& p) {
            return ints_of_each(p.path.steps, [](const ToolPathStep& s) {
              return s.point == ToolPathStep::kNoPoint ? -1 : static_cast<int>(s.point);
            });
          },
          nb::sig("def point(self) -> numpy.ndarray"), "[steps] index into the curve; -1: inserted, or retracted.")
      .def_prop_ro(
          "region",
          [](const PlannedPath& p) {
            return ints_of_each(p.path.steps, [](const ToolPathStep& s) { return static_cast<int>(s.region); });
          },
          nb::sig("def region(self) -> numpy.ndarray"), "[steps]")
      .def_prop_ro(
          "branch", [](const PlannedPath& p) { return ints_of_each(p.path.steps, &ToolPathStep::branch); },
          nb::sig("def branch(self) -> numpy.ndarray"), "[steps] of the inverse kinematics.");
}

void bind_figures(nb::class_<PlannedPath>& bound) {
  bound
      .def_prop_ro(
          "status", [](const PlannedPath& p) { return tool_path_status_words(p.path.status); },
          "'followed', 'jumps-while-working', 'outside-travel', 'not-reached' or 'too-many-poses'.")
      .def_prop_ro(
          "message", [](const PlannedPath& p) { return argument_words(p.path.message); },
          "In words, where the status is not 'followed'.")
      .def_prop_ro(
          "jumps", [](const PlannedPath& p) { return named_jumps(p.machine, p.path.jumps); },
          "Steps in which the axes move far although the tool hardly does.")
      .def_prop_ro(
          "working_jumps", [](const PlannedPath& p) { return p.path.working_jumps; }, "Steps at work that jump.")
      .def_prop_ro("regions", [](const PlannedPath& p) { return p.path.regions; })
      .def_prop_ro(
          "inserted", [](const PlannedPath& p) { return p.path.inserted; }, "Poses that were put in.")
      .def_prop_ro(
          "largest_deviation_mm", [](const PlannedPath& p) { return p.path.largest_deviation; },
          "Of the tool from the straight lines while it works, the axes interpolated linearly, mm.")
      .def_prop_ro("working_length_mm", [](const PlannedPath& p) { return p.path.working_length; })
      .def_prop_ro(
          "working_time_s", [](const PlannedPath& p) { return p.path.working_time; },
          "At the feeds, with the dwells, without acceleration.")
      .def_prop_ro(
          "failed_point",
          [](const PlannedPath& p) { return p.has_path() ? std::nullopt : std::optional(p.path.failed_point); },
          "Index of the point of the curve that failed; None: there is a path.")
      .def_prop_ro(
          "miss_mm", [](const PlannedPath& p) { return p.miss.distance; },
          "Largest distance of the tool from the points of the curve, by the forward kinematics.")
      .def_prop_ro("miss_rad", [](const PlannedPath& p) { return p.miss.angle; });
}

}  // namespace

void bind_planned_paths(nb::module_& module) {
  bind_path_parts(module);
  nb::class_<PlannedPath> bound(module, "PlannedPath", "Commands that follow a curve. Made by plan_path().");
  bound.def_ro("machine", &PlannedPath::machine, "Calibrated, with the workpiece in place.")
      .def_prop_ro(
          "refused", [](const PlannedPath& p) { return argument_words(p.refused); },
          "Why there is no path, or why it must not be used; empty: it may be.")
      .def_prop_ro("has_path", &PlannedPath::has_path,
                   "Whether there is a path, be it one on which axes jump while the tool works.")
      .def_ro("warnings", &PlannedPath::warnings, "Of the placement.")
      .def("program", &program_of_path, nb::kw_only(), nb::arg("name") = "program.ngc",
           nb::arg("words") = std::map<std::string, std::string>{}, nb::arg("decimals") = 6,
           nb::arg("feed_per_minute") = false, nb::arg("comments") = std::vector<std::string>{},
           "NC program of the path. words: {'C1': 'C'}, words of axes. feed_per_minute: F in mm/min (G94) instead of\n"
           "inverse time (G93). comments: at the top.")
      .def(
          "csv",
          [](const PlannedPath& p) {
            require_path(p);
            return planned_path_file(p, "path.csv");
          },
          "CSV of the commands: a row for each step.")
      .def(
          "text",
          [](const PlannedPath& p) {
            require_path(p);
            return planned_path_text(p);
          },
          "What `abbe path` prints.")
      .def(
          "to_dict",
          [](const PlannedPath& p) {
            require_path(p);
            return python_value(planned_path_json(p));
          },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"), "The same as `abbe path --json`.")
      .def("page_html", &page_of_path, nb::arg("part") = nb::none(),
           "The page that plays the path, HTML. part: file of the workpiece (.stl, .ply, .obj, .step).")
      .def(
          "write",
          [](const PlannedPath& p, const std::filesystem::path& path, bool overwrite,
             const std::map<std::string, std::string>& words, int decimals, bool feed_per_minute,
             const std::vector<std::string>& comments) {
            write_text(path, program_of_path(p, path.string(), words, decimals, feed_per_minute, comments), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, nb::kw_only(),
          nb::arg("words") = std::map<std::string, std::string>{}, nb::arg("decimals") = 6,
          nb::arg("feed_per_minute") = false, nb::arg("comments") = std::vector<std::string>{},
          "Writes a program (.ngc, .nc, .tap, .mpf) or a .csv, whole or not at all; see refused before it is used.")
      .def("__len__", [](const PlannedPath& p) { return p.commands.size(); })
      .def("__repr__", [](const PlannedPath& p) {
        return fmt::format("<abbe.PlannedPath: {} moves, {:.3f} mm at work{}>", p.commands.size(),
                           p.path.working_length, p.refused.empty() ? "" : ", refused");
      });
  bind_steps(bound);
  bind_figures(bound);
  module.def(
      "plan_path", &plan_path_of, nb::arg("machine"), nb::arg("curve"), nb::kw_only(),
      nb::arg("errors").none() = nb::none(), nb::arg("placement").none() = nb::none(),
      nb::arg("feed_mm_per_min") = nb::none(), nb::arg("hold") = AxisPositions{}, nb::arg("start") = AxisPositions{},
      nb::arg("retract_mm") = 0.0, nb::arg("tolerance_um") = 0.0, nb::arg("accept_misfit") = false,
      nb::arg("errors_file") = "errors.toml", nb::arg("placement_file") = "placement.toml",
      "Axis commands that bring the tool of a calibrated machine along a curve on the workpiece.\n\n"
      "errors: those that change along the path are corrected at every pose. placement: where the workpiece is "
      "clamped.\n"
      "feed_mm_per_min: where the curve has none. hold: {'C2_deg': 30}, axes kept at a command. start: positions of "
      "axes\n"
      "before the path; other axes may be anywhere. retract_mm: before and after each region. tolerance_um: poses are\n"
      "inserted until the tool stays so near to the lines between the points; 0: none. Raises InputError. Formats and\n"
      "method: docs/tool-path.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> path = abbe.plan_path(mill, abbe.Curve([[0, 0, 0], [10, 0, 0]], feed_mm_per_min=600))\n"
      ">>> path.refused, path.positions_mm_rad.tolist()\n"
      "('', [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])\n");
}

}  // namespace abbe::python
