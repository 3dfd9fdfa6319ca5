#pragma once

// Where a scanner and a workpiece stand in a machine, as `abbe position` finds it:
//
//   #include <abbe/formats/files/results_folder.h>
//   #include <abbe/study/compensation/found_positions.h>
//
//   #include <cstdio>
//
//   int main() {
//     const abbe::PositionsRequest request =
//         abbe::read_positions_request("examples/laser_engraver/scanner.positioning.toml");
//     const abbe::FoundPositions found = abbe::find_positions(request);
//     if (!found.is_ok() || !found.workpiece) return 1;
//     abbe::write_file_atomically("part.placement.toml", abbe::found_placement_file(found));
//     const Eigen::Vector3d origin = found.workpiece->placement.table_from_workpiece.translation;
//     std::printf("origin of the workpiece on the table: %.3f, %.3f, %.3f mm\n", origin.x(), origin.y(), origin.z());
//     return 0;  // found_positions_text() says more
//   }
//
// It prints:
//
//   origin of the workpiece on the table: 74.053, -94.747, -33.590 mm
//
// Formats and method: docs/workpiece-position.md.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "abbe/formats/readings/scanner_positioning_file.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/identify/linkage/scanner_positioning.h"
#include "abbe/report/words/positioning_words.h"
#include "abbe/study/job_options.h"

namespace abbe {

/// A scanner's view of targets on a table, and of a workpiece.
struct PositionsRequest {
  std::string file;  ///< name for texts and messages
  ScannerPositioningFile scans;
  std::optional<MeshFile> part;        ///< of a workpiece that is laid on a mesh
  std::optional<PointCloudFile> scan;  ///< of that workpiece
};

/// Opens the file, and those that it names. @throws InputError
PositionsRequest read_positions_request(const std::string& file, const MeshFileOptions& options = {});

/// The same.
/// @param read_part  reads the mesh of the part; not called where there is none
PositionsRequest read_positions_request(const std::string& file,
                                        const std::function<MeshFile(const std::string& part)>& read_part);

/// Where they stand. It holds no reference to the request.
struct FoundPositions {
  std::string file;
  ScannerPosition scanner;
  std::optional<PlacedWorkpiece> workpiece;  ///< if there is one, and the scanner has a position
  std::string problem;                       ///< what has no position and why, in words; empty: all have one

  bool is_ok() const { return problem.empty(); }
};

/// Finds the position of the scanner and, by it, that of the workpiece. Opens no file and prints nothing.
/// @param options  progress: steps done of all while a scan is laid on a mesh, by the calling thread
/// @throws InputError for a workpiece on a mesh without that mesh or its scan; Stopped where that was asked for
FoundPositions find_positions(const PositionsRequest& request, const JobOptions& options = {});

/// For people, where all have a position; complete lines.
std::string found_positions_text(const FoundPositions& found);

/// For programs; units in the keys. It says so where there is no position.
nlohmann::ordered_json found_positions_json(const FoundPositions& found);

/// Placement of the workpiece as a file (*.placement.toml) for `abbe path`; the workpiece must have a position.
std::string found_placement_file(const FoundPositions& found, bool table_to_workpiece = true);

}  // namespace abbe
