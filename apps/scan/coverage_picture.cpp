#include "scan/coverage_picture.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "abbe/geometry/closest_point.h"
#include "scan/surface_picture.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Middles and normals of all triangles.
std::pair<Eigen::Matrix3Xd, Eigen::Matrix3Xd> middles_of(const TriangleMesh& mesh) {
  Eigen::Matrix3Xd middle(3, mesh.size()), normal(3, mesh.size());
  for (Index t = 0; t < mesh.size(); ++t) {
    const Eigen::Vector3d a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const Eigen::Vector3d twice = (b - a).cross(c - a);
    middle.col(t) = (a + b + c) / 3;
    normal.col(t) = twice.norm() > 0 ? Eigen::Vector3d(twice.normalized()) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  return {middle, normal};
}

}  // namespace

SurfacePicture coverage_picture(const TriangleMesh& part, const PlacesOfASurface& places, int threads) {
  SurfaceReadings readings;
  readings.foot = places.points;
  readings.normal.resize(3, places.points.cols());
  const std::vector<SurfacePoint> closest = ClosestPointFinder(part, threads).closest(places.points, threads);
  for (std::size_t i = 0; i < closest.size(); ++i) readings.normal.col(static_cast<Index>(i)) = closest[i].normal;
  const double radius = radius_of_readings(readings);
  SurfacePicture picture = part_picture(part, radius, threads);
  const auto [middle, normal] = middles_of(picture.mesh);
  const auto triangles = static_cast<std::size_t>(picture.mesh.size());
  picture.reasons = places.reasons;
  picture.reasons.emplace_back("not looked at");
  picture.coverage.assign(triangles, static_cast<std::uint8_t>(places.reasons.size()));
  std::vector<double> largest(triangles, 0.0);
  // The share of the places of one reason is the mean of ones and zeros.
  for (std::size_t reason = 0; reason < places.reasons.size(); ++reason) {
    readings.deviation_mm.clear();
    for (const std::uint8_t said : places.reason) readings.deviation_mm.push_back(said == reason ? 1 : 0);
    const SurfaceAverage share = surface_average(readings, middle, normal, 1.5 * radius, threads);
    for (std::size_t t = 0; t < triangles; ++t) {
      if (share.mean_mm[t] <= largest[t]) continue;
      largest[t] = share.mean_mm[t];
      picture.coverage[t] = static_cast<std::uint8_t>(reason);
    }
  }
  return picture;
}

}  // namespace abbe
