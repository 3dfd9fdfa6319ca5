#include "abbe/study/scan_deviations.h"

#include <fmt/format.h>

#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/evaluations/deviation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/scan_of_part.h"

namespace abbe {
namespace {

/// Refuses a transform where the registration that wrote it found no pose.
void check_scan_pose(const ScanDeviationsRequest& request) {
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

}  // namespace

ScanDeviations find_deviations(const ScanDeviationsRequest& request, const std::stop_token& stop) {
  check_scan_pose(request);
  if (request.tolerance && request.tolerance->lower_mm > request.tolerance->upper_mm) {
    throw InputError({.field = "--lower-um"}, "lies above --upper-um", "a band from lower to upper");
  }
  check_scan_and_part(request.scan, request.scan_file, request.part, request.part_file);
  const MeshFile& part = request.part;
  const ClosestPointFinder surface(part.mesh, request.threads);
  stop_if_asked(stop);
  ScanDeviations result;
  result.compared = compare_scan(surface, moved_cloud(request.scan.cloud, request.pose.transform).points,
                                 {.tolerance = request.tolerance,
                                  .largest_mm = request.largest_mm,
                                  .faces = faces_of_part(request),
                                  .threads = request.threads,
                                  .stop = stop});
  DeviationRequest asked{.scan = request.scan_file,
                         .part = request.part_file,
                         .transform = request.transform_file,
                         .status = request.pose.status,
                         .tolerance = request.tolerance,
                         .largest_mm = request.largest_mm,
                         .colour_mm = request.colour_mm};
  if (request.faces == DeviationFaces::of_file) asked.face_names = part.face_names;
  result.report = deviation_report(asked, request.scan, part, result.compared);
  apply_tolerances(request.tolerances, result.report);
  result.colour_mm = deviation_colour_range(asked, result.compared);
  if (request.page) {
    stop_if_asked(stop);
    result.report.page = deviation_page(part.mesh, result.compared.closest, result.compared.deviation, result.colour_mm,
                                        request.threads);
  }
  return result;
}

std::vector<std::pair<std::string, std::string>> deviation_files(const ScanDeviations& result) {
  const ScanComparison& compared = result.compared;
  return {{"deviation.csv", point_cloud_csv({compared.counted_points, {}}, compared.counted_mm)},
          {"deviation.ply", ply_bytes({.points = compared.counted_points,
                                       .colours = deviation_colours(compared.counted_mm, result.colour_mm),
                                       .deviation = compared.counted_mm})}};
}

}  // namespace abbe
