#pragma once

// How far a scan is from its part, as `abbe deviate` finds it:
//
//   #include <abbe/study/scans/scan_deviations.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::ScanDeviationsRequest request;
//     request.scan_file = "examples/scan/bracket-scan.csv";
//     request.part_file = "examples/scan/bracket.stl";
//     request.transform_file = "examples/scan/bracket-transform.csv";
//     request.scan = abbe::read_point_cloud(request.scan_file);
//     request.part = abbe::read_mesh(request.part_file);
//     request.pose = abbe::read_transform_file(request.transform_file);
//     request.largest_mm = 0.3;
//     const abbe::ScanDeviations result = abbe::find_deviations(request);
//     const abbe::SampleStatistics& sample = result.compared.deviation.all.sample;
//     std::printf("%zu points count: mean %.1f um, rms %.1f um\n", sample.count, 1e3 * sample.mean, 1e3 * sample.rms);
//     return 0;  // evaluation_text(result.report) says more
//   }
//
// It prints:
//
//   1793 points count: mean 14.4 um, rms 40.5 um
//
// The report as JSON: evaluation_json(); as a page: evaluation_files(). Figures: docs/registration.md.

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/text_on_disk.h"
#include "abbe/formats/machine/transform_file.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/study/job_options.h"
#include "abbe/verify/parts/scan_comparison.h"
#include "abbe/verify/parts/surface_deviation.h"

namespace abbe {

/// By what the deviations of a part are stated, beside the part as a whole.
enum class DeviationFaces {
  none,
  by_edges,  ///< faces end at edges sharper than `crease`
  of_file    ///< as the file of the part states them
};

/// A scan and its part; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe deviate` that sets it, given below.
struct ScanDeviationsRequest {
  PointCloudFile scan;
  MeshFile part;
  std::string scan_file, part_file;  ///< names for texts and messages
  TransformFile pose;                ///< --transform: of the scan on the part
  std::string transform_file;        ///< its name; empty: the scan as it stands

  double largest_mm = 0;                        ///< --largest-mm: points farther away are left out; 0: all count
  std::optional<DeviationTolerance> tolerance;  ///< --lower-um, --upper-um: a band
  double colour_mm = 0;                         ///< --colour-um: of the full colour; 0: as it shows most of them
  DeviationFaces faces = DeviationFaces::none;  ///< --faces-deg, --faces
  double crease = 0;
  std::vector<std::string> tolerances;  ///< --tolerance: "maximum_um=50", as apply_tolerances() takes them
  int threads = 0;                      ///< 0: all; no result depends on it
  bool page = false;                    ///< the report is to have the deviations on the part, for its page
  /// deviations_of_file(): takes deviation.csv bit by bit while points are compared, if it is made then. An empty text
  /// says that it begins again.
  std::function<void(std::string text)> take_csv;
};

/// Deviations of a scan from its part, with their report. They hold no reference to the request.
struct ScanDeviations {
  ScanComparison compared;     ///< of a scan that was read in blocks: counted points are those that are shown
  std::string csv;             ///< deviation.csv, where it was made while points were compared; else empty
  bool csv_was_taken = false;  ///< by `take_csv` of the request
  EvaluationReport report;     ///< with the tolerances of the request
  double colour_mm = 0;        ///< of the full colour
  /// Half of the points that count lie farther from the part than a tenth of its diagonal: the scan is not where the
  /// part is, and its deviations say nothing about the part. A note of the report says so.
  bool elsewhere = false;
  /// Whether any point counts.
  bool has_points() const { return !compared.counted_mm.empty(); }
};

/// Compares a scan with its part. Opens no file and prints nothing.
/// @param job  progress: points that were compared. Blocks of points are numbered work: of several processes the first
///   one gets the result, and the others one without points
/// @throws InputError for a scan without points, a part without triangles or without the faces that were asked for, a
///   transform of a registration that found no pose, a band whose lower end is above the upper one, and as
///   apply_tolerances()
/// @throws Stopped
ScanDeviations find_deviations(const ScanDeviationsRequest& request, const JobOptions& job = {});

/// Files of the points that count, name and contents: deviation.csv, unless it was taken, and deviation.ply (coloured).
std::vector<std::pair<std::string, std::string>> deviation_files(const ScanDeviations& result);
/// Writes them, deviation.ply while it is made.
/// @param csv  what has taken deviation.csv, if anything did @throws InputError as ResultsFolder
void write_deviation_files(const ScanDeviations& result, std::optional<TextOnDisk> csv, ResultsFolder& results);

}  // namespace abbe
