#include "abbe/geometry/registration/triple_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr std::size_t kTriplesDrawn = 20000;
constexpr double kFlattest = 0.25;  ///< least height of a triple, of the extent of the scan
constexpr double kTolerance = 0.5;  ///< of the spacing of the points of the part: sides that differ less agree

/// Axes along a side of a triangle and, across it, towards its third corner.
Matrix3d axes_of_triangle(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  Matrix3d axes;
  axes.col(0) = (q - p).normalized();
  const Vector3d towards = r - p;
  axes.col(1) = (towards - towards.dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

/// Least height of a triangle.
double least_height(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  const double longest = std::max({(q - p).norm(), (r - p).norm(), (r - q).norm()});
  return longest > 0 ? (q - p).cross(r - p).norm() / longest : 0;
}

/// The points of the part, each with the others in the order of their distance.
class PartDistances {
 public:
  explicit PartDistances(const Matrix3Xd& points) : count_(static_cast<std::size_t>(points.cols())) {
    between_.resize(count_ * count_);
    others_.resize(count_ * count_);
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t j = 0; j < count_; ++j) {
        const float d = static_cast<float>(
            (points.col(static_cast<Eigen::Index>(i)) - points.col(static_cast<Eigen::Index>(j))).norm());
        between_[i * count_ + j] = d;
        others_[i * count_ + j] = {d, static_cast<std::uint32_t>(j)};
      }
      const auto first = others_.begin() + static_cast<std::ptrdiff_t>(i * count_);
      std::sort(first, first + static_cast<std::ptrdiff_t>(count_));
      // Points at random have the next one at half the spacing of a grid with as many.
      spacing_ += 2 * static_cast<double>(others_[i * count_ + 1].first) / static_cast<double>(count_);
    }
  }

  std::size_t count() const { return count_; }
  double spacing() const { return spacing_; }
  float between(std::size_t i, std::size_t j) const { return between_[i * count_ + j]; }

  /// Calls visit(j) for the points at this distance from point i.
  template <class Visit>
  void at_distance(std::size_t i, float from, float to, const Visit& visit) const {
    const auto first = others_.begin() + static_cast<std::ptrdiff_t>(i * count_);
    const auto end = first + static_cast<std::ptrdiff_t>(count_);
    for (auto at = std::lower_bound(first, end, std::pair{from, std::uint32_t{0}}); at != end && at->first <= to;
         ++at) {
      visit(at->second);
    }
  }

 private:
  std::size_t count_ = 0;
  double spacing_ = 0;
  std::vector<float> between_;
  std::vector<std::pair<float, std::uint32_t>> others_;
};

void try_triple(const std::array<Vector3d, 3>& corners, const Matrix3Xd& part, const PartDistances& distances,
                PoseCandidates* best) {
  const auto& [p, q, r] = corners;
  const Matrix3d scan_axes = axes_of_triangle(p, q, r);
  const Vector3d middle = (p + q + r) / 3;
  const float tolerance = static_cast<float>(kTolerance * distances.spacing());
  const float pq = static_cast<float>((q - p).norm()), pr = static_cast<float>((r - p).norm()),
              qr = static_cast<float>((r - q).norm());
  std::vector<std::uint32_t> thirds;
  for (std::size_t i = 0; i < distances.count(); ++i) {
    thirds.clear();
    distances.at_distance(i, pr - tolerance, pr + tolerance, [&](std::uint32_t k) { thirds.push_back(k); });
    if (thirds.empty()) continue;
    distances.at_distance(i, pq - tolerance, pq + tolerance, [&](std::uint32_t j) {
      for (const std::uint32_t k : thirds) {
        if (std::abs(distances.between(j, k) - qr) > tolerance) continue;
        const Vector3d a = part.col(static_cast<Eigen::Index>(i)), b = part.col(j), c = part.col(k);
        RigidTransform pose;
        pose.rotation = axes_of_triangle(a, b, c) * scan_axes.transpose();
        pose.translation = (a + b + c) / 3 - pose.rotation * middle;
        best->add(pose);
      }
    });
  }
}

}  // namespace

std::vector<PoseCandidate> search_triples(const Matrix3Xd& part, const Matrix3Xd& scan, const DistanceGrid& grid,
                                          const TripleSearchOptions& options) {
  if (part.cols() < 3 || scan.cols() < 3) return {};
  std::mt19937_64 generator(options.seed);
  const double diameter = (part.rowwise().maxCoeff() - part.rowwise().minCoeff()).norm();
  PoseCandidates best(grid, scan, options.reach_mm, diameter, options.candidates, generator);
  const PartDistances distances(part);
  const Vector3d middle = scan.rowwise().mean();
  const double extent =
      std::min(diameter, 2 * std::sqrt((scan.colwise() - middle).squaredNorm() / static_cast<double>(scan.cols())));
  const std::uint64_t points = static_cast<std::uint64_t>(scan.cols());
  std::size_t tried = 0;
  for (std::size_t drawn = 0; drawn < kTriplesDrawn && tried < options.triples; ++drawn) {
    std::array<Vector3d, 3> corners;
    for (Vector3d& corner : corners) corner = scan.col(static_cast<Eigen::Index>(generator() % points));
    // A flat or small triple says little about the turn about its sides.
    if (least_height(corners[0], corners[1], corners[2]) < kFlattest * extent) continue;
    try_triple(corners, part, distances, &best);
    ++tried;
  }
  return best.sorted();
}

}  // namespace abbe
