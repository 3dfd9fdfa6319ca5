#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/geometry/fits/shapes.h"
#include "abbe/identify/linkage/scanner_positioning.h"

namespace abbe {

/// The scan of a clamped workpiece: to be laid on features of its drawing, or on a mesh.
struct WorkpieceScan {
  std::vector<Shape> features;       ///< frame of the workpiece; empty: by the mesh
  Eigen::Matrix3Xd points;           ///< [3, n] mm, scanner's frame; of the features
  std::vector<std::size_t> labels;   ///< [n] feature of each point
  RigidTransform start;              ///< workpiece from scanner, roughly; of the features
  std::filesystem::path part, scan;  ///< mesh and point cloud, to be read by whoever wants them; empty: by features
  double noise = 0;                  ///< standard uncertainty of a point along the normal, mm; 0: from the residuals
};

/// What a `*.positioning.toml` file says: a scanner's view of targets on a table, and of the workpiece.
struct ScannerPositioningFile {
  PositioningScans scans;
  std::optional<WorkpieceScan> workpiece;
};

/// Reads such a file and the CSV of points it names; see docs/workpiece-position.md. @throws InputError
ScannerPositioningFile read_scanner_positioning(const std::filesystem::path& path);

/// The same from texts. @param file, points_file  names for messages
ScannerPositioningFile parse_scanner_positioning(const std::string& text, const std::string& file,
                                                 std::string_view points, const std::string& points_file);

/// Text of such a file: a scanner's view with features of a workpiece, or without a workpiece.
/// @param points_file  name of the CSV beside it, of positioning_targets()
/// @param names        [features] target of each
/// @throws std::invalid_argument for a workpiece on a mesh, and for names that are not as many as the features
std::string scanner_positioning_text(const ScannerPositioningFile& file, const std::string& points_file,
                                     const std::vector<std::string>& names = {});

/// Points of a scan, by target.
struct TargetPoints {
  std::string target;
  std::vector<Eigen::Vector3d> points;  ///< mm, scanner's frame
};
/// The points of the file's targets: "X", "Y", "circle 1", ..., "sphere", and the features' names.
std::vector<TargetPoints> positioning_targets(const ScannerPositioningFile& file,
                                              const std::vector<std::string>& names = {});
/// Contents of the CSV: `target`, `x`, `y`, `z`; to a nanometre.
std::string target_points_csv(const std::vector<TargetPoints>& targets);

}  // namespace abbe
