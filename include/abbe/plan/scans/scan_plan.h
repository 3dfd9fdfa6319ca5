#pragma once

// A pyramid scanned by a probe that looks down:
//
//   #include <abbe/machine/chain.h>
//   #include <abbe/plan/scans/scan_plan.h>
//
//   #include <cstdio>
//
//   int main() {
//     const abbe::Machine scanner = abbe::parse_chain("w C' A' b X Y Z t").machine;  // its beam along Z
//     abbe::TriangleMesh part;  // a flat pyramid, mm: corners of its base, then its tip
//     part.vertices.resize(3, 4);
//     part.vertices << -30, 30, 0, 0, -20, -20, 40, 0, 0, 0, 0, 8;
//     part.triangles.resize(3, 4);
//     part.triangles << 0, 0, 1, 2, 2, 1, 2, 0, 1, 3, 3, 3;
//     abbe::ScanPlanOptions options;
//     options.workpiece_from_part = abbe::RigidTransform::translate({0, 0, 5});
//     options.wanted = {{.normal = Eigen::Vector3d::UnitZ(), .offset = 0.5}};  // nothing below 0.5 mm
//     options.along = options.between = 1;                                     // mm
//
//     const abbe::ScanPlan plan = abbe::plan_scan(scanner, part, options);
//     std::printf("%.0f mm^2 in %zu faces: %.0f %% covered by %zu points in %.0f s\n", plan.area(), plan.faces.size(),
//                 100 * plan.covered_share(), plan.points(), plan.time);
//     if (plan.points() == 0 || plan.blocked_links > 0) return 1;
//     const std::vector<double> q = plan.positions.pose(0);  // in the order of the chain, rad and mm
//     std::printf("it begins at C %.3f A %.3f rad, X %.3f Y %.3f Z %.3f mm\n", q[0], q[1], q[2], q[3], q[4]);
//     return 0;
//   }
//
// It prints:
//
//   1728 mm^2 in 4 faces: 100 % covered by 1836 points in 213 s
//   it begins at C 0.000 A 0.381 rad, X 27.413 Y -15.213 Z 12.070 mm
//
// plan holds what is decided before anything is measured:
//   scans/scan_plan.h                   faces, lines and points of a scan, its time, its coverage, what is in the way
//   scans/wanted_area.h                 how much of a surface is asked for
//   readings/planning.h                 which readings of other instruments to take, and how many are enough
// Grids, lines and other given poses: abbe/instruments/measurement_plan.h.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Places on the side of a plane to which its normal points: normal . p >= offset.
struct HalfSpace {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0;  ///< mm

  bool holds(const Eigen::Vector3d& point) const { return normal.dot(point) >= offset; }
};

/// Margin to the largest angle when directions are chosen, rad: normals of a mesh are not exactly those of the part.
inline constexpr double kScanAngleMargin = kDegree;
/// Range of ScanPlanOptions::largest_angle: the margin would use up a smaller angle, and a beam along the surface sees
/// nothing.
inline constexpr double kSmallestScanAngle = 2 * kScanAngleMargin, kLargestScanAngle = 85 * kDegree;
/// Range of ScanPlanOptions::crease_angle.
inline constexpr double kSmallestCrease = kDegree, kLargestCrease = 90 * kDegree;

/// What the probe and the axes can do, and how densely the part is to be seen.
struct ScanPlanOptions {
  RigidTransform workpiece_from_part;          ///< where the part stands
  std::vector<HalfSpace> wanted;               ///< frame of the part: only what lies in all of them is scanned
  double along = 0.5, between = 0.5;           ///< mm, distance of points along a line and of lines
  double largest_turn = 10 * kDegree;          ///< rad, of the normal from point to point along a line
  double crease_angle = 30 * kDegree;          ///< rad, faces end where triangles meet at more
  double largest_angle = 28 * kDegree;         ///< rad, between the beam and the normal: n.m >= cos
  double range = 0.4;                          ///< mm, of the indication, about its middle
  double working_distance = 10;                ///< mm, from the measured point to the probe
  double probe_radius = 5, probe_length = 60;  ///< mm, a round rod behind the working distance
  double clearance = 0.5;                      ///< mm, kept between the probe and everything else
  std::optional<TriangleMesh> stage;           ///< what else turns with the workpiece, workpiece frame, mm
  double linear_speed = 10, rotary_speed = std::numbers::pi / 6;  ///< mm/s, rad/s
  double readings_per_second = 100;
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< in faces
};

/// rotary: a surface of revolution whose axis a rotary axis of the machine can be brought to, which turns it below the
/// probe; raster: the beam keeps its direction; free: the beam follows the normal.
enum class ScanPathKind { rotary, raster, free };
const char* scan_path_name(ScanPathKind kind);

/// Why a place is not measured. A beam direction has to pass, in order: line of sight, clearance of the probe, travel
/// of the axes. The direction that passes most of them counts.
enum class ScanObstacle : std::uint8_t {
  none,
  angle,             ///< seen at more than the largest angle from the normal only
  hidden,            ///< seen from nowhere: the part or the stage is in every beam
  working_distance,  ///< the probe meets part or stage, one with twice the working distance would not
  collision,         ///< the probe meets part or stage
  travel,            ///< no commands of the axes within travel
  spacing            ///< nothing is in the way: between lines, on a face smaller than their distance
};
inline constexpr std::size_t kScanObstacleCount = 7;
const char* scan_obstacle_name(ScanObstacle obstacle);

struct PlannedFace {
  ScanPathKind kind = ScanPathKind::free;
  std::string why;                                     ///< this kind of path, in words
  std::size_t turning_axis = Machine::npos;            ///< rotary: of the machine
  double axis_tilt = 0;                                ///< rad, rotary: between that axis and the face's
  double largest_angle = 0;                            ///< rad, between beam and normal at any point
  double area = 0, covered = 0;                        ///< mm^2, of what is wanted of the face
  std::array<double, kScanObstacleCount> uncovered{};  ///< mm^2, by ScanObstacle
  std::size_t lines = 0, points = 0;
  std::array<std::size_t, kScanObstacleCount> missed{};  ///< places on the lines that are not measured, by ScanObstacle
  std::size_t tilted = 0;  ///< points measured from another direction than planned, because that one was blocked

  std::size_t missed_places() const;
  double points_per_mm2() const { return area > 0 ? static_cast<double>(points) / area : 0; }
};

struct PlannedMove {
  Eigen::Vector3d point, normal, beam;  ///< mm and unit vectors, workpiece frame; beam: from the part to the probe
  std::size_t face = 0, line = 0;
  bool measures = false;  ///< else it goes around, away from the part
  bool blocked = false;   ///< one of the moves to the next line for which no clear way was found: the probe may touch
  double time = 0;        ///< s, to get here
};

/// Part of the surface for the picture of the coverage.
struct CoverageSample {
  Eigen::Vector3d point;  ///< mm, frame of the part
  std::size_t face = 0;
  ScanObstacle obstacle = ScanObstacle::none;
};

struct ScanPlan {
  std::vector<PlannedFace> faces;
  PoseList positions;              ///< commands, mm or rad
  std::vector<PlannedMove> moves;  ///< [positions]
  std::vector<CoverageSample> coverage;
  double time = 0;                ///< s
  double largest_sag = 0;         ///< mm, surface from the straight move between neighbours, indication half way
  std::size_t beyond_range = 0;   ///< moves that go around because half way the indication would leave its range
  std::size_t blocked_links = 0;  ///< ways between lines on which the probe comes too near; their moves are `blocked`

  std::size_t points() const;
  std::size_t missed_places() const;
  double area() const;  ///< mm^2, of what is wanted
  double covered_share() const;
  double uncovered(ScanObstacle obstacle) const;  ///< mm^2
};

/// Paths over all faces of a part for a displacement probe along the tool's direction.
///
/// Creases separate faces. A face whose normals lie within the largest angle of their mean is scanned as a
/// raster; one of revolution about a line to which a rotary axis of the machine can be brought, within half of the
/// largest angle, on circles about that line; all others freely. The functional point of the machine (the middle of the
/// probe's range) goes along the surface, so the axis along the beam follows it.
/// At every point the beam is along the normal (raster: along the mean normal; rotary: along the normal turned as the
/// axis of the face to that of the machine, so that this one turns alone but for what follows) or, where it or the
/// probe would meet the part or the stage or an axis its end of travel, tilted by up to the largest angle. Between
/// lines the probe draws back as far as it has to; where no way is clear the moves are there and marked.
/// @param part  closed, vertices shared, frame of the part, mm
/// @throws std::invalid_argument if an option is not above zero, or an angle out of its range
ScanPlan plan_scan(const Machine& machine, const TriangleMesh& part, const ScanPlanOptions& options);

}  // namespace abbe
