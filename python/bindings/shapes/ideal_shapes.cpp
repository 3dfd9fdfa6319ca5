#include "bindings/shapes/ideal_shapes.h"

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <numbers>

#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/scans/fitted_points.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

bool has_direction(ShapeKind kind) { return kind != ShapeKind::sphere; }
bool has_radius(ShapeKind kind) { return kind >= ShapeKind::circle2; }

double above_zero(const char* name, const std::optional<double>& value, double largest, const char* expected) {
  if (value && *value > 0 && *value < largest) return *value;
  throw InputError({.field = name}, value ? fmt::format("is {}", *value) : "is missing", expected);
}

void refuse_if(bool given, const char* name, const std::string& shape) {
  if (given) throw InputError({.field = name}, "a " + shape + " has none", fmt::format("no {}", name));
}

Shape shape_of(const std::string& name, const ArrayLike& point, const std::optional<ArrayLike>& direction,
               const std::optional<double>& radius_mm, const std::optional<double>& half_angle_deg) {
  Shape shape;
  shape.kind = shape_kind(name);
  shape.point = vector_of(point, "point_mm", "a point, mm");
  if (!(shape.point.cwiseAbs().maxCoeff() <= kLargestInput)) {
    throw InputError({.field = "point_mm"}, "is too far away", "at most 1e9 mm");
  }
  if (has_direction(shape.kind)) {
    if (shape.kind == ShapeKind::circle2 && !direction) {
      shape.direction = Eigen::Vector3d::UnitZ();
    } else {
      const std::optional<Eigen::Vector3d> given = direction_of(direction, "direction");
      if (!given || !(given->norm() > 0)) {
        throw InputError({.field = "direction"}, given ? "has no length" : "is missing", "three numbers, not all zero");
      }
      shape.direction = given->normalized();
    }
  } else {
    refuse_if(direction.has_value(), "direction", name);
  }
  if (has_radius(shape.kind)) {
    shape.radius = above_zero("radius_mm", radius_mm, kLargestInput, "a length in mm above zero");
  } else {
    refuse_if(radius_mm.has_value(), "radius_mm", name);
  }
  if (shape.kind == ShapeKind::cone) {
    shape.half_angle =
        above_zero("half_angle_deg", half_angle_deg, 90, "more than 0 and less than 90 degrees") * kDegree;
  } else {
    refuse_if(half_angle_deg.has_value(), "half_angle_deg", name);
  }
  return shape;
}

nb::object distances(const Shape& shape, const ArrayLike& points) {
  const Eigen::Matrix3Xd of_array = points_of_array(points, "points_mm").cloud.points;
  std::vector<double> values(static_cast<std::size_t>(of_array.cols()));
  {
    const nb::gil_scoped_release release;
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] = distance(shape, of_array.col(static_cast<Eigen::Index>(k)));
    }
  }
  const std::size_t count = values.size();
  return array_of(std::move(values), {count});
}

}  // namespace

ShapeKind shape_kind(const std::string& shape) { return word_value("shape", shape, shapes_by_name()); }

std::string shape_kind_name(ShapeKind kind) {
  for (const auto& [name, known] : shapes_by_name()) {
    if (known == kind) return name;
  }
  return "";
}

void bind_ideal_shapes(nb::module_& module) {
  nb::class_<Shape>(
      module, "Shape",
      "An ideal feature: line2, line, plane, circle2, circle, sphere, cylinder or cone.\n\n"
      "point_mm [3]: a point of the line, plane or axis, or the centre; for a cone, where its radius is radius_mm.\n"
      "direction [3], unit: along a line, normal of a plane or circle, along an axis, away from the apex "
      "of a cone.\n\n"
      ">>> import abbe\n"
      ">>> abbe.Shape('sphere', [0, 0, 0], radius_mm=5).distances([[0, 0, 7.0]]).tolist()\n"
      "[2.0]\n")
      .def(
          "__init__",
          [](Shape* self, const std::string& kind, const ArrayLike& point, const std::optional<ArrayLike>& direction,
             std::optional<double> radius_mm, std::optional<double> half_angle_deg) {
            new (self) Shape(shape_of(kind, point, direction, radius_mm, half_angle_deg));
          },
          nb::arg("kind"), nb::arg("point_mm"), nb::arg("direction") = nb::none(), nb::kw_only(),
          nb::arg("radius_mm") = nb::none(), nb::arg("half_angle_deg") = nb::none(),
          "direction: of any length. Give only what the shape has. Raises InputError.")
      .def_prop_ro("kind", [](const Shape& s) { return shape_kind_name(s.kind); })
      .def_ro("point_mm", &Shape::point)
      .def_prop_ro(
          "direction", [](const Shape& s) { return has_direction(s.kind) ? std::optional(s.direction) : std::nullopt; },
          "None for a sphere.")
      .def_prop_ro(
          "radius_mm", [](const Shape& s) { return has_radius(s.kind) ? std::optional(s.radius) : std::nullopt; },
          "None for a shape without one; of a cone, at point_mm.")
      .def_prop_ro(
          "half_angle_rad",
          [](const Shape& s) { return s.kind == ShapeKind::cone ? std::optional(s.half_angle) : std::nullopt; },
          "Between axis and generator of a cone; else None.")
      .def_prop_ro(
          "apex_mm", [](const Shape& s) { return s.kind == ShapeKind::cone ? std::optional(s.apex()) : std::nullopt; },
          "Of a cone; else None.")
      .def("distances", &distances, nb::arg("points_mm"),
           "Distances [n] of points [n, 3], mm: positive along the normal of a plane, to the left of a line2, outside "
           "a\n"
           "circle2, sphere, cylinder or cone; without a sign for a line and a circle in space.")
      .def("__repr__", [](const Shape& s) {
        return fmt::format("<abbe.Shape {} at ({:.6g}, {:.6g}, {:.6g}) mm>", shape_kind_name(s.kind), s.point[0],
                           s.point[1], s.point[2]);
      });
}

}  // namespace abbe::python
