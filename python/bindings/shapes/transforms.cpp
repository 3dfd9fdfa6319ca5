#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "abbe/geometry/best_fit_transform.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

std::vector<Eigen::Vector3d> vectors_of(const ArrayLike& points, const char* name) {
  const Eigen::Matrix3Xd columns = points_of_array(points, name).cloud.points;
  std::vector<Eigen::Vector3d> vectors;
  vectors.reserve(static_cast<std::size_t>(columns.cols()));
  for (Eigen::Index k = 0; k < columns.cols(); ++k) vectors.emplace_back(columns.col(k));
  return vectors;
}

std::vector<double> weights_of(const std::optional<ArrayLike>& argument, std::size_t count) {
  if (!argument) return {};
  std::vector<double> weights = number_list(*argument, "weights", "one per point, 0 or more");
  if (weights.size() != count) {
    throw InputError({.field = "weights"}, fmt::format("has {} numbers", weights.size()),
                     fmt::format("{}, one per point", count));
  }
  for (const double weight : weights) {
    if (weight < 0) throw InputError({.field = "weights"}, fmt::format("has {}", weight), "0 or more");
  }
  return weights;
}

BestFitTransform best_fit(const ArrayLike& source, const ArrayLike& target, const std::optional<ArrayLike>& weights,
                          bool robust, std::uint64_t seed) {
  const std::vector<Eigen::Vector3d> from = vectors_of(source, "source_mm"), to = vectors_of(target, "target_mm");
  if (from.size() != to.size()) {
    throw InputError({.field = "target_mm"}, fmt::format("has {} points", to.size()),
                     fmt::format("{} as in source_mm", from.size()));
  }
  const std::vector<double> given = weights_of(weights, from.size());
  if (robust && weights)
    throw InputError({.field = "weights"}, "have no effect on a robust fit", "either weights or robust=True");
  const nb::gil_scoped_release release;
  if (!robust) return best_fit_transform(from, to, given);
  RobustFitOptions options;
  options.seed = seed;
  return robust_best_fit_transform(from, to, options);
}

}  // namespace

void bind_transforms(nb::module_& module) {
  nb::class_<BestFitTransform>(module, "BestFit",
                               "A rigid motion that brings paired points together. Made by best_fit_transform().")
      .def_prop_ro(
          "ok", [](const BestFitTransform& f) { return f.status == BestFitStatus::ok; },
          "Whether the points determine the motion.")
      .def_prop_ro(
          "status", [](const BestFitTransform& f) { return best_fit_status_name(f.status); },
          "'ok', or why they do not.")
      .def_prop_ro(
          "matrix", [](const BestFitTransform& f) { return transform_matrix(f.target_from_source); },
          "Target from source, [4, 4], mm. For coincident or collinear points, one of many that fit equally well.")
      .def_ro("rms_mm", &BestFitTransform::rms, "Root mean square distance, weighted.")
      .def_ro("extent_mm", &BestFitTransform::extent,
              "[3] root mean square extent of the source along its principal directions, largest first.")
      .def_prop_ro(
          "inliers",
          [](const BestFitTransform& f) -> nb::object {
            if (f.inliers.empty()) return nb::none();
            return array_of_bools(std::vector<std::uint8_t>(f.inliers));
          },
          nb::sig("def inliers(self) -> numpy.ndarray | None"),
          "[n] points that took part in the last step of a robust fit; else None.")
      .def("__repr__", [](const BestFitTransform& f) {
        return fmt::format("<abbe.BestFit: {}, rms {:.3f} um>", best_fit_status_name(f.status), 1e3 * f.rms);
      });
  module.def(
      "best_fit_transform", &best_fit, nb::arg("source_mm"), nb::arg("target_mm"), nb::kw_only(),
      nb::arg("weights") = nb::none(), nb::arg("robust") = false, nb::arg("seed") = 1,
      "The rigid motion, without reflection or scaling, that best brings points onto their partners.\n\n"
      "source_mm, target_mm: [n, 3], row by row. weights [n], 0 or more, of the squared distances. robust: up to 40 % "
      "of the\n"
      "pairs may be wrong; seed of its random triples. Raises InputError; too few points give a result that is not "
      "ok.\n"
      "Source: Kabsch, Acta Cryst. A32 (1976) 922; Umeyama, IEEE PAMI 13 (1991) 376.\n\n"
      ">>> import abbe, numpy\n"
      ">>> corners = numpy.array([[0, 0, 0], [10, 0, 0], [0, 20, 0]])\n"
      ">>> abbe.best_fit_transform(corners, corners + [1, 2, 3]).matrix[:3, 3].round(9).tolist()\n"
      "[1.0, 2.0, 3.0]\n");
}

}  // namespace abbe::python
