#include <fmt/format.h>

#include <utility>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/point_cloud_blocks.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/evaluations/deviation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/scans/counted_deviations.h"
#include "abbe/study/scans/deviation_steps.h"
#include "abbe/verify/parts/deviation_statistics.h"

namespace abbe {

std::string deviation_options_text(const ScanDeviationsRequest& request, const PointCloudOptions& scan) {
  std::string text =
      fmt::format("largest {} mm, faces {} {}", request.largest_mm, static_cast<int>(request.faces), request.crease);
  if (request.tolerance) {
    text += fmt::format(", band {} to {} mm", request.tolerance->lower_mm, request.tolerance->upper_mm);
  }
  if (scan.unit) text += fmt::format(", unit {}", file_length_name(*scan.unit));
  for (const auto& [own, theirs] : scan.mapping.columns) text += fmt::format(", column {}={}", own, theirs);
  for (const std::string& ignored : scan.mapping.ignore) text += ", ignored " + ignored;
  return text;
}

void note_left_out(PointCloudFile& scan) {
  if (scan.left_out == 0) return;
  scan.notes.push_back(fmt::format("{} left out: not all of their coordinates are finite numbers",
                                   scan.left_out == 1 ? "1 point is" : fmt::format("{} points are", scan.left_out)));
}

namespace {

/// Whether the reader of pieces knows the file.
bool fits_into_pieces(const std::string& scan_file) {
  const MappedFile file(scan_file);
  return point_cloud_kind(file.text(), scan_file).in_blocks;
}

/// @throws InputError
ScanDeviations compared_in_pieces(const ScanDeviationsRequest& request, const PointCloudOptions& scan,
                                  const JobOptions& job) {
  check_deviation_request(request);
  if (request.part.mesh.size() == 0) {
    throw InputError({.file = request.part_file}, "there is no triangle", "the surface of a part");
  }
  const ClosestPointFinder surface(request.part.mesh, request.threads);
  ScanDeviations result;
  result.compared.faces = faces_of_part(request);
  std::optional<CountedDeviations> counted = counted_deviations(request, scan, surface, result.compared.faces, job);
  if (!counted) return result;
  SurfaceDeviation& deviation = result.compared.deviation;
  deviation.all = deviation_statistics(counted->all, request.tolerance);
  for (const std::vector<double>& face : counted->faces) {
    deviation.regions.push_back(deviation_statistics(face, request.tolerance));
  }
  deviation.beyond_border = counted->beyond_border;
  deviation.too_far = counted->too_far;
  result.compared.counted_mm = std::move(counted->all);
  const DeviationAmounts amounts = deviation_amounts(result.compared.counted_mm);
  result.colour_mm = request.colour_mm > 0 ? request.colour_mm : colour_range_of_amount(amounts.for_colours_mm);
  result.report =
      deviation_report(asked_of_report(request), StreamedScan{.file = &counted->scan, .points = counted->points},
                       request.part, result.compared, result.colour_mm);
  if (result.has_points()) note_scan_elsewhere(request.part, amounts.middle_mm, result);
  apply_tolerances(request.tolerances, result.report);
  if (!request.page) return result;
  stop_if_asked(job.stop);
  result.report.page = deviation_page(counted->part, counted->colours, *counted->drawn, counted->points,
                                      result.compared.counted_mm, result.colour_mm);
  result.compared.counted_points = std::move(counted->points_mm);
  result.csv = std::move(counted->csv);
  result.csv_was_taken = request.take_csv && result.has_points();
  return result;
}

}  // namespace

std::optional<ScanDeviations> deviations_in_pieces(const ScanDeviationsRequest& request, const PointCloudOptions& scan,
                                                   const JobOptions& job) {
  if (!fits_into_pieces(request.scan_file)) return std::nullopt;
  JobOptions shared = job;
  bool has_begun = false;
  if (job.work) {
    shared.work = [&](const NumberedWork& work) {
      has_begun = true;
      job.work(work);
    };
  }
  try {
    return compared_in_pieces(request, scan, shared);
  } catch (const InputError&) {
    // A table of another form, perhaps; or the reader of whole files says what is wrong. Once several processes have
    // begun, another one may have found nothing wrong.
    if (has_begun && job.in_step.processes > 1) throw;
    if (request.take_csv) request.take_csv("");
    return std::nullopt;
  }
}

}  // namespace abbe
