#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/fine_histogram.h"
#include "abbe/verify/parts/point_sample.h"
#include "abbe/verify/parts/scan_comparison.h"

namespace abbe {

/// Settings of a comparison of a scan with its part.
struct DeviationRequest {
  std::string scan, part;  ///< names of the files
  std::string transform;   ///< file of the scan's pose on the part; empty: the scan as it stands
  std::string status;      ///< of the registration that wrote it: "ambiguous"
  std::optional<DeviationTolerance> tolerance = std::nullopt;
  double largest_mm = 0;                     ///< points farther away are left out; 0: all count
  double colour_mm = 0;                      ///< deviation of the full colour; 0: as it shows most of them
  std::vector<std::string> face_names = {};  ///< [faces] as the file of the part states them, or empty
};

/// Deviation of the full colour, mm: as asked for, or by the deviations that count.
double deviation_colour_range(const DeviationRequest& request, const ScanComparison& compared);

/// Statistics of all points and by faces, their distribution, facts about both files and notes.
EvaluationReport deviation_report(const DeviationRequest& request, const PointCloudFile& scan, const MeshFile& part,
                                  const ScanComparison& compared);

/// A scan that was read in blocks; what it points to has to live while the report is made.
struct StreamedScan {
  const PointCloudFile* file = nullptr;  ///< without its points
  std::size_t points = 0;                ///< of the scan
  const FineHistogram* histogram = nullptr;
  std::size_t shown = 0;                  ///< points in the picture and the files
  const SampledPoint* least = nullptr;    ///< null: no point counts
  const SampledPoint* largest = nullptr;  ///< likewise
};

/// The same for a scan that was read in blocks, with the bounds of what is not exact.
/// @param compared  deviation: of all points; counted_mm: of those that are shown
/// @param range_mm  of the full colour
EvaluationReport deviation_report(const DeviationRequest& request, const StreamedScan& scan, const MeshFile& part,
                                  const ScanComparison& compared, double range_mm);

}  // namespace abbe
