#include "abbe/study/scans/scan_deviations.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/evaluations/deviation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/scans/closest_points.h"
#include "abbe/study/scans/deviation_steps.h"
#include "abbe/study/scans/scan_of_part.h"

namespace abbe {

void check_deviation_request(const ScanDeviationsRequest& request) {
  if (request.tolerance && request.tolerance->lower_mm > request.tolerance->upper_mm) {
    throw InputError({.field = "--lower-um"}, "lies above --upper-um", "a band from lower to upper");
  }
  const std::string& status = request.pose.status;
  if (status.empty() || status == "ok" || status == "ambiguous" || status == "undetermined") return;
  throw InputError({.file = request.transform_file, .field = "status"},
                   fmt::format("the registration that wrote this transform says {}", status),
                   "the transform of a registration that found a pose (ok, ambiguous or undetermined)");
}

SurfaceFaces faces_of_part(const ScanDeviationsRequest& request) {
  switch (request.faces) {
    case DeviationFaces::none:
      return {};
    case DeviationFaces::by_edges:
      return surface_faces(request.part.mesh, request.crease, request.threads);
    case DeviationFaces::of_file:
      break;
  }
  if (request.part.faces == 0) {
    throw InputError({.file = request.part_file}, "the file states no faces",
                     "a STEP file, or an OBJ file with o, g or usemtl; --faces-deg finds faces by their edges");
  }
  return stated_faces(request.part.mesh, request.part.face_of_triangle, request.part.faces);
}

void note_scan_elsewhere(const MeshFile& part, double middle_mm, ScanDeviations& result) {
  constexpr double kShareOfDiagonal = 0.1;
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < part.mesh.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) box.extend(part.mesh.corner(i, corner));
  }
  const double diagonal = box.diagonal().norm();
  result.elsewhere = middle_mm > kShareOfDiagonal * diagonal;
  if (!result.elsewhere) return;
  result.report.notes.insert(
      result.report.notes.begin(),
      fmt::format("The scan is not where the part is: half of its points are farther than {:.4g} mm away, and the part "
                  "measures {:.4g} mm from corner to corner. Register the scan first (abbe register).",
                  middle_mm, diagonal));
}

DeviationRequest asked_of_report(const ScanDeviationsRequest& request) {
  DeviationRequest asked{.scan = request.scan_file,
                         .part = request.part_file,
                         .transform = request.transform_file,
                         .status = request.pose.status,
                         .tolerance = request.tolerance,
                         .largest_mm = request.largest_mm,
                         .colour_mm = request.colour_mm};
  if (request.faces == DeviationFaces::of_file) asked.face_names = request.part.face_names;
  return asked;
}

ScanDeviations find_deviations(const ScanDeviationsRequest& request, const JobOptions& job) {
  check_deviation_request(request);
  check_scan_and_part(request.scan, request.scan_file, request.part, request.part_file);
  const MeshFile& part = request.part;
  const ClosestPointFinder surface(part.mesh, request.threads);
  const SurfaceFaces faces = faces_of_part(request);
  stop_if_asked(job.stop);
  ScanDeviations result;
  const Eigen::Matrix3Xd points = moved_cloud(request.scan.cloud, request.pose.transform).points;
  std::optional<std::vector<SurfacePoint>> closest = closest_points(surface, part.mesh, points, request.threads, job);
  if (!closest) return result;
  result.compared = compare_scan(std::move(*closest), points,
                                 {.tolerance = request.tolerance, .largest_mm = request.largest_mm, .faces = faces});
  const DeviationRequest asked = asked_of_report(request);
  result.report = deviation_report(asked, request.scan, part, result.compared);
  if (result.has_points()) note_scan_elsewhere(part, deviation_amounts(result.compared.counted_mm).middle_mm, result);
  apply_tolerances(request.tolerances, result.report);
  result.colour_mm = deviation_colour_range(asked, result.compared);
  if (request.page) {
    stop_if_asked(job.stop);
    result.report.page = deviation_page(part.mesh, result.compared.closest, result.compared.deviation, result.colour_mm,
                                        request.threads);
  }
  return result;
}

namespace {

/// deviation.ply, in pieces.
void take_coloured_points(const ScanDeviations& result, const std::function<void(std::string)>& take) {
  constexpr Eigen::Index kTogether = 16384;
  const ScanComparison& compared = result.compared;
  const Eigen::Index n = compared.counted_points.cols();
  for (Eigen::Index first = 0; first == 0 || first < n; first += kTogether) {
    const Eigen::Index count = std::min(kTogether, n - first);
    const auto deviation =
        std::span(compared.counted_mm).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
    const PlyParts some{.points = compared.counted_points.middleCols(first, count),
                        .colours = deviation_colours(deviation, result.colour_mm),
                        .deviation = deviation};
    if (first == 0) take(ply_header(some, n));
    take(ply_rows(some));
  }
}

std::string csv_of(const ScanDeviations& result) {
  return result.csv.empty() ? point_cloud_csv({result.compared.counted_points, {}}, result.compared.counted_mm)
                            : result.csv;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> deviation_files(const ScanDeviations& result) {
  std::vector<std::pair<std::string, std::string>> files;
  if (!result.csv_was_taken) files.emplace_back("deviation.csv", csv_of(result));
  files.emplace_back("deviation.ply", "");
  take_coloured_points(result, [&](const std::string& some) { files.back().second += some; });
  return files;
}

void write_deviation_files(const ScanDeviations& result, std::optional<TextOnDisk> csv, ResultsFolder& results) {
  if (!result.csv_was_taken) {
    results.write("deviation.csv", csv_of(result));
  } else if (csv) {
    results.write("deviation.csv", std::move(*csv));
  }
  TextOnDisk points(results.name());
  take_coloured_points(result, points.taker());
  results.write("deviation.ply", std::move(points));
}

}  // namespace abbe
