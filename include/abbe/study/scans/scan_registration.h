#pragma once

// A scan laid on its part, as `abbe register` does it:
//
//   #include <abbe/study/scans/scan_registration.h>
//
//   #include <cstdio>
//   #include <utility>
//
//   int main() {
//     abbe::ScanRegistrationRequest request;
//     request.scan_file = "examples/scan/bracket-scan.csv";
//     request.part_file = "examples/scan/bracket.stl";
//     request.scan = abbe::read_point_cloud(request.scan_file);
//     request.part = abbe::read_mesh(request.part_file);
//     const abbe::ScanRegistration result = abbe::register_scan(std::move(request));
//     if (!result.is_ok()) return 1;
//     std::printf("%td points, scatter %.1f um\n", result.scan.cloud.size(), 1e3 * result.found.fine.scale_mm);
//     return 0;  // scan_registration_text() says more
//   }
//
// It prints:
//
//   2000 points, scatter 7.3 um
//
// Method and figures: docs/registration.md.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/geometry/registration/registration.h"
#include "abbe/geometry/surface/point_cloud.h"
#include "abbe/study/job_options.h"
#include "abbe/verify/parts/scan_comparison.h"

namespace abbe {

/// A scan and the part on which it is to be laid.
struct ScanRegistrationRequest {
  PointCloudFile scan;
  MeshFile part;
  std::string scan_file, part_file;  ///< names for texts and messages
  RegistrationOptions options;
  bool compare = false;  ///< find also how far the scan is from the part there, for the page
};

/// Where a scan lies on its part. It owns all that it needs.
struct ScanRegistration {
  std::string scan_file, part_file;
  PointCloudFile scan;
  MeshFile part;
  Registration found;
  std::optional<ScanComparison> compared;  ///< if asked for and if there is a pose
  int threads = 0;                         ///< for the page; no result depends on it

  /// Whether there is one pose; a pose that is one of many has another status of `found`.
  bool is_ok() const { return found.status == RegistrationStatus::ok; }
};

/// Lays a scan on its part. Opens no file and prints nothing.
/// @param options  progress: steps done of all, by the calling thread
/// @throws InputError for a scan without points and a part without triangles; Stopped where that was asked for
ScanRegistration register_scan(ScanRegistrationRequest request, const JobOptions& options = {});

/// The scan in the frame of the part.
PointCloud registered_scan(const ScanRegistration& result);

/// For people; complete lines. @param covariance  of the pose: state it too
std::string scan_registration_text(const ScanRegistration& result, bool covariance = false);

/// For programs; units in the keys.
nlohmann::ordered_json scan_registration_json(const ScanRegistration& result);

/// The page: pose, what the scan does not fix, and the deviations that are left where they were asked for.
std::string scan_registration_page(const ScanRegistration& result);

/// The files of a results folder, name and contents: registration.json, report.html and, where there is a pose,
/// transform.csv and registered.ply.
std::vector<std::pair<std::string, std::string>> scan_registration_files(const ScanRegistration& result);

}  // namespace abbe
