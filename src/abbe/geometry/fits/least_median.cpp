#include "abbe/geometry/fits/least_median.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "abbe/geometry/decompositions.h"

namespace abbe::fits {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// The frames with the smallest median distance of a few points.
class LeastMedian {
 public:
  LeastMedian(ShapeKind kind, const Survey& survey, const FitConstraints& constraints, std::uint64_t seed)
      : kind_(kind),
        survey_(survey),
        constraints_(constraints),
        scored_(spread_sample(survey.sample, Vector3d::Zero(), 200)),
        met_(points_met(kind, free_parameters(kind, constraints).size())),
        generator_(seed) {}

  /// The best that differ from each other, best first.
  std::vector<ShapeFrame> search() {
    // Of few points without a wrong one, the shape of all is better than that of any few.
    const BestStart all = best_start(kind_, survey_, constraints_);
    if (all.found) score(all.frame);
    if (kind_ == ShapeKind::cylinder || kind_ == ShapeKind::cone) {
      along_all_directions();
    } else {
      for (int trial = 0; trial < 200; ++trial) try_subset(subset_size());
    }
    std::vector<ShapeFrame> frames;
    for (const Scored& candidate : best_) frames.push_back(candidate.frame);
    return frames;
  }

 private:
  Index subset_size() const {
    switch (kind_) {
      case ShapeKind::line2:
      case ShapeKind::line3:
        return 2;
      case ShapeKind::sphere:
        return 4;
      case ShapeKind::cone:
        return 5;
      default:
        return 3;
    }
  }
  Matrix3Xd draw(Index count) {
    Matrix3Xd subset(3, count);
    for (Index k = 0; k < count; ++k) {
      const std::uint64_t index = generator_() % static_cast<std::uint64_t>(survey_.sample.cols());
      subset.col(k) = survey_.sample.col(static_cast<Index>(index));
    }
    return subset;
  }
  double score(const ShapeFrame& frame) {
    std::vector<double> d(static_cast<std::size_t>(scored_.cols()));
    for (Index i = 0; i < scored_.cols(); ++i) {
      d[static_cast<std::size_t>(i)] = std::abs(point_slopes(frame, scored_.col(i)).distance);
    }
    const double value = median_distance(d, met_);
    if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
    if (best_.size() == kKept && !(value < best_.back().value)) return value;
    // Huge circles come near everything that is small: a radius has to be of the data's order.
    if (has_radius(kind_) && !(frame.radius > 0 && frame.radius < 1e4 * survey_.size)) return value;
    // Of those that are nearly the same only the best one.
    const auto same = std::find_if(best_.begin(), best_.end(),
                                   [&](const Scored& other) { return !unlike(other.frame, frame, survey_); });
    if (same != best_.end()) {
      if (!(value < same->value)) return value;
      best_.erase(same);
    }
    const auto place =
        std::find_if(best_.begin(), best_.end(), [&](const Scored& other) { return value < other.value; });
    best_.insert(place, {value, frame});
    if (best_.size() > kKept) best_.pop_back();
    return value;
  }
  void try_subset(Index count) {
    Survey few = survey_;
    few.sample = draw(count);
    few.centroid = centroid(few.sample, Vector3d::Zero(), 1);
    const SymmetricEigen<3> principal(few.centroid.scatter);
    few.directions = principal.eigenvectors().rowwise().reverse();
    for (const ShapeFrame& frame : start_frames(kind_, few, constraints_)) score(frame);
  }
  double along(const Vector3d& direction, int trials) {
    const Eigen::Matrix3d axes = axes_along(direction);
    double best = std::numeric_limits<double>::infinity();
    for (int trial = 0; trial < trials; ++trial) {
      ShapeFrame frame;
      if (frame_along(kind_, axes, draw(subset_size()), constraints_, frame)) best = std::min(best, score(frame));
    }
    return best;
  }
  void along_all_directions() {
    if (constraints_.direction) {
      along(*constraints_.direction, 300);
      return;
    }
    std::vector<std::pair<double, Vector3d>> scored;
    const auto add = [&](const Vector3d& direction) { scored.emplace_back(along(direction, 25), direction); };
    for (const Vector3d& direction : half_sphere(250)) add(direction);
    for (int k = 0; k < 3; ++k) add(survey_.directions.col(k));
    // Between the directions over the sphere a long thin part is missed; its longest chords lie along it.
    for (int k = 0; k < 60; ++k) {
      Vector3d longest = Vector3d::Zero();
      for (int chord = 0; chord < 4; ++chord) {
        const Matrix3Xd ends = draw(2);
        const Vector3d between = ends.col(1) - ends.col(0);
        if (between.squaredNorm() > longest.squaredNorm()) longest = between;
      }
      if (longest.squaredNorm() > 0) add(longest.normalized());
    }
    std::stable_sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    scored.resize(std::min<std::size_t>(scored.size(), 5));
    for (auto [value, direction] : scored) {
      for (double reach = 0.1; reach > 0.004; reach /= 2) {
        const Eigen::Matrix3d axes = axes_along(direction);
        for (int k = 0; k < 8; ++k) {
          const double turn = 2 * std::numbers::pi * k / 8;
          const Vector3d other =
              (axes.col(2) + reach * (std::cos(turn) * axes.col(0) + std::sin(turn) * axes.col(1))).normalized();
          const double found = along(other, 25);
          if (found < value) {
            value = found;
            direction = other;
          }
        }
      }
    }
  }

  ShapeKind kind_;
  const Survey& survey_;
  const FitConstraints& constraints_;
  Matrix3Xd scored_;
  std::size_t met_;
  std::mt19937_64 generator_;
  static constexpr std::size_t kKept = 5;
  struct Scored {
    double value = 0;
    ShapeFrame frame;
  };
  std::vector<Scored> best_;  // best first
};

}  // namespace

double median_distance(std::vector<double>& distances, std::size_t met) {
  met = std::min(met, distances.size() - 1);
  const auto half = distances.begin() + static_cast<std::ptrdiff_t>(met + (distances.size() - met) / 2);
  std::nth_element(distances.begin(), half, distances.end());
  return *half;
}

bool unlike(const ShapeFrame& a, const ShapeFrame& b, const Survey& survey) {
  constexpr double kLength = 0.05, kAngle = 0.1;  // of the size; rad
  return apart(a, b, survey.centroid.mean, kLength * survey.size, kAngle);
}

std::vector<ShapeFrame> least_median_shapes(ShapeKind kind, const Survey& survey, const FitConstraints& constraints,
                                            std::uint64_t seed) {
  return LeastMedian(kind, survey, constraints, seed).search();
}

}  // namespace abbe::fits
