#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "abbe/report/words/registration_words.h"
#include "abbe/study/scans/scan_deviations.h"
#include "abbe/study/scans/scan_registration.h"
#include "bindings/arrays_of_each.h"
#include "bindings/evaluate/report.h"
#include "bindings/job.h"
#include "bindings/shapes/shapes.h"

namespace abbe::python {
namespace {

constexpr double kMost = 1e9;  // mm or um

/// The file of a transform, a registration, or [4, 4].
using TransformArgument = std::variant<ScanRegistration, std::filesystem::path, ArrayLike>;

void enter_transform(const std::optional<TransformArgument>& argument, ScanDeviationsRequest& request) {
  if (!argument) return;
  if (const auto* const path = std::get_if<std::filesystem::path>(&*argument)) {
    request.pose = computed([&] { return read_transform_file(*path); });
    request.transform_file = path->string();
    return;
  }
  request.transform_file = "transform";
  if (const auto* const registration = std::get_if<ScanRegistration>(&*argument)) {
    request.pose = {registration->found.fine.mesh_from_scan,
                    registration->is_ok() ? "" : registration_status_name(registration->found.status)};
  } else {
    request.pose.transform = rigid_transform(std::get<ArrayLike>(*argument), "transform");
  }
}

ScanDeviations deviations(const PointsArgument& scan, const MeshArgument& part,
                          const std::optional<TransformArgument>& transform, std::optional<double> largest_mm,
                          std::optional<double> lower_um, std::optional<double> upper_um,
                          std::optional<double> faces_deg, bool faces, std::optional<double> colour_um,
                          const std::optional<std::string>& unit, const std::optional<std::string>& part_unit,
                          const Tolerances& tolerances, bool page) {
  ScanDeviationsRequest request;
  const auto length = [](const char* name, const std::optional<double>& value, const char* in, double from) {
    return value ? quantity(name, *value, Quantity::length, in, from, kMost) : 0;
  };
  request.largest_mm = length("largest_mm", largest_mm, "mm", 0);
  request.colour_mm = length("colour_um", colour_um, "um", 0);
  if (lower_um || upper_um) {
    request.tolerance =
        DeviationTolerance{length("lower_um", lower_um, "um", -kMost), length("upper_um", upper_um, "um", -kMost)};
  }
  if (faces && faces_deg) throw InputError({.field = "faces_deg"}, "is given together with faces", "only one of them");
  if (faces_deg) request.crease = quantity("faces_deg", *faces_deg, Quantity::angle, "deg", 0, 180);
  request.faces = faces                ? DeviationFaces::of_file
                  : request.crease > 0 ? DeviationFaces::by_edges
                                       : DeviationFaces::none;
  request.tolerances = tolerance_texts(tolerances);
  request.page = page;
  enter_transform(transform, request);
  enter_scan_and_part(scan, unit, part, part_unit, request);
  return stoppable_result([&](const std::stop_token& stop) {
    return naming_arguments([&] { return find_deviations(request, {.stop = stop}); });
  });
}

}  // namespace

void bind_deviations(nb::module_& module) {
  using Result = ScanDeviations;
  nb::class_<ScanDeviations> bound(module, "ScanDeviations",
                                   "Deviations of a scan from its part. Made by scan_deviations().");
  add_report(bound, &ScanDeviations::report, &deviation_files);
  bound.def_prop_ro("has_points", &Result::has_points, "Whether any point counts.")
      .def_ro("elsewhere", &Result::elsewhere,
              "Half of the points that count lie farther from the part than a tenth of its diagonal: the scan is not "
              "where the part is.")
      .def_prop_ro(
          "deviations_mm", [](const Result& r) { return copied_array(r.compared.deviation.deviation_mm); },
          nb::sig("def deviations_mm(self) -> numpy.ndarray"), "[n] positive outside of the material.")
      .def_prop_ro(
          "counted",
          [](const Result& r) { return array_of_bools(std::vector<std::uint8_t>(r.compared.deviation.counted)); },
          nb::sig("def counted(self) -> numpy.ndarray"),
          "[n] False where the closest point is on the border of an open mesh, or farther away than largest_mm.")
      .def_prop_ro(
          "counted_points_mm", [](const Result& r) { return copied_rows(r.compared.counted_points); },
          nb::sig("def counted_points_mm(self) -> numpy.ndarray"), "[k, 3] points that count, frame of the part.")
      .def_prop_ro(
          "counted_mm", [](const Result& r) { return copied_array(r.compared.counted_mm); },
          nb::sig("def counted_mm(self) -> numpy.ndarray"), "[k] their deviations.")
      .def_prop_ro(
          "closest_mm", [](const Result& r) { return vectors_of_each(r.compared.closest, &SurfacePoint::point); },
          nb::sig("def closest_mm(self) -> numpy.ndarray"), "[n, 3] closest points of the part.")
      .def_prop_ro(
          "statistics_mm", [](const Result& r) { return r.compared.deviation.all.sample; },
          "Of the deviations that count.")
      .def_prop_ro(
          "statistics_by_face_mm",
          [](const Result& r) {
            return values_of_each<SampleStatistics>(r.compared.deviation.regions, &DeviationStatistics::sample);
          },
          "Of each face, if faces or faces_deg is given.")
      .def_prop_ro(
          "within", [](const Result& r) { return r.compared.deviation.all.within; },
          "Share of the points in the band from lower_um to upper_um; 0 without one.")
      .def_prop_ro(
          "colour_mm", [](const Result& r) { return r.colour_mm; }, "Deviation that is shown in full colour.")
      .def("__repr__", [](const Result& r) {
        const SampleStatistics& sample = r.compared.deviation.all.sample;
        return fmt::format("<abbe.ScanDeviations: {} points count, rms {:.3f} um>", sample.count, 1e3 * sample.rms);
      });
  module.def(
      "scan_deviations", &deviations, nb::arg("scan"), nb::arg("part"), nb::kw_only(),
      nb::arg("transform") = nb::none(), nb::arg("largest_mm") = nb::none(), nb::arg("lower_um") = nb::none(),
      nb::arg("upper_um") = nb::none(), nb::arg("faces_deg") = nb::none(), nb::arg("faces") = false,
      nb::arg("colour_um") = nb::none(), nb::arg("unit") = nb::none(), nb::arg("part_unit") = nb::none(),
      nb::arg("tolerances") = Tolerances{}, nb::arg("page") = true,
      "Signed distances of a scan from its part, with statistics: `abbe deviate`.\n\n"
      "scan: points [n, 3], a PointCloud or a file. part: a Mesh or a file. transform: part from scan, as [4, 4], a\n"
      "transform file or a ScanRegistration; default: the scan as it stands. largest_mm: points farther away are left "
      "out.\n"
      "lower_um, upper_um: a band; within is the share of points in it. faces_deg: statistics by face, where faces end "
      "at\n"
      "edges sharper than this; faces: by the faces of a STEP or OBJ file. colour_um: deviation shown in full colour.\n"
      "unit, part_unit: for files that state none. tolerances: {'maximum_um': 50}. page: whether the page shows the "
      "part in "
      "three\n"
      "dimensions. Raises InputError. Ctrl-C stops it. Figures: docs/registration.md.\n\n"
      ">>> import abbe\n"
      ">>> plane = abbe.Mesh([[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]], [[0, 1, 2], [0, 2, 3]])\n"
      ">>> result = abbe.scan_deviations([[2, 3, 0.01], [7, 3, -0.02]], plane)\n"
      ">>> result.deviations_mm.round(6).tolist(), result['maximum'].unit\n"
      "([0.01, -0.02], 'um')\n");
}

}  // namespace abbe::python
