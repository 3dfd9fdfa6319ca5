#include "abbe/verify/parts/surface_average.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/geometry/bounding_box.h"
#include "abbe/geometry/even_choice.h"
#include "abbe/verify/parts/averaged_places.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Cubes of one size, and their numbers.
class Cubes {
 public:
  Cubes(const Vector3d& lower, double cell) : lower_(lower), cell_(cell) {}

  /// 21 bits of each coordinate.
  std::uint64_t key_of(const Vector3d& point) const {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      key = (key << 21U) | static_cast<std::uint64_t>(std::clamp((point[k] - lower_[k]) / cell_, 0.0, 1e6));
    }
    return key;
  }

 private:
  Vector3d lower_;
  double cell_;
};

/// Readings in each cube that has any.
std::vector<std::size_t> readings_of_cubes(const Eigen::Matrix3Xd& points, const Cubes& cubes) {
  std::vector<std::uint64_t> keys(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = cubes.key_of(points.col(static_cast<Index>(i)));
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> counts;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i] != keys[i - 1]) counts.push_back(0);
    ++counts.back();
  }
  return counts;
}

double radius_of_points(const Eigen::Matrix3Xd& points, std::size_t wanted) {
  if (points.cols() == 0) return 0;
  const Eigen::AlignedBox3d box = bounding_box(points);
  const double extent = std::max(box.sizes().norm(), 1e-9);
  const double largest = extent / 10;
  double cell = extent / std::sqrt(static_cast<double>(points.cols())) / 4;
  while (cell < largest) {
    std::vector<std::size_t> counts = readings_of_cubes(points, {box.min(), cell});
    const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
    std::nth_element(counts.begin(), middle, counts.end());
    if (*middle >= wanted) break;
    cell *= 1.4;
  }
  return std::min(cell, largest);
}

}  // namespace

double radius_of_readings(const SurfaceReadings& readings, std::size_t wanted) {
  const Index all = readings.foot.cols();
  if (all <= static_cast<Index>(kRadiusReadings)) return radius_of_points(readings.foot, wanted);
  // About a place there are fewer of a part of the readings, in proportion.
  const Eigen::Matrix3Xd some = EvenChoice(all, static_cast<Index>(kRadiusReadings)).of(readings.foot);
  return radius_of_points(some, wanted) * std::sqrt(static_cast<double>(some.cols()) / static_cast<double>(all));
}

SurfaceAverage surface_average(const SurfaceReadings& readings, const Eigen::Matrix3Xd& places,
                               const Eigen::Matrix3Xd& normals, double radius_mm, int threads) {
  return sums_of_readings(AveragedPlaces(places, normals, radius_mm), readings, threads).average();
}

}  // namespace abbe
