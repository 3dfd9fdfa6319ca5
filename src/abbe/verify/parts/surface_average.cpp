#include "abbe/verify/parts/surface_average.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Readings sorted by the cubes of a grid.
class CubeGrid {
 public:
  CubeGrid(const Eigen::Matrix3Xd& points, double cell) : lower_(points.rowwise().minCoeff()), cell_(cell) {
    const auto n = static_cast<std::size_t>(points.cols());
    std::vector<std::uint64_t> keys(n);
    for (std::size_t i = 0; i < n; ++i) keys[i] = key(cube_of(points.col(static_cast<Index>(i))));
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), 0U);
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
    for (std::size_t i = 0; i < n; ++i) {
      if (i == 0 || keys[order_[i]] != cubes_.back()) {
        cubes_.push_back(keys[order_[i]]);
        begins_.push_back(i);
      }
    }
    begins_.push_back(n);
  }

  std::vector<std::size_t> counts() const {
    std::vector<std::size_t> result(cubes_.size());
    for (std::size_t i = 0; i < cubes_.size(); ++i) result[i] = begins_[i + 1] - begins_[i];
    return result;
  }

  /// The readings in the cube of the place and those about it, in a fixed order.
  template <class Visit>
  void near(const Vector3d& place, Visit visit) const {
    const std::array<std::int64_t, 3> cube = cube_of(place);
    for (std::int64_t x = cube[0] - 1; x <= cube[0] + 1; ++x) {
      for (std::int64_t y = cube[1] - 1; y <= cube[1] + 1; ++y) {
        // Three cubes along z lie side by side.
        const auto from = std::lower_bound(cubes_.begin(), cubes_.end(), key({x, y, cube[2] - 1}));
        const std::uint64_t last = key({x, y, cube[2] + 1});
        for (auto at = from; at != cubes_.end() && *at <= last; ++at) {
          const auto i = static_cast<std::size_t>(at - cubes_.begin());
          for (std::size_t k = begins_[i]; k < begins_[i + 1]; ++k) visit(order_[k]);
        }
      }
    }
  }

 private:
  std::array<std::int64_t, 3> cube_of(const Vector3d& point) const {
    std::array<std::int64_t, 3> cube{};
    for (int k = 0; k < 3; ++k) {
      cube[static_cast<std::size_t>(k)] =
          static_cast<std::int64_t>(std::floor(std::clamp((point[k] - lower_[k]) / cell_, -10.0, 1e6)));
    }
    return cube;
  }
  /// 21 bits each; 16 more so that neighbours below the first cube have a number too.
  static std::uint64_t key(const std::array<std::int64_t, 3>& cube) {
    std::uint64_t result = 0;
    for (const std::int64_t k : cube) result = (result << 21U) | static_cast<std::uint64_t>(k + 16);
    return result;
  }

  Vector3d lower_;
  double cell_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> cubes_;  // occupied ones, ascending
  std::vector<std::size_t> begins_;   // in order_, and its end
};

}  // namespace

double radius_of_readings(const SurfaceReadings& readings, std::size_t wanted) {
  if (readings.foot.cols() == 0) return 0;
  const double extent =
      std::max((readings.foot.rowwise().maxCoeff() - readings.foot.rowwise().minCoeff()).norm(), 1e-9);
  const double largest = extent / 10;
  double cell = extent / std::sqrt(static_cast<double>(readings.foot.cols())) / 4;
  while (cell < largest) {
    std::vector<std::size_t> counts = CubeGrid(readings.foot, cell).counts();
    const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
    std::nth_element(counts.begin(), middle, counts.end());
    if (*middle >= wanted) break;
    cell *= 1.4;
  }
  return std::min(cell, largest);
}

SurfaceAverage surface_average(const SurfaceReadings& readings, const Eigen::Matrix3Xd& places,
                               const Eigen::Matrix3Xd& normals, double radius_mm, int threads) {
  const auto m = static_cast<std::size_t>(places.cols());
  SurfaceAverage result;
  result.mean_mm.assign(m, 0.0);
  result.count.assign(m, 0);
  if (readings.foot.cols() == 0 || !(radius_mm > 0)) return result;
  const double extent = (readings.foot.rowwise().maxCoeff() - readings.foot.rowwise().minCoeff()).maxCoeff();
  const CubeGrid grid(readings.foot, std::max(radius_mm, 1e-6 * extent));
  constexpr std::size_t kBlock = 1024;
  for_each_block((m + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(m, (block + 1) * kBlock); ++i) {
      const Vector3d place = places.col(static_cast<Index>(i)), normal = normals.col(static_cast<Index>(i));
      const double towards = normal.squaredNorm() > 0 ? 0.5 : -2;
      double sum = 0;
      grid.near(place, [&](std::uint32_t k) {
        const auto column = static_cast<Index>(k);
        if ((readings.foot.col(column) - place).squaredNorm() > radius_mm * radius_mm) return;
        if (readings.normal.col(column).dot(normal) < towards) return;
        sum += readings.deviation_mm[k];
        ++result.count[i];
      });
      if (result.count[i] > 0) result.mean_mm[i] = sum / result.count[i];
    }
  });
  return result;
}

}  // namespace abbe
