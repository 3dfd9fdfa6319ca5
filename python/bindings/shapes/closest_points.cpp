#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/arrays_of_each.h"
#include "bindings/job.h"
#include "bindings/shapes/shapes.h"

namespace abbe::python {
namespace {

struct ClosestPoints {
  std::vector<SurfacePoint> found;
};

ClosestPoints closest(const NamedMesh& mesh, const ArrayLike& points) {
  const Eigen::Matrix3Xd of_array = points_of_array(points, "points_mm").cloud.points;
  const std::shared_ptr<const ClosestPointFinder> finder = mesh.finder();
  constexpr Eigen::Index kSoonDone = 10'000;  // points, found within some milliseconds
  if (of_array.cols() > kSoonDone) {
    return stoppable_result(
        [&](const std::stop_token& stop) { return ClosestPoints{finder->closest(of_array, 0, stop)}; });
  }
  const nb::gil_scoped_release release;
  return {finder->closest(of_array)};
}

}  // namespace

void bind_closest_points(nb::module_& module) {
  nb::class_<ClosestPoints>(module, "ClosestPoints", "The closest points of a mesh. Made by Mesh.closest().")
      .def_prop_ro(
          "points_mm", [](const ClosestPoints& c) { return vectors_of_each(c.found, &SurfacePoint::point); },
          nb::sig("def points_mm(self) -> numpy.ndarray"), "[n, 3] on the surface.")
      .def_prop_ro(
          "distance_mm", [](const ClosestPoints& c) { return numbers_of_each(c.found, &SurfacePoint::distance); },
          nb::sig("def distance_mm(self) -> numpy.ndarray"), "[n] positive outside of the material.")
      .def_prop_ro(
          "normals", [](const ClosestPoints& c) { return vectors_of_each(c.found, &SurfacePoint::normal); },
          nb::sig("def normals(self) -> numpy.ndarray"),
          "[n, 3] normal of the face, or angle-weighted at an edge or vertex; zero where no triangle has an area.")
      .def_prop_ro(
          "triangles", [](const ClosestPoints& c) { return ints_of_each(c.found, &SurfacePoint::triangle); },
          nb::sig("def triangles(self) -> numpy.ndarray"), "[n] index of the nearest triangle, the first of several.")
      .def_prop_ro(
          "on_border", [](const ClosestPoints& c) { return flags_of_each(c.found, &SurfacePoint::on_border); },
          nb::sig("def on_border(self) -> numpy.ndarray"),
          "[n] on the border of an open mesh, where the sign means little.")
      .def("__len__", [](const ClosestPoints& c) { return c.found.size(); })
      .def("__repr__", [](const ClosestPoints& c) { return fmt::format("<abbe.ClosestPoints: {}>", c.found.size()); });
  nb::cpp_function_def(&closest, nb::scope(nb::type<NamedMesh>()), nb::name("closest"), nb::is_method(),
                       nb::arg("points_mm"),
                       "Closest points of the surface to points [n, 3], mm, frame of the mesh. Exact to rounding. The "
                       "first call builds a\n"
                       "search structure, which the mesh keeps. Raises InputError. Method: docs/registration.md.");
}

}  // namespace abbe::python
