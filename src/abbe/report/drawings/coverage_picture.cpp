#include "abbe/report/drawings/coverage_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/report/drawings/surface_picture.h"

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
  const std::pair<Eigen::Matrix3Xd, Eigen::Matrix3Xd> triangle_places = middles_of(picture.mesh);
  const Eigen::Matrix3Xd &middle = triangle_places.first, &normal = triangle_places.second;
  const auto triangles = static_cast<std::size_t>(picture.mesh.size());
  picture.reasons = places.reasons;
  picture.reasons.emplace_back("not looked at");
  picture.coverage.assign(triangles, static_cast<std::uint8_t>(places.reasons.size()));
  const auto colour = [&](const std::vector<std::size_t>& which, const Eigen::Matrix3Xd& sides, double within) {
    Eigen::Matrix3Xd at(3, static_cast<Index>(which.size())), side(3, static_cast<Index>(which.size()));
    for (std::size_t i = 0; i < which.size(); ++i) {
      at.col(static_cast<Index>(i)) = middle.col(static_cast<Index>(which[i]));
      side.col(static_cast<Index>(i)) = sides.col(static_cast<Index>(which[i]));
    }
    std::vector<double> largest(which.size(), 0.0);
    // The share of the places of one reason is the mean of ones and zeros.
    for (std::size_t reason = 0; reason < places.reasons.size(); ++reason) {
      readings.deviation_mm.clear();
      for (const std::uint8_t said : places.reason) readings.deviation_mm.push_back(said == reason ? 1 : 0);
      const SurfaceAverage share = surface_average(readings, at, side, within, threads);
      for (std::size_t i = 0; i < which.size(); ++i) {
        if (share.mean_mm[i] <= largest[i]) continue;
        largest[i] = share.mean_mm[i];
        picture.coverage[which[i]] = static_cast<std::uint8_t>(reason);
      }
    }
  };
  std::vector<std::size_t> which(triangles);
  std::iota(which.begin(), which.end(), std::size_t{0});
  colour(which, normal, 1.5 * radius);
  if (picture.thinned_cell_mm > 0) {
    std::erase_if(which, [&](std::size_t t) { return picture.coverage[t] < places.reasons.size(); });
    colour(which, Eigen::Matrix3Xd::Zero(3, normal.cols()), std::max(1.5 * radius, picture.thinned_cell_mm));
  }
  return picture;
}

}  // namespace abbe
