#include "abbe/verify/parts/surface_average.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "abbe/geometry/bounding_box.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Sorts by keys, and keeps the order of equal ones: by some bits at a time, of those in which keys differ.
template <class Entry, class KeyOf>
void sort_by_bits(std::vector<Entry>& entries, const KeyOf& key_of) {
  constexpr int kBits = 11;
  constexpr std::uint64_t kDigits = std::uint64_t{1} << kBits;
  std::uint64_t differing = 0;
  for (const Entry& entry : entries) differing |= key_of(entry) ^ key_of(entries.front());
  std::vector<Entry> sorted(entries.size());
  for (int shift = 0; shift < 64 && differing >> shift != 0; shift += kBits) {
    shift += std::countr_zero(differing >> shift);
    std::array<std::size_t, kDigits + 1> begin{};
    for (const Entry& entry : entries) ++begin[(key_of(entry) >> shift & (kDigits - 1)) + 1];
    for (std::size_t digit = 0; digit < kDigits; ++digit) begin[digit + 1] += begin[digit];
    for (const Entry& entry : entries) sorted[begin[key_of(entry) >> shift & (kDigits - 1)]++] = entry;
    entries.swap(sorted);
  }
}

/// Cubes of one size, and their numbers.
class Cubes {
 public:
  Cubes(const Vector3d& lower, double cell) : lower_(lower), cell_(cell) {}

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
  std::uint64_t key_of(const Vector3d& point) const { return key(cube_of(point)); }

 private:
  Vector3d lower_;
  double cell_;
};

/// Readings in each cube that has any.
std::vector<std::size_t> readings_of_cubes(const Eigen::Matrix3Xd& points, const Cubes& cubes) {
  std::vector<std::uint64_t> keys(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = cubes.key_of(points.col(static_cast<Index>(i)));
  sort_by_bits(keys, [](std::uint64_t key) { return key; });
  std::vector<std::size_t> counts;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i] != keys[i - 1]) counts.push_back(0);
    ++counts.back();
  }
  return counts;
}

/// Readings sorted by the cubes of a grid.
class CubeGrid {
 public:
  CubeGrid(const Eigen::Matrix3Xd& points, const Cubes& cubes) : grid_(cubes) {
    struct Entry {
      std::uint64_t key = 0;
      std::uint32_t reading = 0;
    };
    const auto n = static_cast<std::size_t>(points.cols());
    std::vector<Entry> entries(n);
    for (std::size_t i = 0; i < n; ++i) {
      entries[i] = {grid_.key_of(points.col(static_cast<Index>(i))), static_cast<std::uint32_t>(i)};
    }
    sort_by_bits(entries, [](const Entry& entry) { return entry.key; });
    order_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      order_.push_back(entries[i].reading);
      if (i > 0 && entries[i].key == cubes_.back()) continue;
      cubes_.push_back(entries[i].key);
      begins_.push_back(i);
    }
    begins_.push_back(n);
  }

  /// The readings in the cube of the place and those about it, in a fixed order.
  template <class Visit>
  void near(const Vector3d& place, Visit visit) const {
    const std::array<std::int64_t, 3> cube = grid_.cube_of(place);
    for (std::int64_t x = cube[0] - 1; x <= cube[0] + 1; ++x) {
      for (std::int64_t y = cube[1] - 1; y <= cube[1] + 1; ++y) {
        // Three cubes along z lie side by side.
        const auto from = std::lower_bound(cubes_.begin(), cubes_.end(), Cubes::key({x, y, cube[2] - 1}));
        const std::uint64_t last = Cubes::key({x, y, cube[2] + 1});
        for (auto at = from; at != cubes_.end() && *at <= last; ++at) {
          const auto i = static_cast<std::size_t>(at - cubes_.begin());
          for (std::size_t k = begins_[i]; k < begins_[i + 1]; ++k) visit(order_[k]);
        }
      }
    }
  }

 private:
  Cubes grid_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> cubes_;  // occupied ones, ascending
  std::vector<std::size_t> begins_;   // in order_, and its end
};

}  // namespace

double radius_of_readings(const SurfaceReadings& readings, std::size_t wanted) {
  if (readings.foot.cols() == 0) return 0;
  const Eigen::AlignedBox3d box = bounding_box(readings.foot);
  const double extent = std::max(box.sizes().norm(), 1e-9);
  const double largest = extent / 10;
  double cell = extent / std::sqrt(static_cast<double>(readings.foot.cols())) / 4;
  while (cell < largest) {
    std::vector<std::size_t> counts = readings_of_cubes(readings.foot, {box.min(), cell});
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
  const Eigen::AlignedBox3d box = bounding_box(readings.foot);
  const CubeGrid grid(readings.foot, {box.min(), std::max(radius_mm, 1e-6 * box.sizes().maxCoeff())});
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
