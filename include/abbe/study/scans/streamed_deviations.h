#pragma once

// Deviations of a scan that does not fit into memory from its part, as `abbe deviate` finds them. Which scans these
// are, what is exact and how it goes on after a kill: docs/scale.md.

#include <cstddef>
#include <cstdint>
#include <string>

#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/study/job_options.h"
#include "abbe/study/scans/scan_deviations.h"
#include "abbe/verify/parts/point_sample.h"

namespace abbe {

/// Points above which a scan is read in blocks, where nothing else is said.
inline constexpr std::uint64_t kStreamedAbove = 20000000;

struct StreamingOptions {
  std::uint64_t above = kStreamedAbove;       ///< --stream-above: larger scans are read in blocks
  std::size_t block = std::size_t{1} << 19U;  ///< points that are in memory at a time; no result depends on it
  std::size_t shown = PointSample::kDefault;  ///< points in the picture and the files, beside the extremes
};

/// Whether a scan is read in blocks: its file is binary PLY or PCD and states more points than `above`, or is a text
/// of more than kBytesOfPointInText bytes for each of them.
/// @throws InputError for a file of another kind that is as large: it cannot be read in blocks
bool is_read_in_blocks(const std::string& scan_file, std::uint64_t above);

/// As find_deviations(), of the file `scan_file` of the request, which is read in blocks where is_read_in_blocks();
/// otherwise as a whole. In blocks, percentiles are from a histogram; all other figures are exact. Neither threads nor
/// blocks nor kills make a difference to any byte of the result.
/// @param request  without the scan
/// @param scan     how to read it
/// @param job      progress: in blocks, bytes of the scan that were compared; as a whole, as find_deviations(). Its
///   pieces are numbered work: of several processes the first one gets the result, and the others one without points
/// @throws InputError as find_deviations(), and for a scan that changes while it is read; Stopped
ScanDeviations deviations_of_file(ScanDeviationsRequest request, const PointCloudOptions& scan,
                                  const StreamingOptions& options = {}, const JobOptions& job = {});

}  // namespace abbe
