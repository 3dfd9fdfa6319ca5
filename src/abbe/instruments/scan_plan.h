#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/triangle_mesh.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What the probe and the axes can do, and how densely the part is to be seen.
struct ScanPlanOptions {
  RigidTransform workpiece_from_part;                  ///< where the part stands
  double along = 0.5, between = 0.5;                   ///< mm, distance of points along a line and of lines
  double crease_angle = 30 * std::numbers::pi / 180;   ///< rad, faces end where triangles meet at more
  double largest_angle = 28 * std::numbers::pi / 180;  ///< rad, between the beam and the normal: n.m >= cos
  double range = 0.4;                                  ///< mm, of the indication, about its middle
  double working_distance = 10;                        ///< mm, from the measured point to the probe
  double probe_radius = 5, probe_length = 60;          ///< mm, a round rod behind the working distance
  double clearance = 0.5;                              ///< mm, kept between the probe and everything else
  std::optional<TriangleMesh> stage;                   ///< what else turns with the workpiece, workpiece frame, mm
  double linear_speed = 10, rotary_speed = std::numbers::pi / 6;  ///< mm/s, rad/s
  double readings_per_second = 100;
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< in faces
};

/// rotary: a surface of revolution about the rotary axis of the workpiece, which turns below the probe; raster: the
/// beam keeps its direction; free: the beam follows the normal.
enum class ScanPathKind { rotary, raster, free };
const char* scan_path_name(ScanPathKind kind);

struct PlannedFace {
  ScanPathKind kind = ScanPathKind::free;
  double area = 0, covered = 0;  ///< mm^2
  std::size_t lines = 0, points = 0;
  /// Places that no allowed direction of the beam reaches, by what was in the way with the beam along the normal.
  std::size_t hidden = 0, collision = 0, travel = 0;
  std::size_t tilted = 0;  ///< points measured at an angle because the normal was blocked
};

struct PlannedMove {
  Eigen::Vector3d point, normal, beam;  ///< mm and unit vectors, workpiece frame; beam: from the part to the probe
  std::size_t face = 0, line = 0;
  bool measures = false;  ///< else it goes around, away from the part
  double time = 0;        ///< s, to get here
};

/// Part of the surface for the picture of the coverage.
struct CoverageSample {
  Eigen::Vector3d point;  ///< mm, frame of the part
  std::size_t face = 0;
  bool covered = false;
};

struct ScanPlan {
  std::vector<PlannedFace> faces;
  PoseList positions;              ///< commands, mm or rad
  std::vector<PlannedMove> moves;  ///< [positions]
  std::vector<CoverageSample> coverage;
  double time = 0;                ///< s
  double largest_sag = 0;         ///< mm, surface from the straight move between neighbours, indication half way
  std::size_t beyond_range = 0;   ///< moves half way along which the indication leaves its range
  std::size_t blocked_links = 0;  ///< ways between lines on which the probe comes too near to something
  double covered_share() const;
};

/// Paths over all faces of a part for a displacement probe along the tool's direction.
///
/// Faces are what creases separate. A face whose normals lie within the largest angle of their mean is scanned as a
/// raster; one of revolution about the workpiece's own rotary axis on circles; all others freely. The functional point
/// of the machine (the middle of the probe's range) goes along the surface, so the axis along the beam follows it.
/// At every point the beam is along the normal (raster: along the mean normal) or, where it or the probe would meet the
/// part or the stage or an axis its end of travel, tilted by up to the largest angle. Between lines the probe draws
/// back as far as it has to.
/// @param part  closed, vertices shared, frame of the part, mm
/// @throws std::invalid_argument if an option is not above zero
ScanPlan plan_scan(const Machine& machine, const TriangleMesh& part, const ScanPlanOptions& options);

}  // namespace abbe
