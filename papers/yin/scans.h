#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "abbe/formats/readings/scanner_positioning_file.h"
#include "yin/study.h"

namespace abbe {

/// A structured-light scanner looks at the table, targets, sphere and workpiece of the paper, all of which hide parts
/// of each other; its baseline, noise and place are assumed, as the paper does not state them.
struct YinScans {
  PositioningScans scans;    ///< what it has seen, its frame: X, Y, circles, sphere
  Eigen::Matrix3Xd surface;  ///< and the surfaces of the part
  std::vector<std::size_t> labels;
  RigidTransform start;                              ///< workpiece from scanner, roughly
  RigidTransform table_from_scanner;                 ///< the truth
  Placement placement;                               ///< the truth: the first reading of Table 3
  std::size_t targets_placed = 0, targets_seen = 0;  ///< positions of targets
  std::size_t surface_placed = 0, surface_seen = 0;  ///< places on sphere and workpiece
};
YinScans yin_simulated_scans(std::uint64_t seed);

/// Scanner and workpiece from what was seen, against the truth.
struct YinScansFound {
  YinPositioning positioning;  ///< largest_difference: mm, from the truth; without numbers where it has a failure
  double chi_square = 0;       ///< of the six parameters with their stated covariance
};
YinScansFound yin_locate(const YinScans& scans);

/// The same as files: text of a `*.positioning.toml` file and the CSV that it names.
struct YinScanFiles {
  std::string positioning, points;
};
YinScanFiles yin_scan_files(const YinScans& scans, const std::string& points_file);

}  // namespace abbe
