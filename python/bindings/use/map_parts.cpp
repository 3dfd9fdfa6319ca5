#include "bindings/use/map_parts.h"

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

namespace abbe::python {
namespace {

/// Numbers of a map where they lie; the map lives as long as the array.
nb::object view(nb::handle owner, const std::vector<double>& values) {
  return nb::cast(nb::ndarray<nb::numpy, const double>(values.data(), {values.size()}, owner),
                  nb::rv_policy::reference);
}

nb::object norm(nb::handle_t<ErrorMap> self) { return view(self, nb::cast<const ErrorMap&>(self).norm); }

nb::object norm_uncertainty(nb::handle_t<ErrorMap> self) {
  const ErrorMap& map = nb::cast<const ErrorMap&>(self);
  if (map.norm_uncertainty.empty()) return nb::none();
  return view(self, map.norm_uncertainty);
}

nb::object uncertainty(const ErrorMap& map) {
  std::size_t parts = 0;
  while (parts < 6 && map.uncertainty[parts].size() == map.count()) ++parts;
  if (parts == 0 || map.count() == 0) return nb::none();
  Columns<double> columns(parts, map.count());
  for (std::size_t p = 0; p < parts; ++p) {
    std::copy(map.uncertainty[p].begin(), map.uncertainty[p].end(), columns[p]);
  }
  return columns.release({parts}, false);
}

Eigen::Matrix4d removed(const ErrorMap& map) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = map.removed.rotation;
  matrix.topRightCorner<3, 1>() = map.removed.translation;
  return matrix;
}

void bind_error_map(nb::module_& module) {
  nb::class_<ErrorMap>(module, "ErrorMap",
                       "Deviations of the functional point and of the tool's orientation in the workpiece frame.\n\n"
                       "norm_mm and norm_uncertainty_mm are read-only views; the others are new arrays at each access.")
      .def_prop_ro(
          "points_mm", [](const ErrorMap& m) { return copied_columns(m.point); },
          nb::sig("def points_mm(self) -> numpy.ndarray"),
          "[n, 3] where the nominal machine, or the corrected one, has the functional point, mm.")
      .def_prop_ro(
          "displacement_mm", [](const ErrorMap& m) { return copied_columns(m.displacement); },
          nb::sig("def displacement_mm(self) -> numpy.ndarray"), "[n, 3] actual minus that, mm.")
      .def_prop_ro(
          "rotation_rad",
          [](const ErrorMap& m) -> nb::object {
            if (m.rotation[0].empty()) return nb::none();
            return copied_columns(m.rotation);
          },
          nb::sig("def rotation_rad(self) -> numpy.ndarray | None"), "[n, 3] rotation vector of the tool, rad.")
      .def_prop_ro("norm_mm", &norm, nb::sig("def norm_mm(self) -> numpy.ndarray"),
                   "[n] length of the displacement: the volumetric error, mm.")
      .def_prop_ro("uncertainty_mm_rad", &uncertainty, nb::sig("def uncertainty_mm_rad(self) -> numpy.ndarray | None"),
                   "[n, 6] standard uncertainties of displacement (mm) and rotation (rad), JCGM 100; None: not stated.")
      .def_prop_ro("norm_uncertainty_mm", &norm_uncertainty,
                   nb::sig("def norm_uncertainty_mm(self) -> numpy.ndarray | None"),
                   "[n] along the displacement, mm; None: not stated.")
      .def_prop_ro(
          "covered", [](const ErrorMap& m) { return array_of_bools(std::vector<std::uint8_t>(m.covered)); },
          nb::sig("def covered(self) -> numpy.ndarray"),
          "[n] false outside the range in which the errors are known: no result.")
      .def_prop_ro("removed", &removed, "Rigid motion that was taken out, [4, 4], mm: the best fit of the datum.")
      .def_ro("statistics_mm", &ErrorMap::statistics, "Of norm_mm over covered poses.")
      .def("__len__", &ErrorMap::count)
      .def("__repr__", [](const ErrorMap& m) {
        return fmt::format("<abbe.ErrorMap: {} poses, mean {:.3f} um, largest {:.3f} um>", m.count(),
                           1e3 * m.statistics.mean, 1e3 * m.statistics.maximum);
      });
}

}  // namespace

void require_same_machine(const Machine& machine, const Machine& other, const char* argument) {
  if (machine.chain() == other.chain()) return;
  throw InputError({.field = argument}, "is of a machine " + other.chain(), "errors of a machine " + machine.chain());
}

void check_grid(const std::vector<AxisRange>& ranges) {
  double count = 1;
  for (const AxisRange& range : ranges) count *= static_cast<double>(range.count);
  constexpr double kMost = 2e7;  // as map_errors()
  if (count > kMost) throw InputError({.field = "grid"}, fmt::format("{:.0f} poses", count), "at most 20,000,000");
}

void bind_map_parts(nb::module_& module) {
  bind_error_map(module);
  nb::class_<VolumetricFigures>(module, "VolumetricFigures",
                                "Volumetric error in the figures that all commands state, mm (docs/conventions.md).\n\n"
                                "Statistics, or None where something is not known.")
      .def_ro("poses_words", &VolumetricFigures::poses_words, "The poses in words.")
      .def_ro("poses", &VolumetricFigures::poses, "That have a result.")
      .def_ro("outside", &VolumetricFigures::outside, "Outside the range in which the errors are known.")
      .def_ro("predicted_before_mm", &VolumetricFigures::predicted_before, "Before correction, as predicted.")
      .def_ro("predicted_after_mm", &VolumetricFigures::predicted_after,
              "What is predicted to be left after correction, k = 2, from the covariance of the errors.")
      .def_ro("true_before_mm", &VolumetricFigures::true_before, "True errors before correction (simulation).")
      .def_ro("true_after_mm", &VolumetricFigures::true_after, "True errors after correction (simulation).")
      .def("__repr__",
           [](const VolumetricFigures& f) { return "<abbe.VolumetricFigures over " + f.poses_words + ">"; });
  nb::class_<ErrorShare>(module, "ErrorShare", "How much one group of errors contributes.")
      .def_ro("name", &ErrorShare::name, "'translations', 'rotations', 'locations', 'tool', or an axis.")
      .def_ro("mean_mm", &ErrorShare::mean, "Mean displacement with only this group present, mm.")
      .def_ro("maximum_mm", &ErrorShare::maximum)
      .def_ro("share", &ErrorShare::share, "Shares add up to 1 to first order; one may be below zero.")
      .def("__repr__", [](const ErrorShare& s) {
        return fmt::format("<abbe.ErrorShare {}: mean {:.3f} um, share {:.3f}>", s.name, 1e3 * s.mean, s.share);
      });
  nb::class_<LeftOutPoses>(module, "LeftOutPoses", "Poses that have no result, by reason.")
      .def_ro("all", &LeftOutPoses::all, "Poses asked for.")
      .def_ro("not_covered", &LeftOutPoses::not_covered, "Outside the range in which the errors are known.")
      .def_ro("outside_travel", &LeftOutPoses::outside_travel, "Their corrected commands leave the travel.")
      .def_ro("not_reached", &LeftOutPoses::not_reached, "No command of the axes reaches the point.")
      .def_prop_ro("count", &LeftOutPoses::count, "Of all reasons.")
      .def(
          "text", [](const LeftOutPoses& p) { return p.count() == 0 ? "" : left_out_words(p); }, "A sentence.")
      .def("__repr__",
           [](const LeftOutPoses& p) { return fmt::format("<abbe.LeftOutPoses: {} of {}>", p.count(), p.all); });
}

}  // namespace abbe::python
