#pragma once

// Paths of a displacement probe over a part, as `abbe scan plan` plans them:
//
//   #include <abbe/formats/files/results_folder.h>
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/formats/shapes/mesh_file.h>
//   #include <abbe/study/planning/planned_scan.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::ScanRequest request;
//     request.machine = abbe::read_machine("examples/machines/liu-scanner.machine.toml");
//     request.part_file = "examples/cradle_scanner/pyramid.stl";
//     request.part = abbe::read_mesh(request.part_file).mesh;
//     request.scan.along = request.scan.between = 1;  // mm
//     const abbe::PlannedScan planned = abbe::plan_part_scan(request);
//     abbe::write_file_atomically("path.csv", abbe::planned_scan_csv(planned));
//     std::printf("%zu points on %zu faces, %.1f %% of the area\n", planned.plan.points(), planned.plan.faces.size(),
//                 100 * planned.plan.covered_share());
//     return 0;  // planned_scan_text() says more
//   }
//
// It prints:
//
//   673 points on 10 faces, 100.0 % of the area
//
// Method and figures: docs/scan.md.

#include <Eigen/Core>
#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/formats/nc/path_program.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/machine/machine.h"
#include "abbe/plan/scans/scan_plan.h"
#include "abbe/study/job_options.h"

namespace abbe {

/// A part that is to be scanned.
struct ScanRequest {
  Machine machine;
  TriangleMesh part;      ///< frame of the part, mm; its vertices need not be shared
  std::string part_file;  ///< name for texts and messages
  ScanPlanOptions scan;   ///< its `progress` is set here
};

/// Workpiece from part.
/// @param position_mm  origin of the part in the workpiece frame
/// @param turn_deg     about x, then y, then z, as rotation_from_error_angles()
RigidTransform part_placement(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& turn_deg);
/// The half-space beyond a plane.
/// @param plane  nx, ny, nz, d: nx x + ny y + nz z >= d; d in mm for a unit normal, which may be of any length
/// @throws InputError naming --beyond-plane-mm for a normal of no length and for numbers that are not finite
HalfSpace beyond_plane(const std::array<double, 4>& plane);

/// A planned scan. It holds no reference to the request.
struct PlannedScan {
  Machine machine;
  TriangleMesh part;  ///< closed, vertices shared
  std::string name;   ///< of the part's file, without its folder
  ScanPlanOptions scan;
  ScanPlan plan;

  /// Whether everything that is wanted is reached, and on a clear way.
  bool is_complete() const { return plan.missed_places() == 0 && plan.blocked_links == 0; }
};

/// Plans paths over all faces of a part. Opens no file and prints nothing.
/// @param options  progress: faces done of all, by the calling thread
/// @throws InputError for a part that encloses no volume, one of which nothing is wanted, and for more than 5,000,000
///   points; std::invalid_argument as plan_scan(); Stopped where that was asked for
PlannedScan plan_part_scan(const ScanRequest& request, const JobOptions& options = {});

/// The path as CSV.
std::string planned_scan_csv(const PlannedScan& planned);
/// The path as an NC program.
std::string planned_scan_program(const PlannedScan& planned, const PathProgramOptions& options = {});
/// For people; complete lines.
std::string planned_scan_text(const PlannedScan& planned);
/// For programs; units in the keys.
nlohmann::ordered_json planned_scan_json(const PlannedScan& planned);
/// The page that plays the path over the part.
std::string planned_scan_page(const PlannedScan& planned);

}  // namespace abbe
