#include "abbe/instruments/triangulation.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

namespace abbe {
namespace {

/// A line of sight begins beside its own surface, so far that rounding does not hide the point behind itself.
constexpr double kBeside = 1e-6;  // mm

}  // namespace

bool seen_from(const RayTracer& surface, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
               const Eigen::Vector3d& eye, double largest_angle) {
  const Eigen::Vector3d sight = eye - point;
  const double distance = sight.norm();
  if (!(normal.dot(sight) >= std::cos(largest_angle) * distance)) return false;
  return !surface.first(point + kBeside * normal, sight / distance, 0, distance);
}

LineScanner LineScanner::published() {
  LineScanner scanner;
  scanner.height_noise = 2e-3;
  scanner.across_noise = 1e-3;
  scanner.linearity = 0.0017 * scanner.range;
  return scanner;
}

ScannedSection scan_section(const LineScanner& scanner, const RayTracer& part, const RigidTransform& part_from_scanner,
                            RandomStream& random) {
  const Eigen::Vector3d laser = part_from_scanner * scanner.laser, camera = part_from_scanner * scanner.camera;
  const RigidTransform scanner_from_part = part_from_scanner.inverse();
  const double phase = random.uniform(0, 2 * std::numbers::pi);
  ScannedSection section;
  std::vector<Eigen::Vector2d> points;
  for (int ray = 0; ray < scanner.points; ++ray) {
    const double x = scanner.width * ((ray + 0.5) / scanner.points - 0.5);
    // Drawn for every ray, so that what one of them meets does not change the noise of the others.
    const double across = scanner.across_noise * random.normal(), up = scanner.height_noise * random.normal();
    const Eigen::Vector3d towards = part_from_scanner.rotation * (Eigen::Vector3d(x, 0, 0) - scanner.laser);
    const double to_middle = towards.norm();
    const Eigen::Vector3d direction = towards / to_middle;
    const std::optional<RayHit> hit = part.first(laser, direction, 0, to_middle + scanner.range);
    const Eigen::Vector3d place = hit ? Eigen::Vector3d(laser + hit->distance * direction) : laser;
    const Eigen::Vector3d in_scanner = scanner_from_part * place;
    if (!hit || std::abs(in_scanner.z()) > scanner.range / 2) {
      ++section.missed;
    } else if (!(-hit->normal.dot(direction) >= std::cos(scanner.largest_angle))) {
      ++section.too_flat;
    } else if (!seen_from(part, place, hit->normal, camera, scanner.largest_angle)) {
      ++section.hidden;
    } else {
      const double wave = scanner.linearity * std::sin(2 * std::numbers::pi * in_scanner.z() / scanner.range + phase);
      points.emplace_back(in_scanner.x() + across, in_scanner.z() + up + wave);
    }
  }
  section.points.resize(2, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) section.points.col(static_cast<Eigen::Index>(i)) = points[i];
  return section;
}

bool AreaScanner::sees(const RayTracer& scene, const RigidTransform& scene_from_scanner, const Eigen::Vector3d& point,
                       const Eigen::Vector3d& normal) const {
  return seen_from(scene, point, normal, scene_from_scanner * projector(), largest_angle) &&
         seen_from(scene, point, normal, scene_from_scanner * camera(), largest_angle);
}

Eigen::Matrix3Xd scan_places(const AreaScanner& scanner, const RayTracer& scene,
                             const RigidTransform& scene_from_scanner, const Eigen::Matrix3Xd& places,
                             const Eigen::Matrix3Xd& normals, RandomStream& random, std::vector<Eigen::Index>* seen) {
  const RigidTransform scanner_from_scene = scene_from_scanner.inverse();
  Eigen::Matrix3Xd points(3, places.cols());
  Eigen::Index count = 0;
  if (seen != nullptr) seen->clear();
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    if (!scanner.sees(scene, scene_from_scanner, places.col(i), normals.col(i))) continue;
    points.col(count++) =
        scanner_from_scene * Eigen::Vector3d(places.col(i)) + scanner.noise * Eigen::Vector3d(x, y, z);
    if (seen != nullptr) seen->push_back(i);
  }
  points.conservativeResize(3, count);
  return points;
}

}  // namespace abbe
