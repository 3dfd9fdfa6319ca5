#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "abbe/instruments/point_scan.h"
#include "abbe/study/scans/scanned_points.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/job.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

/// Errors with their machine, or a machine without errors.
using ErrorsOrMachine = std::variant<MachineErrors, Machine>;

const Machine& machine_of(const ErrorsOrMachine& errors) {
  if (const auto* const machine = std::get_if<Machine>(&errors)) return *machine;
  return std::get<MachineErrors>(errors).machine;
}

ErrorSet error_set_of(const ErrorsOrMachine& errors, bool accept_misfit, const std::string& file) {
  const auto* const known = std::get_if<MachineErrors>(&errors);
  if (!known) return ErrorSet{};
  require_trusted(*known, accept_misfit, file);
  return known->set();
}

/// Points computed from arrays.
struct PointsOfReadings {
  nb::object points_mm, covered;
};

PointsOfReadings of_arrays(const ErrorsOrMachine& errors, const ArrayLike& positions, const ArrayLike& indication_mm,
                           const std::optional<ArrayLike>& beam_zero_mm, const std::optional<ArrayLike>& beam,
                           bool accept_misfit) {
  const Machine& machine = machine_of(errors);
  const ErrorSet set = error_set_of(errors, accept_misfit, "errors");
  const Positions commands(positions, machine);
  if (commands.single()) {
    throw InputError({.field = "positions_mm_rad"}, "is a single pose",
                     fmt::format("shape (n, {})", machine.axes.size()));
  }
  const std::vector<double> indication = number_list(indication_mm, "indication_mm", "one per position, mm");
  if (indication.size() != commands.count()) {
    throw InputError({.field = "indication_mm"}, fmt::format("has {} numbers", indication.size()),
                     fmt::format("{}, one per position", commands.count()));
  }
  const Eigen::Vector3d zero =
      beam_zero_mm ? vector_of(*beam_zero_mm, "beam_zero_mm", "a point, mm") : Eigen::Vector3d::Zero();
  const std::optional<Eigen::Vector3d> direction = direction_of(beam, "beam");
  const PointScan scan =
      naming_arguments([&] { return PointScan(machine, set, probe_beam(machine, zero, direction)); });
  Columns<double> points(3, commands.count());
  Columns<std::uint8_t> covered(1, commands.count());
  {
    const nb::gil_scoped_release release;
    for_each_block_of(commands.count(), [&](std::size_t first, std::size_t count) {
      thread_local Positions::Block memory;
      scan.points(commands.block(first, count, memory), indication.data() + first,
                  {points[0] + first, points[1] + first, points[2] + first}, covered[0] + first);
    });
  }
  return {points.release({3}, false), covered.release_bools()};
}

ScannedPoints points_of_file(const std::filesystem::path& readings, const ErrorsOrMachine& errors,
                             const std::filesystem::path& output, const std::optional<ArrayLike>& beam_zero_mm,
                             const std::optional<ArrayLike>& beam,
                             const std::optional<std::pair<double, double>>& indication_range_mm,
                             std::map<std::string, std::string> columns, std::vector<std::string> ignore, int decimals,
                             bool any_travel, bool accept_misfit, const std::string& errors_file, bool overwrite,
                             const nb::object& progress) {
  ScannedPointsRequest request;
  request.machine = machine_of(errors);
  request.errors = error_set_of(errors, accept_misfit, errors_file);
  if (std::holds_alternative<MachineErrors>(errors)) request.errors_file = errors_file;
  request.readings = readings.string();
  request.output = output.string();
  if (beam_zero_mm) request.beam_zero = vector_of(*beam_zero_mm, "beam_zero_mm", "a point, mm");
  request.beam = direction_of(beam, "beam");
  if (indication_range_mm) request.indication_range = {indication_range_mm->first, indication_range_mm->second};
  request.scan.mapping.columns = std::move(columns);
  request.scan.mapping.ignore = std::move(ignore);
  request.scan.mapping.ignored_by = "ignore";
  if (decimals < 0 || decimals > 12) {
    throw InputError({.field = "decimals"}, fmt::format("is {}", decimals), "0 to 12");
  }
  request.scan.decimals = decimals;
  request.scan.check_travel = !any_travel;
  refuse_existing(output, overwrite);
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] { return write_scanned_points(request, control.options("computing points")); });
  });
}

void bind_scan_results(nb::module_& module) {
  nb::class_<PointsOfReadings>(module, "ScanPoints", "Points computed from readings. Made by scan_points().")
      .def_ro("points_mm", &PointsOfReadings::points_mm, nb::sig("def points_mm(self) -> numpy.ndarray"),
              "[n, 3] workpiece frame.")
      .def_ro("covered", &PointsOfReadings::covered, nb::sig("def covered(self) -> numpy.ndarray"),
              "[n] False where the position is outside the range of an error motion.")
      .def("__len__", [](const PointsOfReadings& p) { return nb::len(p.points_mm); })
      .def("__repr__",
           [](const PointsOfReadings& p) { return fmt::format("<abbe.ScanPoints: {}>", nb::len(p.points_mm)); });
  nb::class_<ScannedPoints> bound(module, "ScannedFile",
                                  "Summary of a file of points computed from readings. Made by scan_points_file().");
  bound
      .def_prop_ro(
          "readings", [](const ScannedPoints& p) { return p.summary.readings; }, "Number of readings in the file.")
      .def_prop_ro(
          "points", [](const ScannedPoints& p) { return p.summary.points; }, "Number of points written.")
      .def_prop_ro(
          "out_of_range", [](const ScannedPoints& p) { return p.summary.out_of_range; },
          "Number left out because the indication is out of range.")
      .def_prop_ro(
          "not_covered", [](const ScannedPoints& p) { return p.summary.not_covered; },
          "Number left out because an error motion is not known at the position.")
      .def_prop_ro(
          "lowest_mm",
          [](const ScannedPoints& p) {
            return Triple{p.summary.lowest[0], p.summary.lowest[1], p.summary.lowest[2]};
          },
          "Lowest corner of the box around the points; meaningless without points.")
      .def_prop_ro(
          "highest_mm",
          [](const ScannedPoints& p) {
            return Triple{p.summary.highest[0], p.summary.highest[1], p.summary.highest[2]};
          },
          "The opposite corner.")
      .def_ro("refused", &ScannedPoints::refused, "Why there are no points; empty if there are some.")
      .def("text", &scanned_points_text, "What `abbe scan points` prints.")
      .def("__repr__", [](const ScannedPoints& p) {
        return fmt::format("<abbe.ScannedFile: {} of {} readings>", p.summary.points, p.summary.readings);
      });
  add_json(bound, &scanned_points_json);
}

}  // namespace

void bind_scan_points(nb::module_& module) {
  bind_scan_results(module);
  module.def(
      "scan_points", &of_arrays, nb::arg("errors"), nb::arg("positions_mm_rad"), nb::arg("indication_mm"),
      nb::kw_only(), nb::arg("beam_zero_mm") = nb::none(), nb::arg("beam") = nb::none(),
      nb::arg("accept_misfit") = false,
      "Points of the workpiece from axis positions and indications of a displacement probe.\n\n"
      "errors: Errors of the machine, or a Machine without errors. positions_mm_rad [n, axes]. indication_mm [n],\n"
      "positive away from the probe. beam_zero_mm [3]: where the indication is zero, from the gauge point, tool's "
      "frame.\n"
      "beam [3]: from the probe to the part, tool's frame, of any length; else against the tool's direction. Raises\n"
      "InputError. Method: docs/scan.md.\n\n"
      ">>> import abbe\n"
      ">>> scanner = abbe.Machine.from_chain(\"w C' A' b X Y Z t\")\n"
      ">>> abbe.scan_points(scanner, [[0, 0, 10, 20, 30]], [0.5]).points_mm.tolist()\n"
      "[[10.0, 20.0, 29.5]]\n");
  module.def(
      "scan_points_file", &points_of_file, nb::arg("readings"), nb::arg("errors"), nb::arg("output"), nb::kw_only(),
      nb::arg("beam_zero_mm") = nb::none(), nb::arg("beam") = nb::none(), nb::arg("indication_range_mm") = nb::none(),
      nb::arg("columns") = std::map<std::string, std::string>{}, nb::arg("ignore") = std::vector<std::string>{},
      nb::arg("decimals") = 9, nb::arg("any_travel") = false, nb::arg("accept_misfit") = false,
      nb::arg("errors_file") = "errors.toml", nb::arg("overwrite") = false, nb::arg("progress") = nb::none(),
      "As scan_points(), from a file of readings of any length to a file of points: `abbe scan points`.\n\n"
      "readings: CSV with X_mm, C_deg, ... and indication_mm (or _um). output: .csv or .ply. indication_range_mm:\n"
      "readings outside it are left out. columns: {'indication_um': 'h'}, for other names; ignore: columns that\n"
      "are not read. decimals: of a coordinate in CSV. any_travel: accept positions outside of the travel.\n"
      "errors_file: name for the text. progress: a function of the step, what is done and its total. Raises\n"
      "InputError, FileExistsError, Stopped.");
}

}  // namespace abbe::python
