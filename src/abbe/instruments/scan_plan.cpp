#include "abbe/instruments/scan_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "abbe/geometry/surface_faces.h"
#include "abbe/geometry/surface_lines.h"
#include "abbe/instruments/scan_clearance.h"
#include "abbe/instruments/scan_coverage.h"
#include "abbe/machine/inverse_kinematics.h"

namespace abbe {
namespace {

constexpr double kAngleMargin = 1 * std::numbers::pi / 180;
constexpr double kRevolutionTolerance = 0.02;  // mm, of a normal from the axis that it should meet

/// The rotary axis next to the workpiece, workpiece frame.
struct TurningAxis {
  Eigen::Vector3d point, direction;
};

std::optional<TurningAxis> turning_axis(const Machine& machine) {
  if (machine.axes.empty() || machine.axes[0].side != ChainSide::workpiece) return std::nullopt;
  const Axis& axis = machine.axes[0];
  if (axis.kind != AxisKind::rotary) return std::nullopt;
  const RigidTransform workpiece_from_bed = machine.bed_from_workpiece.inverse();
  return TurningAxis{workpiece_from_bed * axis.point, workpiece_from_bed.rotation * axis.direction};
}

/// What decides how a face is scanned.
struct FaceShape {
  ScanPathKind kind = ScanPathKind::free;
  Eigen::Vector3d mean_normal = Eigen::Vector3d::UnitZ(), planes = Eigen::Vector3d::UnitZ();
};

FaceShape shape_of(const TriangleMesh& mesh, const SmoothSurface& smooth, std::span<const std::uint32_t> triangles,
                   const std::optional<TurningAxis>& axis, double largest_angle) {
  FaceShape shape;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), middle = Eigen::Vector3d::Zero();
  double area = 0;
  std::vector<Eigen::Vector3d> normals, smooth_normals, centres;
  for (const std::uint32_t triangle : triangles) {
    const auto column = static_cast<Eigen::Index>(triangle);
    const Eigen::Vector3d a = mesh.corner(column, 0), b = mesh.corner(column, 1), c = mesh.corner(column, 2);
    const Eigen::Vector3d twice = (b - a).cross(c - a);
    if (!(twice.norm() > 0)) continue;
    sum += twice;
    area += twice.norm();
    middle += twice.norm() * (a + b + c) / 3;
    normals.push_back(twice.normalized());
    centres.emplace_back((a + b + c) / 3);
    smooth_normals.push_back(smooth.normal(triangle, centres.back()));
  }
  if (normals.empty()) return shape;
  middle /= area;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& centre : centres) spread += (centre - middle) * (centre - middle).transpose();
  double least_cosine = -1;
  if (sum.norm() > 1e-6 * area) {
    shape.mean_normal = sum.normalized();
    least_cosine = 1;
    for (const Eigen::Vector3d& normal : normals) least_cosine = std::min(least_cosine, normal.dot(shape.mean_normal));
  }
  if (least_cosine >= std::cos(largest_angle - kAngleMargin)) {
    shape.kind = ScanPathKind::raster;
    // Lines along the longer side: planes across the shorter one.
    const Eigen::Vector3d first = shape.mean_normal.unitOrthogonal(), second = shape.mean_normal.cross(first);
    const Eigen::Matrix2d in_plane = (Eigen::Matrix<double, 3, 2>() << first, second).finished().transpose() * spread *
                                     (Eigen::Matrix<double, 3, 2>() << first, second).finished();
    const double angle = 0.5 * std::atan2(2 * in_plane(0, 1), in_plane(0, 0) - in_plane(1, 1));
    shape.planes = -std::sin(angle) * first + std::cos(angle) * second;
    return shape;
  }
  if (!axis) {
    // Across the longest extent, found by repeated products.
    Eigen::Vector3d longest(1, 0.7, 0.4);
    for (int i = 0; i < 60; ++i) longest = (spread * longest + 1e-12 * longest).normalized();
    shape.planes = longest;
    return shape;
  }
  shape.planes = axis->direction;
  double farthest = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    // Strips of a round face stand beside the axis, the surface for which they stand does not.
    const Eigen::Vector3d across = smooth_normals[i].cross(axis->direction);
    if (across.norm() < 0.05) continue;  // nearly along the axis
    farthest = std::max(farthest, std::abs(across.normalized().dot(centres[i] - axis->point)));
  }
  if (farthest < kRevolutionTolerance) shape.kind = ScanPathKind::rotary;
  return shape;
}

/// Builds the plan step by step: what is measured, and the ways between.
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
        inverse_(machine),
        last_(machine.axes.size(), 0.0) {
    plan_.positions.axis.resize(machine.axes.size());
  }

  ScanPlan run() {
    const SurfaceFaces faces = surface_faces(part_, options_.crease_angle);
    const std::optional<TurningAxis> axis = turning_axis(machine_);
    std::vector<std::vector<std::uint32_t>> triangles(faces.count());
    for (std::uint32_t i = 0; i < faces.face_of_triangle.size(); ++i) {
      triangles[faces.face_of_triangle[i]].push_back(i);
    }
    plan_.faces.resize(faces.count());
    for (std::size_t face = 0; face < faces.count(); ++face) {
      plan_.faces[face].area = faces.area[face];
      scan_face(face, triangles[face], shape_of(part_, smooth_, triangles[face], axis, options_.largest_angle));
      if (options_.progress) options_.progress(face + 1, faces.count());
    }
    cover(faces);
    return std::move(plan_);
  }

 private:
  void scan_face(std::size_t number, std::span<const std::uint32_t> triangles, const FaceShape& shape) {
    PlannedFace& face = plan_.faces[number];
    face.kind = shape.kind;
    std::vector<SurfaceLine> lines =
        surface_lines(part_, smooth_, triangles, shape.planes, options_.along, options_.between);
    face.lines = lines.size();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const SurfaceLine& line = lines[i];
      const Eigen::Index count = line.points.cols();
      // To and fro: begin at the end that is nearer to where the last line ended.
      const bool turned =
          measured_ && (line.points.col(count - 1) - last_point_).norm() < (line.points.col(0) - last_point_).norm();
      bool linked = false;
      for (Eigen::Index k = 0; k < count; ++k) {
        const Eigen::Index column = turned ? count - 1 - k : k;
        PlannedMove move;
        move.point = line.points.col(column);
        move.normal = line.normals.col(column);
        move.face = number;
        move.line = i;
        std::vector<double> positions;
        if (!reach(shape, face, move, positions)) {
          linked = false;
          continue;
        }
        if (!linked || turns_far(positions)) {
          link(move);
        } else {
          check_range(positions);
        }
        measure(move, positions);
        linked = true;
        ++face.points;
      }
    }
  }

  /// Finds the beam and the commands for a point, or counts why there are none.
  bool reach(const FaceShape& shape, PlannedFace& face, PlannedMove& move, std::vector<double>& positions) {
    const Eigen::Vector3d first = shape.kind == ScanPathKind::raster ? shape.mean_normal : move.normal;
    enum class Obstacle { none, hidden, collision, travel };
    const auto attempt = [&](const Eigen::Vector3d& beam) {
      const ScanClearance::Verdict verdict = clearance_.measuring(move.point, beam);
      if (verdict == ScanClearance::Verdict::beam_hidden) return Obstacle::hidden;
      if (verdict == ScanClearance::Verdict::probe_too_near) return Obstacle::collision;
      if (!commands(move.point, beam, positions)) return Obstacle::travel;
      move.beam = beam;
      return Obstacle::none;
    };
    const Obstacle obstacle = attempt(first);
    if (obstacle == Obstacle::none) return true;
    const Eigen::Vector3d u = move.normal.unitOrthogonal(), v = move.normal.cross(u);
    for (const double share : {0.5, 1.0}) {
      const double tilt = share * (options_.largest_angle - kAngleMargin);
      for (int k = 0; k < 12; ++k) {
        const double azimuth = k * std::numbers::pi / 6;
        const Eigen::Vector3d beam =
            std::cos(tilt) * move.normal + std::sin(tilt) * (std::cos(azimuth) * u + std::sin(azimuth) * v);
        if (attempt(beam) != Obstacle::none) continue;
        ++face.tilted;
        return true;
      }
    }
    face.hidden += obstacle == Obstacle::hidden ? 1U : 0U;
    face.collision += obstacle == Obstacle::collision ? 1U : 0U;
    face.travel += obstacle == Obstacle::travel ? 1U : 0U;
    return false;
  }

  bool commands(const Eigen::Vector3d& point, const Eigen::Vector3d& beam, std::vector<double>& positions) {
    inverse_.solve(PoseTarget::at(point, beam), last_.data(), result_);
    if (result_.status != InverseStatus::solved || !result_.solutions.front().within_travel) return false;
    const auto& position = result_.solutions.front().position;
    positions.assign(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(last_.size()));
    return true;
  }

  /// More than a point's step: the straight way could lead through the part.
  bool turns_far(const std::vector<double>& positions) const {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double limit = machine_.axes[i].kind == AxisKind::rotary ? 0.35 : 10 * options_.along;
      if (std::abs(positions[i] - last_[i]) > limit) return true;
    }
    return false;
  }

  /// Half way between neighbours: how far is the surface from where the middle of the range is?
  void check_range(const std::vector<double>& positions) {
    std::vector<double> half(positions.size());
    for (std::size_t i = 0; i < half.size(); ++i) half[i] = 0.5 * (positions[i] + last_[i]);
    const RigidTransform pose = nominal_workpiece_from_tool(machine_, half);
    const Eigen::Vector3d along = -(pose.rotation * machine_.tool_direction);
    const auto hit = tracer_.first(pose.translation, along, -options_.working_distance, options_.working_distance);
    const double sag = hit ? std::abs(hit->distance) : std::numeric_limits<double>::infinity();
    if (sag > 0.5 * options_.range) {
      ++plan_.beyond_range;
    } else {
      plan_.largest_sag = std::max(plan_.largest_sag, sag);
    }
  }

  /// Back along the beam, over, and down again; farther back until nothing is in the way.
  void link(const PlannedMove& to) {
    if (!measured_) return;
    std::vector<double> up, over;
    bool done = false;
    for (double back = 2 * options_.clearance; back <= 256 * options_.clearance && !done; back *= 2) {
      const std::vector<double> start = last_;
      const bool in_travel = commands(last_point_ + back * last_beam_, last_beam_, up);
      last_ = in_travel ? up : start;
      done = in_travel && commands(to.point + back * to.beam, to.beam, over) && way_is_clear(up, over);
      last_ = start;
    }
    if (!done) ++plan_.blocked_links;
    if (up.empty() || over.empty()) return;
    PlannedMove move = to;
    move.beam = last_beam_;
    move.point = last_point_;
    step(move, up);
    move = to;
    step(move, over);
  }

  bool way_is_clear(const std::vector<double>& from, const std::vector<double>& to) const {
    double turn = 0, length = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      double& largest = machine_.axes[i].kind == AxisKind::rotary ? turn : length;
      largest = std::max(largest, std::abs(to[i] - from[i]));
    }
    const int steps = 1 + static_cast<int>(std::ceil(turn / 0.1 + length / std::max(1.0, options_.probe_radius)));
    std::vector<double> at(from.size());
    for (int k = 0; k <= std::min(steps, 2000); ++k) {
      const double share = static_cast<double>(k) / std::min(steps, 2000);
      for (std::size_t i = 0; i < at.size(); ++i) at[i] = from[i] + share * (to[i] - from[i]);
      const RigidTransform pose = nominal_workpiece_from_tool(machine_, at);
      if (!clearance_.passing(pose.translation, pose.rotation * machine_.tool_direction)) return false;
    }
    return true;
  }

  void measure(PlannedMove& move, const std::vector<double>& positions) {
    move.measures = true;
    step(move, positions);
    last_point_ = move.point;
    last_beam_ = move.beam;
    measured_ = true;
  }

  void step(PlannedMove& move, const std::vector<double>& positions) {
    double time = move.measures ? 1 / options_.readings_per_second : 0;
    for (std::size_t i = 0; i < positions.size() && !plan_.moves.empty(); ++i) {
      const double speed = machine_.axes[i].kind == AxisKind::rotary ? options_.rotary_speed : options_.linear_speed;
      time = std::max(time, std::abs(positions[i] - last_[i]) / speed);
    }
    move.time = time;
    plan_.time += time;
    plan_.positions.append(positions);
    plan_.moves.push_back(move);
    last_ = positions;
  }

  void cover(const SurfaceFaces& faces) {
    std::vector<MeasuredPlace> measured;
    for (const PlannedMove& move : plan_.moves) {
      if (move.measures) measured.push_back({move.point, static_cast<std::uint32_t>(move.face)});
    }
    const double radius = 0.75 * std::hypot(options_.along, options_.between);
    const RigidTransform part_from_workpiece = options_.workpiece_from_part.inverse();
    for (const CoveredPlace& place : covered_places(part_, faces.face_of_triangle, measured, radius)) {
      const std::size_t face = faces.face_of_triangle[place.triangle];
      if (place.covered) plan_.faces[face].covered += place.area;
      plan_.coverage.push_back({part_from_workpiece * place.point, face, place.covered});
    }
  }

  const Machine& machine_;
  const ScanPlanOptions& options_;
  TriangleMesh part_;  // workpiece frame
  SmoothSurface smooth_;
  ScanClearance clearance_;
  RayTracer tracer_;
  InverseKinematics inverse_;
  InverseResult result_;
  std::vector<double> last_;
  Eigen::Vector3d last_point_ = Eigen::Vector3d::Zero(), last_beam_ = Eigen::Vector3d::UnitZ();
  bool measured_ = false;
  ScanPlan plan_;
};

}  // namespace

const char* scan_path_name(ScanPathKind kind) {
  switch (kind) {
    case ScanPathKind::rotary:
      return "rotary";
    case ScanPathKind::raster:
      return "raster";
    case ScanPathKind::free:
      break;
  }
  return "free";
}

double ScanPlan::covered_share() const {
  double area = 0, covered = 0;
  for (const PlannedFace& face : faces) {
    area += face.area;
    covered += face.covered;
  }
  return area > 0 ? covered / area : 0;
}

ScanPlan plan_scan(const Machine& machine, const TriangleMesh& part, const ScanPlanOptions& options) {
  for (const double value : {options.along, options.between, options.range, options.working_distance,
                             options.probe_radius, options.probe_length, options.clearance, options.linear_speed,
                             options.rotary_speed, options.readings_per_second}) {
    if (!(value > 0)) throw std::invalid_argument("an option of the scan is not above zero");
  }
  TriangleMesh placed = part;
  placed.vertices =
      ((options.workpiece_from_part.rotation * part.vertices).colwise() + options.workpiece_from_part.translation)
          .eval();
  return Planner(machine, std::move(placed), options).run();
}

}  // namespace abbe
