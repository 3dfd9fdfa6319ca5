#pragma once

// Axis positions and indications of a probe turned into points of the part, as `abbe scan points` does it:
//
//   #include <abbe/formats/machine/errors_file.h>
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/study/scans/scanned_points.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::ScannedPointsRequest request;
//     request.machine = abbe::read_machine("examples/machines/liu-scanner.machine.toml");
//     request.errors_file = "examples/cradle_scanner/stages.errors.toml";
//     request.errors = abbe::read_errors(request.errors_file, request.machine).errors;
//     request.readings = "examples/cradle_scanner/readings.csv";
//     request.output = "points.ply";
//     request.indication_range = {-0.02, 0.02};  // mm
//     const abbe::ScannedPoints result = abbe::write_scanned_points(request);
//     if (!result.refused.empty()) return 1;
//     std::printf("%zu of %zu readings give points\n", result.summary.points, result.summary.readings);
//     return 0;  // scanned_points_text() says more
//   }
//
// It prints:
//
//   363 of 468 readings give points
//
// Formats and method: docs/scan.md. From text to text: scan_points() (abbe/formats/readings/scan_file.h).

#include <Eigen/Core>
#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "abbe/errors/error_set.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/readings/scan_file.h"
#include "abbe/instruments/point_scan.h"
#include "abbe/machine/machine.h"
#include "abbe/study/job_options.h"
#include "abbe/verify/left_out_poses.h"

namespace abbe {

/// A file of readings that is to become a file of points; lengths in mm, directions in the frame of the tool.
///
/// Messages name a field by the option of `abbe scan points` that sets it, given below.
struct ScannedPointsRequest {
  Machine machine;          ///< nominal
  ErrorSet errors;          ///< --errors: calibrated axes and all other errors
  StateValues at_state{};   ///< at which the errors are taken, for texts
  std::string errors_file;  ///< its name for texts; empty: a machine without errors
  std::string readings;     ///< file of axis positions and indications (.csv), of any length
  std::string output;       ///< --output: file of the points (.csv, .ply)

  Eigen::Vector3d beam_zero = Eigen::Vector3d::Zero();  ///< --beam-zero-mm: from the gauge point
  std::optional<Eigen::Vector3d> beam;  ///< --beam: towards the part, of any length; else against the tool's direction
  std::optional<std::array<double, 2>>
      indication_range;  ///< --indication-range-mm: others are left out; lower end first
  ScanOptions scan;      ///< columns, travel, decimals, threads; range of indications and progress are set here
};

/// The beam of a displacement probe on a machine.
/// @param zero       where the indication is zero: from the gauge point, mm, tool frame
/// @param direction  towards the part, of any length, tool frame; without it, opposite to the tool direction
/// @throws InputError naming --beam-zero-mm or --beam for numbers that are not finite and a direction of no length
ProbeBeam probe_beam(const Machine& machine, const Eigen::Vector3d& zero,
                     const std::optional<Eigen::Vector3d>& direction = std::nullopt);

/// Result of the conversion. It holds no reference to the request.
struct ScannedPoints {
  std::string machine;  ///< its name
  StateValues at_state{};
  std::string errors_file, output;
  ScanSummary summary;
  std::string refused;  ///< why there is no point at all; empty: there are some

  LeftOutPoses left_out() const;  ///< readings where the errors are not known
};

/// Turns readings into points of the workpiece, as scan_points(): neither the readings nor the points are ever in
/// memory as a whole, and the output appears whole or not at all. Prints nothing.
/// @param options  progress: bytes of the readings done of all, by the calling thread
/// @throws InputError for a beam that has no direction, an empty range, and as scan_points(); Stopped where that was
///   asked for, without an output
ScannedPoints write_scanned_points(const ScannedPointsRequest& request, const JobOptions& options = {});

/// For people; complete lines.
std::string scanned_points_text(const ScannedPoints& result);

/// For programs; units in the keys.
nlohmann::ordered_json scanned_points_json(const ScannedPoints& result);

}  // namespace abbe
