#include "liu/plan.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace abbe {
namespace {

/// Closed round rod about y, appended to a mesh.
void add_rod(TriangleMesh& mesh, double radius, double low, double high) {
  constexpr std::uint32_t kAround = 72;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.cols());
  const Eigen::Index triangles = mesh.triangles.cols();
  mesh.vertices.conservativeResize(3, first + 2 * kAround + 2);
  mesh.triangles.conservativeResize(3, triangles + 4 * kAround);
  // Outside of the circle: distances to the stage are not taken for larger than they are.
  const double outer = radius / std::cos(std::numbers::pi / kAround);
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAround;
    const std::uint32_t j = (i + 1) % kAround;
    mesh.vertices.col(first + i) = Eigen::Vector3d(outer * std::sin(angle), low, outer * std::cos(angle));
    mesh.vertices.col(first + kAround + i) = Eigen::Vector3d(outer * std::sin(angle), high, outer * std::cos(angle));
    const std::uint32_t a = first + i, b = first + j, bottom = first + 2 * kAround, top = bottom + 1;
    mesh.triangles.col(triangles + 4 * i) << a, b, b + kAround;
    mesh.triangles.col(triangles + 4 * i + 1) << a, b + kAround, a + kAround;
    mesh.triangles.col(triangles + 4 * i + 2) << bottom, b, a;
    mesh.triangles.col(triangles + 4 * i + 3) << top, a + kAround, b + kAround;
  }
  mesh.vertices.col(first + 2 * kAround) = Eigen::Vector3d(0, low, 0);
  mesh.vertices.col(first + 2 * kAround + 1) = Eigen::Vector3d(0, high, 0);
}

}  // namespace

TriangleMesh liu_stage(double lowest) {
  constexpr double kTop = -36, kBottom = -46;
  TriangleMesh mesh;
  mesh.vertices.resize(3, 0);
  mesh.triangles.resize(3, 0);
  add_rod(mesh, 30, kBottom, kTop);
  if (lowest > kTop) add_rod(mesh, 2.5, kTop, lowest);
  return mesh;
}

ScanPlanOptions liu_plan_options(const LiuPart& part, const RigidTransform& workpiece_from_part) {
  ScanPlanOptions options;
  options.workpiece_from_part = workpiece_from_part;
  options.wanted = part.wanted;
  options.along = options.between = 1;
  options.clearance = 1;
  const Eigen::Matrix3Xd placed =
      (workpiece_from_part.rotation * part.mesh.vertices).colwise() + workpiece_from_part.translation;
  options.stage = liu_stage(placed.row(1).minCoeff());
  return options;
}

ScanPlan liu_plan(const Machine& machine, const LiuPart& part, const RigidTransform& workpiece_from_part) {
  return plan_scan(machine, part.mesh, liu_plan_options(part, workpiece_from_part));
}

PoseList measuring_positions(const ScanPlan& plan) {
  PoseList positions;
  positions.axis.resize(plan.positions.axis.size());
  for (std::size_t k = 0; k < plan.moves.size(); ++k) {
    if (plan.moves[k].measures) positions.append(plan.positions.pose(k));
  }
  return positions;
}

}  // namespace abbe
