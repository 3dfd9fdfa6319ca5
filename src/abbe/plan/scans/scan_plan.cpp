#include "abbe/plan/scans/scan_plan.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/surface/surface_faces.h"
#include "abbe/geometry/surface/surface_lines.h"
#include "abbe/plan/scans/scan_clearance.h"
#include "abbe/plan/scans/scan_coverage.h"
#include "abbe/plan/scans/scan_face.h"
#include "abbe/plan/scans/scan_path.h"
#include "abbe/plan/scans/scan_reach.h"

namespace abbe {
namespace {

/// Goes over the part face by face.
class Planner {
 public:
  Planner(const Machine& machine, TriangleMesh part, const ScanPlanOptions& options)
      : machine_(machine),
        options_(options),
        part_(std::move(part)),
        smooth_(part_, options.crease_angle),
        clearance_(part_, options.stage, options.working_distance, options.probe_radius + options.clearance,
                   options.probe_length),
        tracer_(part_),
        part_from_workpiece_(options.workpiece_from_part.inverse()),
        reach_(machine, clearance_, options.largest_angle),
        path_(machine, options_, clearance_, tracer_, reach_, plan_) {}

  ScanPlan run() {
    const SurfaceFaces faces = surface_faces(part_, options_.crease_angle);
    std::vector<std::vector<std::uint32_t>> triangles(faces.count());
    std::vector<bool> has_wanted(faces.count(), false);
    for (std::uint32_t i = 0; i < faces.face_of_triangle.size(); ++i) {
      triangles[faces.face_of_triangle[i]].push_back(i);
      if (!may_be_wanted(i)) continue;
      has_wanted[faces.face_of_triangle[i]] = true;
      near_.push_back(i);
    }
    plan_.faces.resize(faces.count());
    for (std::size_t face = 0; face < faces.count(); ++face) {
      go_over(face, triangles[face], scan_face(machine_, part_, triangles[face], options_.largest_angle),
              has_wanted[face]);
      if (options_.progress) options_.progress(face + 1, faces.count());
    }
    cover(faces);
    return std::move(plan_);
  }

 private:
  bool is_wanted(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d in_part = part_from_workpiece_ * point;
    return std::all_of(options_.wanted.begin(), options_.wanted.end(),
                       [&](const HalfSpace& half) { return half.holds(in_part); });
  }

  /// False if the whole triangle lies behind one of the planes.
  bool may_be_wanted(std::uint32_t triangle) const {
    std::array<Eigen::Vector3d, 3> corner;
    for (int k = 0; k < 3; ++k) {
      corner[static_cast<std::size_t>(k)] = part_from_workpiece_ * part_.corner(static_cast<Eigen::Index>(triangle), k);
    }
    return std::all_of(options_.wanted.begin(), options_.wanted.end(), [&](const HalfSpace& half) {
      return half.holds(corner[0]) || half.holds(corner[1]) || half.holds(corner[2]);
    });
  }

  void go_over(std::size_t number, std::span<const std::uint32_t> triangles, const ScanFace& shape, bool has_wanted) {
    PlannedFace& face = plan_.faces[number];
    face.kind = shape.kind;
    face.why = shape.why;
    face.turning_axis = shape.turning_axis;
    face.axis_tilt = shape.axis_tilt;
    if (!has_wanted) return;
    for_each_surface_line(part_, smooth_, triangles, shape.planes, options_.along, options_.between,
                          options_.largest_turn, [&](const SurfaceLine& line) { follow(number, line, shape); });
  }

  void follow(std::size_t number, const SurfaceLine& line, const ScanFace& shape) {
    PlannedFace& face = plan_.faces[number];
    const Eigen::Index count = line.points.cols();
    // To and fro: begin at the end that is nearer to where the last line ended.
    const bool turned = path_.has_begun() && (line.points.col(count - 1) - path_.last_point()).norm() <
                                                 (line.points.col(0) - path_.last_point()).norm();
    bool continues = false, is_empty = true;
    std::vector<double> start = path_.last();
    // A new line begins with the axes that stand still where they are to stand.
    for (std::size_t i = 0; shape.kind == ScanPathKind::rotary && i < shape.turning_axis; ++i) {
      if (machine_.axes[i].kind == AxisKind::rotary) start[i] = near_turn(i, shape.turning_positions[i], start[i]);
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Index column = turned ? count - 1 - k : k;
      PlannedMove move;
      move.point = line.points.col(column);
      if (!is_wanted(move.point)) {
        continues = false;
        continue;
      }
      move.normal = shape.exact_normal(move.point, line.normals.col(column));
      move.face = number;
      move.line = face.lines;
      is_empty = false;
      const ScanReach reach = reach_.find(move.point, move.normal, shape.beam(move.normal),
                                          continues ? path_.last_beam() : shape.beam(move.normal), start);
      places_.push_back({move.point, static_cast<std::uint32_t>(number), reach.obstacle});
      if (reach.obstacle != ScanObstacle::none) {
        ++face.missed[static_cast<std::size_t>(reach.obstacle)];
        continues = false;
        continue;
      }
      move.beam = reach.beam;
      path_.measure(move, reach.positions, continues);
      start = path_.last();
      continues = true;
      ++face.points;
      face.tilted += reach.tilted ? 1U : 0U;
      face.largest_angle = std::max(face.largest_angle, angle_between(move.normal, move.beam));
    }
    face.lines += is_empty ? 0U : 1U;
  }

  /// The command for an angle nearest to where the axis is, if its travel allows for several turns.
  double near_turn(std::size_t axis, double angle, double at) const {
    const double command = angle + 2 * std::numbers::pi * std::round((at - angle) / (2 * std::numbers::pi));
    const Axis& a = machine_.axes[axis];
    return a.endless || (command >= a.travel_min && command <= a.travel_max) ? command : angle;
  }

  void cover(const SurfaceFaces& faces) {
    const double radius = 0.75 * std::hypot(options_.along, options_.between);
    const auto wanted = [&](const Eigen::Vector3d& point) { return is_wanted(point); };
    for (const CoveredPlace& place : covered_places(part_, faces.face_of_triangle, places_, near_, wanted, radius)) {
      const std::size_t number = faces.face_of_triangle[place.triangle];
      PlannedFace& face = plan_.faces[number];
      face.area += place.area;
      if (place.obstacle == ScanObstacle::none) {
        face.covered += place.area;
      } else {
        face.uncovered[static_cast<std::size_t>(place.obstacle)] += place.area;
      }
      plan_.coverage.push_back({part_from_workpiece_ * place.point, number, place.obstacle});
    }
  }

  const Machine& machine_;
  const ScanPlanOptions& options_;
  TriangleMesh part_;  // workpiece frame
  SmoothSurface smooth_;
  ScanClearance clearance_;
  RayTracer tracer_;
  RigidTransform part_from_workpiece_;
  ScanPlan plan_;
  ScanReachFinder reach_;
  ScanPathBuilder path_;
  std::vector<ScannedPlace> places_;  // workpiece frame
  std::vector<std::uint32_t> near_;   // triangles of which something may be wanted
};

}  // namespace

ScanPlan plan_scan(const Machine& machine, const TriangleMesh& part, const ScanPlanOptions& options) {
  for (const double value : {options.along, options.between, options.largest_turn, options.range,
                             options.working_distance, options.probe_radius, options.probe_length, options.clearance,
                             options.linear_speed, options.rotary_speed, options.readings_per_second}) {
    if (!(value > 0)) throw std::invalid_argument("an option of the scan is not above zero");
  }
  constexpr double kRounding = 1e-9;  // rad, of limits that a user gives in degrees
  const auto check = [](const char* name, double angle, double low, double high) {
    if (angle >= low - kRounding && angle <= high + kRounding) return;
    throw std::invalid_argument(fmt::format("{} of the scan: {:.6g} degrees, not from {:.6g} to {:.6g} degrees", name,
                                            angle / kDegree, low / kDegree, high / kDegree));
  };
  check("largest angle", options.largest_angle, kSmallestScanAngle, kLargestScanAngle);
  check("crease angle", options.crease_angle, kSmallestCrease, kLargestCrease);
  TriangleMesh placed = part;
  placed.vertices =
      ((options.workpiece_from_part.rotation * part.vertices).colwise() + options.workpiece_from_part.translation)
          .eval();
  return Planner(machine, std::move(placed), options).run();
}

}  // namespace abbe
