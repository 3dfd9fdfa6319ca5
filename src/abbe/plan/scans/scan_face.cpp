#include "abbe/plan/scans/scan_face.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/fits/revolution_axis.h"
#include "abbe/geometry/rotation.h"
#include "abbe/plan/scans/turning_axis.h"

namespace abbe {
namespace {

constexpr double kRevolutionTolerance = 0.02;  // mm, of a normal from the axis that it should meet

/// Area-weighted middle of a face, its mean normal, and how it spreads.
struct FaceExtent {
  double area = 0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), normal_sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  std::vector<Eigen::Vector3d> normals;
};

FaceExtent extent_of(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
  FaceExtent extent;
  std::vector<std::pair<double, Eigen::Vector3d>> centres;
  for (const std::uint32_t triangle : triangles) {
    const auto column = static_cast<Eigen::Index>(triangle);
    const Eigen::Vector3d a = mesh.corner(column, 0), b = mesh.corner(column, 1), c = mesh.corner(column, 2);
    const Eigen::Vector3d twice = (b - a).cross(c - a);
    const double weight = twice.norm();
    if (!(weight > 0)) continue;
    extent.normal_sum += twice;
    extent.area += weight;
    extent.middle += weight * (a + b + c) / 3;
    extent.normals.push_back(twice / weight);
    centres.emplace_back(weight, (a + b + c) / 3);
  }
  if (extent.area > 0) extent.middle /= extent.area;
  for (const auto& [weight, centre] : centres) {
    extent.spread += weight * (centre - extent.middle) * (centre - extent.middle).transpose();
  }
  return extent;
}

std::string degrees(double angle) { return fmt::format("{:.1f} deg", angle / kDegree); }

std::string components(const Eigen::Vector3d& v) {
  const auto plain = [](double x) { return std::abs(x) < 5e-4 ? 0.0 : x; };
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", plain(v.x()), plain(v.y()), plain(v.z()));
}

bool try_raster(const FaceExtent& extent, double largest_angle, ScanFace& face) {
  if (!(extent.normal_sum.norm() > 1e-6 * extent.area)) return false;
  face.mean_normal = extent.normal_sum.normalized();
  double least_cosine = 1;
  for (const Eigen::Vector3d& normal : extent.normals) {
    least_cosine = std::min(least_cosine, normal.dot(face.mean_normal));
  }
  if (!(least_cosine >= std::cos(largest_angle - kScanAngleMargin))) return false;
  face.kind = ScanPathKind::raster;
  const double widest = std::acos(std::min(1.0, least_cosine));
  face.why = widest < 1e-3 ? "flat" : "normals within " + degrees(widest) + " of their mean";
  // Lines along the longer side: planes across the shorter one.
  const Eigen::Vector3d first = face.mean_normal.unitOrthogonal(), second = face.mean_normal.cross(first);
  Eigen::Matrix<double, 3, 2> sides;
  sides << first, second;
  const Eigen::Matrix2d in_plane = sides.transpose() * extent.spread * sides;
  const double angle = 0.5 * std::atan2(2 * in_plane(0, 1), in_plane(0, 0) - in_plane(1, 1));
  face.planes = -std::sin(angle) * first + std::cos(angle) * second;
  return true;
}

void try_rotary(const Machine& machine, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                double largest_angle, ScanFace& face) {
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind != AxisKind::rotary) continue;
    directions.push_back(axis_direction_in_workpiece(machine, i, std::vector<double>(machine.axes.size(), 0.0)));
  }
  if (directions.empty()) {
    face.why = "the machine has no rotary axis";
    return;
  }
  const double largest_tilt = 0.5 * largest_angle - kScanAngleMargin;
  std::optional<TurningAxis> nearest;
  RevolutionAxis found{};
  for (const RevolutionAxis& axis : revolution_axes(mesh, triangles, directions)) {
    if (revolution_deviation(mesh, triangles, axis) > kRevolutionTolerance) continue;
    std::optional<TurningAxis> turning = turning_axis(machine, axis.direction);
    if (!turning || (nearest && nearest->tilt <= turning->tilt)) continue;
    nearest = std::move(turning);
    found = axis;
  }
  if (!nearest) {
    face.why = "not a surface of revolution";
    return;
  }
  face.is_revolution = true;
  face.planes = found.direction;
  face.axis_point = found.point;
  const std::string& name = machine.axes[nearest->axis].name;
  if (nearest->tilt > largest_tilt) {
    face.why = fmt::format("of revolution about {}, no nearer to a rotary axis than {} ({})",
                           components(found.direction), degrees(nearest->tilt), name);
    return;
  }
  face.kind = ScanPathKind::rotary;
  face.turning_axis = nearest->axis;
  face.axis_tilt = nearest->tilt;
  face.turning_positions = nearest->positions;
  face.beam_turn = rotation_between(found.direction, nearest->direction);
  face.why = "of revolution about " + components(found.direction) + ": " + name + " turns";
  for (std::size_t i = 0; i < nearest->axis; ++i) {
    if (machine.axes[i].kind != AxisKind::rotary) continue;
    face.why += fmt::format(", {} stands at {:.1f} deg", machine.axes[i].name, nearest->positions[i] / kDegree + 0.0);
  }
  if (face.axis_tilt > 1e-4) face.why += ", " + degrees(face.axis_tilt) + " beside it";
}

}  // namespace

Eigen::Vector3d ScanFace::beam(const Eigen::Vector3d& normal) const {
  switch (kind) {
    case ScanPathKind::raster:
      return mean_normal;
    case ScanPathKind::rotary:
      return (beam_turn * normal).normalized();
    case ScanPathKind::free:
      break;
  }
  return normal;
}

Eigen::Vector3d ScanFace::exact_normal(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  if (!is_revolution) return normal;
  const Eigen::Vector3d tangent = planes.cross(point - axis_point);
  if (!(tangent.norm() > 1e-6)) return normal;
  const Eigen::Vector3d along = tangent.normalized(), in_plane = normal - normal.dot(along) * along;
  return in_plane.norm() > 0.5 ? Eigen::Vector3d(in_plane.normalized()) : normal;
}

ScanFace scan_face(const Machine& machine, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                   double largest_angle) {
  ScanFace face;
  const FaceExtent extent = extent_of(mesh, triangles);
  if (!(extent.area > 0)) {
    face.why = "no area";
    return face;
  }
  if (try_raster(extent, largest_angle, face)) return face;
  // Lines across the longest extent, or across the innermost rotary axis.
  const SymmetricEigen<3> solver(extent.spread);
  face.planes = solver.eigenvectors().col(2);
  if (!machine.axes.empty() && machine.axes[0].kind == AxisKind::rotary) {
    face.planes = axis_direction_in_workpiece(machine, 0, std::vector<double>(machine.axes.size(), 0.0));
  }
  try_rotary(machine, mesh, triangles, largest_angle, face);
  return face;
}

}  // namespace abbe
