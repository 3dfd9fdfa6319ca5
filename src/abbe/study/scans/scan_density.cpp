#include "abbe/study/scans/scan_density.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "abbe/geometry/even_choice.h"
#include "abbe/geometry/stopped.h"
#include "abbe/verify/parts/surface_average.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Number of all points. Those at the beginning tell how long the lines of a text are.
std::size_t points_about(const PointCloudBlocks& blocks) {
  constexpr std::size_t kFirst = 1024;
  const std::size_t end = blocks.block_end(blocks.begin(), kFirst);
  const CloudBlock first = blocks.read(blocks.begin(), end, 1);
  const auto count = static_cast<double>(first.points.cols()) + static_cast<double>(first.not_finite);
  if (count == 0) return blocks.about_points();
  const auto of_bytes = [&](std::size_t to) { return static_cast<double>(to - blocks.begin()); };
  return static_cast<std::size_t>(std::ceil(count * of_bytes(blocks.end()) / of_bytes(end)));
}

/// One of each few consecutive points.
Eigen::Matrix3Xd some_points(const PointCloudBlocks& blocks, std::size_t points, std::size_t every, int threads,
                             const std::stop_token& stop) {
  if (every <= 1) return blocks.read(blocks.begin(), blocks.end(), threads).points;
  // block_end() counts in points of the file's own estimate.
  const double of_estimate = static_cast<double>(blocks.about_points()) / static_cast<double>(points);
  const auto behind = [&](std::size_t at, std::uint64_t count) {
    const auto passed_over = static_cast<std::size_t>(static_cast<double>(count) * of_estimate);
    return at < blocks.end() && passed_over > 0 ? blocks.block_end(at, passed_over) : at;
  };
  Eigen::Matrix3Xd some(3, static_cast<Index>(points / every + 1));
  Index count = 0;
  std::uint64_t group = 0;
  for (std::size_t at = blocks.begin(); at < blocks.end(); ++group) {
    const std::uint64_t chosen = chosen_of_group(group, every);
    const std::size_t begin = behind(at, chosen);
    if (begin >= blocks.end()) break;
    const std::size_t end = blocks.block_end(begin, 1);
    const CloudBlock block = blocks.read(begin, end, 1);
    if (count + block.points.cols() > some.cols()) some.conservativeResize(3, 2 * some.cols() + block.points.cols());
    some.middleCols(count, block.points.cols()) = block.points;
    count += block.points.cols();
    at = behind(end, every - 1 - chosen);
    if (group % 1024 == 0) stop_if_asked(stop);
  }
  return some.leftCols(count);
}

}  // namespace

ScanDensity scan_density(const ScanDeviationsRequest& request, const PointCloudBlocks& blocks,
                         const ClosestPointFinder& surface, const std::stop_token& stop) {
  ScanDensity density;
  if (blocks.begin() == blocks.end()) return density;
  density.points = points_about(blocks);
  const std::size_t every = (density.points + kRadiusReadings - 1) / kRadiusReadings;
  const RigidTransform& pose = request.pose.transform;
  const Eigen::Matrix3Xd some = some_points(blocks, density.points, every, request.threads, stop);
  if (some.cols() == 0) return density;
  const Eigen::Matrix3Xd moved = (pose.rotation * some).colwise() + pose.translation;
  const std::vector<SurfacePoint> closest = surface.closest(moved, request.threads, stop);
  SurfaceReadings readings;
  readings.foot.resize(3, some.cols());
  Index count = 0;
  for (const SurfacePoint& foot : closest) {
    const bool far = request.largest_mm > 0 && !(std::abs(foot.distance) <= request.largest_mm);
    if (!foot.on_border && !far) readings.foot.col(count++) = foot.point;
  }
  readings.foot.conservativeResize(3, count);
  density.radius_mm = radius_of_readings(readings);
  // About a place there are fewer of a part of the points, in proportion.
  if (every > 1) {
    density.radius_mm *= std::sqrt(static_cast<double>(some.cols()) / static_cast<double>(density.points));
  }
  return density;
}

}  // namespace abbe
