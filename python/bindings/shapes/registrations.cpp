#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "abbe/formats/machine/transform_file.h"
#include "abbe/geometry/registration/feature_registration.h"
#include "abbe/report/words/registration_words.h"
#include "abbe/study/scans/scan_registration.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/job.h"
#include "bindings/shapes/shapes.h"

namespace abbe::python {
namespace {

/// "global", "identity", a transform file, or [4, 4].
using StartArgument = std::variant<std::string, std::filesystem::path, ArrayLike>;

std::optional<RigidTransform> start_of(const StartArgument& argument) {
  if (const auto* const word = std::get_if<std::string>(&argument)) {
    if (*word == "global") return std::nullopt;
    if (*word == "identity") return RigidTransform{};
    return computed([&] { return read_transform(*word); });
  }
  if (const auto* const path = std::get_if<std::filesystem::path>(&argument)) {
    return computed([&] { return read_transform(*path); });
  }
  return rigid_transform(std::get<ArrayLike>(argument), "start");
}

ScanRegistration registered(const PointsArgument& scan, const MeshArgument& part, const StartArgument& start,
                            const std::string& loss, double noise_um, std::uint64_t seed,
                            const std::optional<std::string>& unit, const std::optional<std::string>& part_unit,
                            bool compare, const nb::object& progress) {
  ScanRegistrationRequest request;
  request.options.loss = word_value<RegistrationLoss>(
      "loss", loss,
      {{"adf", RegistrationLoss::welsch}, {"welsch", RegistrationLoss::welsch}, {"tukey", RegistrationLoss::tukey}});
  request.options.adaptive_distance = loss == "adf";
  request.options.noise_mm = quantity("noise_um", noise_um, Quantity::length, "um", 0, 1e6);
  request.options.seed = seed;
  request.options.start = start_of(start);
  enter_scan_and_part(scan, unit, part, part_unit, request);
  request.compare = compare;
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] { return register_scan(std::move(request), control.options("registering")); });
  });
}

FineRegistration to_features(const ArrayLike& points, const std::vector<Shape>& features,
                             const std::optional<std::vector<std::size_t>>& labels,
                             const std::optional<ArrayLike>& start, const std::string& loss, double noise_um) {
  const Eigen::Matrix3Xd given = points_of_array(points, "points_mm").cloud.points;
  if (features.empty()) throw InputError({.field = "features"}, "is empty", "at least one Shape");
  for (const Shape& feature : features) {
    const ShapeKind kind = feature.kind;
    if (kind == ShapeKind::plane || kind == ShapeKind::sphere || kind == ShapeKind::cylinder) continue;
    throw InputError({.field = "features"}, fmt::format("there is a {}", shape_name(kind)),
                     "planes, spheres and cylinders");
  }
  const std::vector<std::size_t> of_points = labels.value_or(std::vector<std::size_t>{});
  if (labels && of_points.size() != static_cast<std::size_t>(given.cols())) {
    throw InputError({.field = "labels"}, fmt::format("has {} numbers", of_points.size()),
                     fmt::format("{}, one per point", given.cols()));
  }
  for (const std::size_t label : of_points) {
    if (label < features.size()) continue;
    throw InputError({.field = "labels"}, fmt::format("has {}", label), fmt::format("below {}", features.size()));
  }
  FeatureRegistrationOptions options;
  options.loss = word_value<RegistrationLoss>(
      "loss", loss, {{"welsch", RegistrationLoss::welsch}, {"least-squares", RegistrationLoss::least_squares}});
  options.noise_mm = quantity("noise_um", noise_um, Quantity::length, "um", 0, 1e6);
  const RigidTransform from = start ? rigid_transform(*start, "start") : RigidTransform{};
  return stoppable_result([&](const std::stop_token& stop) {
    options.stop = stop;
    return naming_arguments([&] { return register_to_features(given, features, of_points, from, options); });
  });
}

template <class Result>
void add_pose(nb::class_<Result>& bound, const FineRegistration& (*fine)(const Result&)) {
  bound
      .def_prop_ro(
          "matrix", [=](const Result& r) { return transform_matrix(fine(r).mesh_from_scan); },
          "Part from scan, [4, 4], mm; valid only if there is a pose.")
      .def_prop_ro(
          "covariance", [=](const Result& r) { return fine(r).covariance; },
          "[6, 6] of a turn about reference_mm (rad) and a shift (mm) in the frame of the part.")
      .def_prop_ro(
          "reference_mm", [=](const Result& r) { return fine(r).reference; },
          "[3] middle of the scan, frame of the part.")
      .def_prop_ro(
          "scale_mm", [=](const Result& r) { return fine(r).scale_mm; }, "Robust standard deviation of the distances.")
      .def_prop_ro(
          "rms_mm", [=](const Result& r) { return fine(r).rms_mm; }, "Of the distances, weighted.")
      .def_prop_ro(
          "used", [=](const Result& r) { return static_cast<std::size_t>(fine(r).used); },
          "Number of points that count.")
      .def_prop_ro(
          "undetermined", [=](const Result& r) { return undetermined_words(fine(r)); },
          "Motions that the scan does not determine, in words.");
}

void bind_registration(nb::module_& module) {
  using Result = ScanRegistration;
  nb::class_<ScanRegistration> bound(module, "ScanRegistration",
                                     "The pose of a scan on its part. Made by register_scan().\n\n"
                                     "text(), json_text(), page_html() and write() give what `abbe register` writes.");
  add_pose<ScanRegistration>(
      bound, +[](const Result& r) -> const FineRegistration& { return r.found.fine; });
  bound.def_prop_ro("ok", &Result::is_ok, "Whether exactly one pose fits.")
      .def_prop_ro(
          "has_pose", [](const Result& r) { return has_pose(r.found); },
          "Whether there is a pose, even if it is one of many.")
      .def_prop_ro(
          "status", [](const Result& r) { return registration_status_name(r.found.status); },
          "'ok', 'ambiguous', 'undetermined', or why there is no pose.")
      .def_prop_ro(
          "inlier_share", [](const Result& r) { return r.found.inlier_share; },
          "Share of the points that are nearer than three robust standard deviations.")
      .def_prop_ro(
          "alternatives",
          [](const Result& r) {
            std::vector<Eigen::Matrix4d> poses;
            for (const AlternativePose& pose : r.found.alternatives)
              poses.push_back(transform_matrix(pose.mesh_from_scan));
            return poses;
          },
          "Other poses that fit equally well: part from scan, [4, 4].")
      .def_prop_ro(
          "points_mm", [](const Result& r) { return copied_rows(registered_scan(r).points); },
          nb::sig("def points_mm(self) -> numpy.ndarray"), "[n, 3] the scan in the frame of the part.")
      .def_prop_ro(
          "deviations_mm",
          [](const Result& r) -> nb::object {
            if (!r.compared) return nb::none();
            return copied_array(r.compared->deviation.deviation_mm);
          },
          nb::sig("def deviations_mm(self) -> numpy.ndarray | None"),
          "[n] from the part, positive outside of the material; None without a pose, or with compare=False.")
      .def("text", &scan_registration_text, nb::arg("uncertainty") = false,
           "What `abbe register` prints. uncertainty: with the covariance of the pose.")
      .def("__repr__", [](const Result& r) {
        return fmt::format("<abbe.ScanRegistration: {}, scale {:.3f} um>", registration_status_name(r.found.status),
                           1e3 * r.found.fine.scale_mm);
      });
  add_json(bound, &scan_registration_json);
  add_page(bound, &scan_registration_page);
  add_files(bound, &scan_registration_files,
            "Writes the results folder: registration.json, report.html, transform.csv and registered.ply.");
}

}  // namespace

void bind_registrations(nb::module_& module) {
  bind_registration(module);
  nb::class_<FineRegistration> features(module, "FeatureRegistration",
                                        "The pose of points on ideal features. Made by register_to_features().");
  add_pose<FineRegistration>(
      features, +[](const FineRegistration& r) -> const FineRegistration& { return r; });
  features
      .def_prop_ro(
          "ok", [](const FineRegistration& r) { return r.status == FineRegistrationStatus::ok; },
          "Whether the points determine the pose.")
      .def_prop_ro("status", [](const FineRegistration& r) { return registration_status_name(r.status); })
      .def("__repr__", [](const FineRegistration& r) {
        return fmt::format("<abbe.FeatureRegistration: {}>", registration_status_name(r.status));
      });
  module.def(
      "register_scan", &registered, nb::arg("scan"), nb::arg("part"), nb::kw_only(), nb::arg("start") = "global",
      nb::arg("loss") = "adf", nb::arg("noise_um") = 0.0, nb::arg("seed") = 1, nb::arg("unit") = nb::none(),
      nb::arg("part_unit") = nb::none(), nb::arg("compare") = true, nb::arg("progress") = nb::none(),
      "The pose of a scan on its part, with uncertainty, from any start: `abbe register`.\n\n"
      "scan: points [n, 3], a PointCloud or a file. part: a Mesh or a file. start: 'global' (any pose), 'identity', a\n"
      "transform file, or part from scan [4, 4]. loss: 'adf' (Welsch weights with second-order steps), 'welsch',\n"
      "'tukey'. noise_um: standard uncertainty of a point along the normal; 0: from the residuals. unit, part_unit: "
      "of\n"
      "files that state none. compare: find the remaining deviations, also for the page. progress: a function of "
      "the\n"
      "step, what is done and its total. Raises InputError, Stopped. Method: docs/registration.md.");
  module.def("register_to_features", &to_features, nb::arg("points_mm"), nb::arg("features"), nb::kw_only(),
             nb::arg("labels") = nb::none(), nb::arg("start") = nb::none(), nb::arg("loss") = "welsch",
             nb::arg("noise_um") = 0.0,
             "The pose of points [n, 3] on ideal features: planes, spheres, cylinders in the frame of the part.\n\n"
             "labels [n]: index of the feature of each point; else the nearest one in each step. start: part from scan "
             "[4, 4];\n"
             "else the identity. loss: 'welsch' or 'least-squares'. noise_um: as register_scan(). Raises InputError.");
}

}  // namespace abbe::python
