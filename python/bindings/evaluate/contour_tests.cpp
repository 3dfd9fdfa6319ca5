#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "abbe/formats/shapes/curve_pieces.h"
#include "bindings/evaluate/evaluations.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/curves.h"

namespace abbe::python {
namespace {

Evaluation of_sections(const ReadingsArgument& argument, const std::string& feature, const std::string& surface,
                       std::optional<double> beam_tilt_deg, bool free_wall, std::optional<double> surface_radius_mm,
                       double u_across_um, double u_height_um, double u_origin_um, const Tolerances& tolerances,
                       const std::string& file) {
  SectionsTest test;
  SectionOptions& options = test.options;
  options.groove = word_value<bool>("feature", feature, {{"edge", false}, {"groove", true}});
  options.edge.surface =
      word_value<EdgeSide>("surface", surface, {{"left", EdgeSide::left}, {"right", EdgeSide::right}});
  options.edge.free_wall = free_wall;
  if (beam_tilt_deg) test.beam_tilt = quantity("beam_tilt_deg", *beam_tilt_deg, Quantity::angle, "deg", -30, 30);
  if (surface_radius_mm) {
    const double radius = quantity("surface_radius_mm", *surface_radius_mm, Quantity::length, "mm", -1e6, 1e6);
    options.edge.surface_curvature = radius == 0 ? 0 : 1 / radius;
  }
  options.edge.across_noise = quantity("u_across_um", u_across_um, Quantity::length, "um", 0, kMostUm);
  options.edge.height_noise = quantity("u_height_um", u_height_um, Quantity::length, "um", 0, kMostUm);
  options.origin_uncertainty = quantity("u_origin_um", u_origin_um, Quantity::length, "um", 0, kMostUm);
  const GivenReadings given = given_readings(argument);
  test.readings = readings_of(
      given, [](const auto& path) { return read_sections(path); },
      [](const NamedColumns& columns) { return parse_sections(columns); });
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

/// A file of a curve, or one in memory.
using CurveArgument = std::variant<NamedCurve, std::filesystem::path>;

std::vector<CommandPiece> pieces_of(const CurveArgument& curve, const std::optional<Machine>& machine, bool closed) {
  if (const auto* const path = std::get_if<std::filesystem::path>(&curve)) {
    return machine ? read_commanded_pieces(path->string(), *machine, closed)
                   : read_commanded_pieces(path->string(), "", closed);
  }
  const auto& named = std::get<NamedCurve>(curve);
  if (!machine && !named.indexed.empty()) {
    throw InputError({.field = "curve"}, "the curve sets axes, but no machine is given", "machine=... with these axes");
  }
  return commanded_pieces(machine ? curve_on(named, *machine) : named.curve, named.file, closed ? "--closed" : "");
}

Evaluation of_contour_points(const PointsArgument& points, const CurveArgument& curve,
                             const std::optional<Machine>& machine, bool closed, double u_origin_um,
                             const Tolerances& tolerances, const std::string& file) {
  ContourPointsTest test;
  test.origin_uncertainty = quantity("u_origin_um", u_origin_um, Quantity::length, "um", 0, kMostUm);
  NamedPoints given = points_of(points, "points_mm", std::nullopt, file);
  if (given.file.cloud.size() == 0)
    throw InputError({.field = "points_mm"}, "there are no points", "at least one point");
  test.readings = std::move(given.file);
  test.pieces = naming_arguments([&] { return pieces_of(curve, machine, closed); });
  return evaluate_test(std::move(test), given.name, tolerances);
}

void enter_accuracy(const std::map<std::string, double>& given, LinkageAccuracy& accuracy) {
  for (const auto& [key, value] : given) {
    const LinkageAccuracyName& name = entry_named("accuracy", key, linkage_accuracy_names());
    accuracy.*name.value = quantity(key.c_str(), value, name.quantity, name.unit, 0, kMostUm);
  }
}

Evaluation of_linkage(const ReadingsArgument& argument, double exit_to_axis_mm, double board_mm,
                      const std::optional<Machine>& machine, const std::optional<std::string>& convention,
                      const std::map<std::string, double>& accuracy, const Tolerances& tolerances,
                      const std::string& file) {
  LinkageTest test;
  const double exit_to_axis = quantity("exit_to_axis_mm", exit_to_axis_mm, Quantity::length, "mm", 0, 1e5);
  const double board = quantity("board_mm", board_mm, Quantity::length, "mm", 0, 1e5);
  enter_accuracy(accuracy, test.accuracy);
  if (convention) {
    test.convention = word_value<LinkageConvention>(
        "convention", *convention,
        {{"table-moves", LinkageConvention::table_moves}, {"head-moves", LinkageConvention::head_moves}});
  }
  test.machine = machine;
  test.machine_file = "machine";
  const GivenReadings given = given_readings(argument);
  test.readings = readings_of(
      given, [](const auto& path) { return read_linkage(path); },
      [](const NamedColumns& columns) { return parse_linkage(columns); });
  test.readings.exit_to_axis = exit_to_axis;
  test.readings.board_thickness = board;
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

}  // namespace

void bind_contour_tests(nb::module_& module) {
  module.def(
      "evaluate_sections", &of_sections, nb::arg("readings"), nb::kw_only(), nb::arg("feature") = "edge",
      nb::arg("surface") = "left", nb::arg("beam_tilt_deg") = nb::none(), nb::arg("free_wall") = false,
      nb::arg("surface_radius_mm") = nb::none(), nb::arg("u_across_um") = 0.0, nb::arg("u_height_um") = 0.0,
      nb::arg("u_origin_um") = 0.0, nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Contour error of an engraved curve from cross-sections of a line scanner: `abbe evaluate contour`.\n\n"
      "readings: a file, or columns [n]: section (a name), across_mm, height_mm with the origin on the commanded "
      "curve;\n"
      "along_mm and beam_tilt_deg are optional. feature: 'edge', or 'groove': the middle between its two edges.\n"
      "surface: side of an edge on which the surface remains. beam_tilt_deg: for sections that do not state theirs.\n"
      "free_wall: the wall need not be parallel to the laser. surface_radius_mm: of the part, positive if convex. "
      "u_...:\n"
      "standard uncertainties. numbers is a SectionNumbers. Raises InputError. Method: docs/contour-error.md.");
  module.def(
      "evaluate_contour", &of_contour_points, nb::arg("points_mm"), nb::arg("curve"), nb::kw_only(),
      nb::arg("machine") = nb::none(), nb::arg("closed") = false, nb::arg("u_origin_um") = 0.0,
      nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Contour error of measured points [n, 3] against a commanded curve: `abbe evaluate contour --curve`.\n\n"
      "points_mm: an array, a PointCloud or a file of points, in the frame of the curve. curve: a Curve, or a file as\n"
      "for plan_path(). machine: the one whose axes the curve sets. closed: the last point is followed by the first.\n"
      "u_origin_um: standard uncertainty of where the points are relative to the curve. numbers is a ContourNumbers.\n"
      "Raises InputError. Method: docs/contour-error.md.");
  module.def(
      "evaluate_linkage", &of_linkage, nb::arg("readings"), nb::arg("exit_to_axis_mm"), nb::arg("board_mm"),
      nb::kw_only(), nb::arg("machine") = nb::none(), nb::arg("convention") = nb::none(),
      nb::arg("accuracy") = std::map<std::string, double>{}, nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Linkage parameters of a laser engraver with a swing head C1, A, from the five steps.\n\n"
      "readings: a file, or columns [n] as in one (mark, X_mm, Z_mm, width_um, ...; NaN where a field is empty).\n"
      "exit_to_axis_mm: from the exit of the beam to the axis of A. board_mm: thickness of the board. machine: its "
      "errors\n"
      "are found too, see files(). convention: without a machine, 'table-moves' (default) or 'head-moves'. accuracy:\n"
      "standard uncertainties, named like the options of the command, {'u_x_um': 2.77}. numbers is a LinkageNumbers.\n"
      "Raises InputError. Method: docs/linkage-steps.md.");
}

}  // namespace abbe::python
