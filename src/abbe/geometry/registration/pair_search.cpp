#include "abbe/geometry/registration/pair_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAngleBin = 0.2618;  ///< 15 degrees
constexpr double kDistanceBins = 24;  ///< over the diameter
constexpr std::size_t kPairsDrawn = 6000;

/// What two points with normals look like from any side.
struct PairFeature {
  double distance = 0;
  double first = 0, second = 0, between = 0;  ///< cosines: normals to the line, normal to normal

  PairFeature(const Vector3d& p, const Vector3d& n, const Vector3d& q, const Vector3d& m) {
    const Vector3d line = q - p;
    distance = line.norm();
    if (!(distance > 0)) return;
    first = n.dot(line) / distance;
    second = m.dot(line) / distance;
    between = n.dot(m);
  }
  /// Does not depend on the signs of the normals.
  std::uint32_t key(double diameter) const {
    const auto bin = [](double cosine) {
      return static_cast<std::uint32_t>(std::acos(std::min(1.0, std::abs(cosine))) / kAngleBin);
    };
    const std::uint32_t length = static_cast<std::uint32_t>(std::min(distance / diameter, 2.0) * kDistanceBins);
    return ((length * 8 + bin(first)) * 8 + bin(second)) * 8 + bin(between);
  }
  bool resembles(const PairFeature& other, double diameter) const {
    return std::abs(distance - other.distance) < 0.03 * diameter && std::abs(first - other.first) < 0.2 &&
           std::abs(second - other.second) < 0.2 && std::abs(between - other.between) < 0.2;
  }
  bool fixes_a_pose(double diameter) const { return distance > 0.15 * diameter && std::abs(first) < 0.96; }
};

struct PartPair {
  std::uint32_t key = 0, from = 0, to = 0;
  bool operator<(const PartPair& other) const {
    return key != other.key ? key < other.key : (from != other.from ? from < other.from : to < other.to);
  }
};

/// Axes along the line and, across it, along the first normal.
Matrix3d axes_of(const Vector3d& line, const Vector3d& normal) {
  Matrix3d axes;
  axes.col(0) = line.normalized();
  axes.col(1) = (normal - normal.dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

class PairSearch {
 public:
  PairSearch(const PointCloud& part, const ThinnedScan& scan, const DistanceGrid& grid,
             const PairSearchOptions& options)
      : part_(part),
        scan_(scan),
        options_(options),
        generator_(options.seed),
        diameter_((part.points.rowwise().maxCoeff() - part.points.rowwise().minCoeff()).norm()),
        best_(grid, scan.points, options.reach_mm, diameter_, options.candidates, generator_) {
    for (Eigen::Index i = 0; i < part.size(); ++i) {
      for (Eigen::Index j = 0; j < part.size(); ++j) {
        const PairFeature feature = part_feature(i, j);
        if (i == j || !feature.fixes_a_pose(diameter_)) continue;
        pairs_.push_back({feature.key(diameter_), static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
      }
    }
    std::sort(pairs_.begin(), pairs_.end());
  }

  std::vector<PoseCandidate> run() {
    struct Drawn {
      std::size_t matches = 0;
      Eigen::Index from = 0, to = 0;
    };
    std::vector<Drawn> drawn;
    const std::uint64_t points = static_cast<std::uint64_t>(scan_.points.cols());
    for (std::size_t k = 0; k < kPairsDrawn; ++k) {
      const Eigen::Index i = static_cast<Eigen::Index>(generator_() % points);
      const Eigen::Index j = static_cast<Eigen::Index>(generator_() % points);
      const PairFeature feature = scan_feature(i, j, 1, 1);
      if (i == j || !feature.fixes_a_pose(diameter_)) continue;
      const auto [first, last] = matches(feature);
      if (first != last) drawn.push_back({static_cast<std::size_t>(last - first), i, j});
    }
    std::stable_sort(drawn.begin(), drawn.end(), [](const Drawn& a, const Drawn& b) { return a.matches < b.matches; });
    std::size_t tried = 0;
    for (const Drawn& pair : drawn) {
      if (tried >= options_.poses) break;
      tried += try_pair(pair.from, pair.to);
    }
    return best_.sorted();
  }

 private:
  using Iterator = std::vector<PartPair>::const_iterator;

  PairFeature part_feature(Eigen::Index i, Eigen::Index j) const {
    return {part_.points.col(i), part_.normals.col(i), part_.points.col(j), part_.normals.col(j)};
  }
  PairFeature scan_feature(Eigen::Index i, Eigen::Index j, double sign_i, double sign_j) const {
    return {scan_.points.col(i), sign_i * scan_.normals.col(i), scan_.points.col(j), sign_j * scan_.normals.col(j)};
  }
  std::pair<Iterator, Iterator> matches(const PairFeature& feature) const {
    const std::uint32_t key = feature.key(diameter_);
    return {std::lower_bound(pairs_.begin(), pairs_.end(), PartPair{key, 0, 0}),
            std::lower_bound(pairs_.begin(), pairs_.end(), PartPair{key + 1, 0, 0})};
  }

  /// @return poses tried
  std::size_t try_pair(Eigen::Index from, Eigen::Index to) {
    std::size_t tried = 0;
    for (const double sign_from : {1.0, -1.0}) {
      for (const double sign_to : {1.0, -1.0}) {
        if (scan_.outwards && (sign_from < 0 || sign_to < 0)) continue;
        const PairFeature feature = scan_feature(from, to, sign_from, sign_to);
        const Vector3d p = scan_.points.col(from), q = scan_.points.col(to);
        const Matrix3d scan_axes = axes_of(q - p, sign_from * scan_.normals.col(from));
        const auto [first, last] = matches(feature);
        for (auto at = first; at != last; ++at) {
          const Eigen::Index i = at->from, j = at->to;
          if (!feature.resembles(part_feature(i, j), diameter_)) continue;
          const Vector3d a = part_.points.col(i), b = part_.points.col(j);
          RigidTransform pose;
          pose.rotation = axes_of(b - a, part_.normals.col(i)) * scan_axes.transpose();
          pose.translation = 0.5 * (a + b) - pose.rotation * (0.5 * (p + q));
          best_.add(pose);
          ++tried;
        }
      }
    }
    return tried;
  }

  const PointCloud& part_;
  const ThinnedScan& scan_;
  PairSearchOptions options_;
  std::mt19937_64 generator_;
  double diameter_ = 0;
  PoseCandidates best_;
  std::vector<PartPair> pairs_;
};

}  // namespace

std::vector<PoseCandidate> search_poses(const PointCloud& part, const ThinnedScan& scan, const DistanceGrid& grid,
                                        const PairSearchOptions& options) {
  if (part.size() < 3 || scan.points.cols() < 3) return {};
  return PairSearch(part, scan, grid, options).run();
}

}  // namespace abbe
