#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "abbe/formats/shapes/ending.h"
#include "abbe/study/scans/fitted_points.h"
#include "bindings/evaluate/report.h"
#include "bindings/shapes/ideal_shapes.h"
#include "bindings/shapes/shapes.h"

namespace abbe::python {
namespace {

/// As read_points_to_fit() of a file, and points of arrays and clouds.
PointsToFit points_to_fit(const PointsArgument& argument, const std::optional<std::string>& unit,
                          const std::string& called, bool in_plane) {
  const std::optional<std::filesystem::path> path =
      nb::isinstance<NamedPoints>(argument.source) ? std::nullopt : path_of(argument.source);
  if (path) {
    PointCloudOptions options;
    options.unit = file_unit("unit", unit);
    options.in_plane = in_plane;
    PointsToFit points = computed([&] { return read_points_to_fit(path->string(), options); });
    if (!called.empty()) points.file = called;
    return points;
  }
  NamedPoints points = points_of(argument, "points_mm", unit, called, in_plane);
  std::string fact = cloud_words(points.file);
  return {points.name, std::move(points.file.cloud), std::move(fact)};
}

std::optional<double> half_angle(const std::optional<double>& degrees) {
  if (!degrees) return std::nullopt;
  return quantity("fixed_half_angle_deg", *degrees, Quantity::angle, "deg", 0.001, 89.9);
}

FittedShape fit(const PointsArgument& points, const std::string& shape, const std::string& method,
                const std::string& loss, std::optional<double> fixed_radius_mm,
                const std::optional<ArrayLike>& fixed_direction, std::optional<double> fixed_half_angle_deg,
                double u_point_um, const std::optional<std::string>& unit, const Tolerances& tolerances, bool page,
                const std::string& file) {
  ShapeFitRequest request;
  FitChoice& choice = request.choice;
  choice.kind = shape_kind(shape);
  choice.method = word_value("method", method, fit_methods_by_name());
  choice.robust.kind = word_value<RobustKind>(
      "loss", loss, {{"tukey", RobustKind::tukey}, {"huber", RobustKind::huber}, {"welsch", RobustKind::welsch}});
  choice.options.sigma = quantity("u_point_um", u_point_um, Quantity::length, "um", 0, kMostUm);
  choice.options.constraints.direction = direction_of(fixed_direction, "fixed_direction");
  choice.options.constraints.radius = fixed_radius_mm;
  choice.options.constraints.half_angle = half_angle(fixed_half_angle_deg);
  request.tolerances = tolerance_texts(tolerances);
  request.page = page;
  request.points = points_to_fit(points, unit, file, is_plane_shape(choice.kind));
  return computed([&] { return fit_points(std::move(request)); });
}

FittedCircles fit_coaxial(const std::vector<nb::object>& circles, const std::optional<std::vector<double>>& radii,
                          const std::optional<ArrayLike>& direction, double u_point_um,
                          const std::optional<std::string>& unit, const Tolerances& tolerances) {
  if (circles.empty()) throw InputError({.field = "circles"}, "is empty", "at least one circle");
  CirclesFitRequest request;
  request.options.direction = direction_of(direction, "fixed_direction");
  if (radii) {
    request.options.radii = *radii;
    if (radii->size() != circles.size()) {
      throw InputError({.field = "fixed_radius_mm"}, fmt::format("has {} numbers", radii->size()),
                       fmt::format("{}, one per circle", circles.size()));
    }
  }
  request.options.sigma = quantity("u_point_um", u_point_um, Quantity::length, "um", 0, kMostUm);
  request.tolerances = tolerance_texts(tolerances);
  for (const nb::object& circle : circles) {
    if (circle.is_none()) throw InputError({.field = "circles"}, "one of them is None", "points, or a file of them");
    request.circles.push_back(points_to_fit({circle}, unit, "", false));
    if (nb::isinstance<NamedPoints>(circle) || path_of(circle)) continue;
    request.circles.back().file = fmt::format("circle {}", request.circles.size());
  }
  return computed([&] { return fit_circles(std::move(request)); });
}

template <class Fit, class Value>
std::optional<Value> if_known(const Fit& fit, const Value& value) {
  return fit.has_covariance ? std::optional(value) : std::nullopt;
}

void bind_uncertainties(nb::class_<FittedShape>& bound) {
  bound
      .def_prop_ro(
          "covariance", [](const FittedShape& f) { return if_known(f.fit, f.fit.covariance); },
          "[8, 8] of point (mm), direction, radius (mm), half angle (rad); None if not known.")
      .def_prop_ro(
          "radius_uncertainty_mm", [](const FittedShape& f) { return if_known(f.fit, f.fit.radius_uncertainty()); },
          "Standard uncertainty; None if not known.")
      .def_prop_ro(
          "direction_uncertainty_rad",
          [](const FittedShape& f) { return if_known(f.fit, f.fit.direction_uncertainty()); },
          "Standard uncertainty of its most uncertain tilt; None if not known.")
      .def_prop_ro(
          "point_uncertainty_mm", [](const FittedShape& f) { return if_known(f.fit, f.fit.point_uncertainty()); },
          "Standard uncertainty in its most uncertain direction; None if not known.");
}

void bind_fitted_shape(nb::module_& module) {
  nb::class_<FittedShape> bound(
      module, "FittedShape",
      "A shape fitted to points. Made by fit().\n\n"
      "Use the numbers only if ok is True; otherwise status and reason say why there are none.");
  add_report(
      bound, &FittedShape::report, +[](const FittedShape&) { return ResultFiles{}; });
  bound.def_prop_ro("ok", &FittedShape::is_ok, "Whether the fit succeeded.")
      .def_prop_ro(
          "status", [](const FittedShape& f) { return fit_status_name(f.fit.status); }, "'ok', or why it did not.")
      .def_prop_ro(
          "reason", [](const FittedShape& f) { return f.fit.reason; }, "The same in words; empty if ok.")
      .def_prop_ro(
          "shape", [](const FittedShape& f) { return f.fit.shape; }, "The fitted Shape.")
      .def_prop_ro(
          "deviations_mm", [](const FittedShape& f) { return copied_array(f.deviations); },
          nb::sig("def deviations_mm(self) -> numpy.ndarray"), "[n] as from Shape.distances(); empty if not ok.")
      .def_prop_ro(
          "points_mm", [](nb::handle_t<FittedShape> self) { return rows_view(initialised(self).points.points, self); },
          nb::sig("def points_mm(self) -> numpy.ndarray"), "[n, 3] as given.")
      .def_prop_ro(
          "form_mm", [](const FittedShape& f) { return f.fit.form; },
          "Largest minus smallest distance; for a line or circle in space, the diameter of the tube around it.")
      .def_prop_ro(
          "rms_mm", [](const FittedShape& f) { return f.fit.rms; }, "Root mean square distance.")
      .def_prop_ro(
          "sigma_mm", [](const FittedShape& f) { return f.fit.sigma; },
          "Standard deviation of a point from which the covariance is computed.")
      .def_prop_ro("degrees_of_freedom", [](const FittedShape& f) { return f.fit.degrees_of_freedom; })
      .def_prop_ro(
          "contacts", [](const FittedShape& f) { return f.fit.contacts; },
          "Indices of the points that determine the result: minimum zone, circumscribed, inscribed.")
      .def_prop_ro(
          "weights",
          [](const FittedShape& f) -> nb::object {
            if (f.fit.weights.empty()) return nb::none();
            return copied_array(f.fit.weights);
          },
          nb::sig("def weights(self) -> numpy.ndarray | None"), "[n] of a robust fit, 0 to 1; else None.")
      .def_prop_ro(
          "rejected", [](const FittedShape& f) { return f.fit.rejected; }, "Points that a robust fit left out.")
      .def(
          "residuals_csv",
          [](const FittedShape& f) {
            if (f.is_ok()) return fitted_points_csv(f);
            throw InputError({.field = "status"}, "there is no fit: " + f.fit.reason, "a fit that is ok");
          },
          "The points with their deviation_mm: what `abbe fit --residuals` writes.")
      .def("__repr__", [](const FittedShape& f) {
        return f.is_ok() ? fmt::format("<abbe.FittedShape {}: {} points, form {:.3f} um>",
                                       shape_kind_name(f.fit.shape.kind), f.fit.points, 1e3 * f.fit.form)
                         : fmt::format("<abbe.FittedShape: {}>", fit_status_name(f.fit.status));
      });
  bind_uncertainties(bound);
}

void bind_fitted_circles(nb::module_& module) {
  nb::class_<FittedCircles> bound(
      module, "FittedCircles",
      "Circles about one axis. Made by fit_coaxial_circles().\n\nUse the numbers only if ok is True.");
  add_report(
      bound, &FittedCircles::report, +[](const FittedCircles&) { return ResultFiles{}; });
  bound.def_prop_ro("ok", &FittedCircles::is_ok, "Whether the fit succeeded.")
      .def_prop_ro(
          "status", [](const FittedCircles& f) { return fit_status_name(f.fit.status); }, "'ok', or why it did not.")
      .def_prop_ro(
          "reason", [](const FittedCircles& f) { return f.fit.reason; }, "The same in words.")
      .def_prop_ro(
          "point_mm", [](const FittedCircles& f) { return f.fit.point; }, "[3] of the axis: mean of the centres.")
      .def_prop_ro(
          "direction", [](const FittedCircles& f) { return f.fit.direction; }, "[3] of the axis, unit.")
      .def_prop_ro(
          "heights_mm", [](const FittedCircles& f) { return copied_array(f.fit.heights); },
          nb::sig("def heights_mm(self) -> numpy.ndarray"), "[m] of the centres above point_mm, along the direction.")
      .def_prop_ro(
          "radii_mm", [](const FittedCircles& f) { return copied_array(f.fit.radii); },
          nb::sig("def radii_mm(self) -> numpy.ndarray"), "[m] of the circles.")
      .def_prop_ro(
          "form_mm", [](const FittedCircles& f) { return copied_array(f.fit.form); },
          nb::sig("def form_mm(self) -> numpy.ndarray"),
          "[m] diameter of the tube around each circle that holds its points.")
      .def_prop_ro(
          "rms_mm", [](const FittedCircles& f) { return f.fit.rms; }, "Root mean square distance.")
      .def_prop_ro(
          "covariance", [](const FittedCircles& f) { return if_known(f.fit, f.fit.covariance); },
          "[6 + 2 m, 6 + 2 m] of point, direction, heights, radii, mm and rad; None if not known.")
      .def("__repr__", [](const FittedCircles& f) {
        return fmt::format("<abbe.FittedCircles: {} circles, {}>", f.fit.radii.size(), fit_status_name(f.fit.status));
      });
}

}  // namespace

void bind_fits(nb::module_& module) {
  bind_fitted_shape(module);
  bind_fitted_circles(module);
  module.def(
      "fit", &fit, nb::arg("points_mm"), nb::arg("shape"), nb::kw_only(), nb::arg("method") = "least-squares",
      nb::arg("loss") = "tukey", nb::arg("fixed_radius_mm") = nb::none(), nb::arg("fixed_direction") = nb::none(),
      nb::arg("fixed_half_angle_deg") = nb::none(), nb::arg("u_point_um") = 0.0, nb::arg("unit") = nb::none(),
      nb::arg("tolerances") = Tolerances{}, nb::arg("page") = true, nb::arg("file") = "",
      "A line, plane, circle, sphere, cylinder or cone fitted to points: `abbe fit`.\n\n"
      "points_mm: [n, 3] (for shapes in the plane also [n, 2]), a PointCloud, or a file (csv, xyz, ply, obj, corners "
      "of "
      "stl).\n"
      "shape: 'line2', 'circle2' (in x, y), 'line', 'plane', 'circle', 'sphere', 'cylinder', 'cone'. method:\n"
      "'least-squares', 'minimum-zone', 'circumscribed', 'inscribed', 'robust' (up to 30 % wrong points). loss of the\n"
      "robust method: 'tukey', 'huber', 'welsch'. fixed_...: held at this value. u_point_um: standard uncertainty of a "
      "point\n"
      "across the shape; 0: from the residuals. unit: for a file that states none. tolerances: {'form_um': 10}. page:\n"
      "whether the page shows the points on the surface. file: name for the title. Raises InputError; too few or\n"
      "degenerate points give a result that is not ok. Methods: docs/fits.md.\n\n"
      ">>> import abbe, numpy\n"
      ">>> angle = numpy.linspace(0, 6, 20)\n"
      ">>> ring = abbe.fit(numpy.stack([3 + 5 * numpy.cos(angle), 5 * numpy.sin(angle)], axis=1), 'circle2')\n"
      ">>> round(ring.shape.radius_mm, 9), ring.shape.point_mm.round(9).tolist(), ring.ok\n"
      "(5.0, [3.0, 0.0, 0.0], True)\n"
      ">>> abbe.fit([[0, 0, 0], [1, 0, 0]], 'plane').status\n"
      "'too few points'\n");
  module.def(
      "fit_coaxial_circles", &fit_coaxial, nb::arg("circles"), nb::kw_only(), nb::arg("fixed_radius_mm") = nb::none(),
      nb::arg("fixed_direction") = nb::none(), nb::arg("u_point_um") = 0.0, nb::arg("unit") = nb::none(),
      nb::arg("tolerances") = Tolerances{},
      nb::sig("def fit_coaxial_circles(circles: collections.abc.Sequence[str | os.PathLike | numpy.typing.ArrayLike | "
              "PointCloud], *, fixed_radius_mm: collections.abc.Sequence[float] | None = None, fixed_direction: "
              "numpy.typing.ArrayLike | None = None, u_point_um: float = 0.0, unit: str | None = None, tolerances: "
              "collections.abc.Mapping[str, float] = {}) -> FittedCircles"),
      "Circles about one common axis by least squares, all at once: `abbe fit --shape coaxial-circles`.\n\n"
      "circles: points [n, 3] of each, mm, or files. fixed_radius_mm: one per circle. Two circles suffice for the "
      "axis,\n"
      "even if each is a short arc. Raises InputError. Method: docs/fits.md.");
}

}  // namespace abbe::python
