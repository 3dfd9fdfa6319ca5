#include "abbe/geometry/registration/pose_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {
namespace {

constexpr std::size_t kScored = 256, kScoredAtOnce = 24;
constexpr double kAlikeTrace = 2.8787;  ///< of the rotation between two poses: 1 + 2 cos(0.35)

bool scores_less(const PoseCandidate& a, const PoseCandidate& b) { return a.score < b.score; }

}  // namespace

PoseCandidates::PoseCandidates(const DistanceGrid& grid, const Eigen::Matrix3Xd& scan, double reach, double diameter,
                               std::size_t most, std::mt19937_64& generator)
    : grid_(grid), reach_(reach), diameter_(diameter), most_(most), middle_(scan.rowwise().mean()) {
  // In random order, so that the first ones speak for all.
  std::vector<Eigen::Index> order(static_cast<std::size_t>(scan.cols()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[generator() % i]);
  order.resize(std::min(order.size(), kScored));
  for (const Eigen::Index i : order) scored_.push_back(scan.col(i));
}

PoseCandidates::Score PoseCandidates::score(const RigidTransform& pose) const {
  const double reach_square = reach_ * reach_;
  double sum = 0, given_up_above = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < scored_.size(); ++k) {
    const double distance = static_cast<double>(grid_.at(pose * scored_[k]));
    sum += std::max(0.0, 1 - distance * distance / reach_square);
    // Poses that start far below what is kept do not recover: a term scatters by 0.4 at most.
    if ((k + 1) % kScoredAtOnce == 0) {
      const double count = static_cast<double>(k + 1);
      given_up_above = std::min(given_up_above, (sum + 1.2 * std::sqrt(count)) / count);
      if (given_up_above < least()) return {};
    }
  }
  return {sum / static_cast<double>(scored_.size()), given_up_above};
}

bool PoseCandidates::alike(const RigidTransform& a, const RigidTransform& b) const {
  return (a * middle_ - b * middle_).norm() < 0.08 * diameter_ &&
         a.rotation.cwiseProduct(b.rotation).sum() > kAlikeTrace;
}

void PoseCandidates::add(const RigidTransform& mesh_from_scan, const Score& score) {
  if (score.score <= least() || score.given_up_above < least()) return;
  const PoseCandidate candidate{mesh_from_scan, score.score};
  const auto same = std::find_if(best_.begin(), best_.end(), [&](const PoseCandidate& other) {
    return alike(candidate.mesh_from_scan, other.mesh_from_scan);
  });
  if (same != best_.end()) {
    if (candidate.score > same->score) *same = candidate;
  } else if (best_.size() < most_) {
    best_.push_back(candidate);
  } else {
    *std::min_element(best_.begin(), best_.end(), scores_less) = candidate;
  }
  least_ = std::min_element(best_.begin(), best_.end(), scores_less)->score;
}

std::vector<PoseCandidate> PoseCandidates::sorted() const {
  std::vector<PoseCandidate> result = best_;
  std::sort(result.begin(), result.end(),
            [](const PoseCandidate& a, const PoseCandidate& b) { return a.score > b.score; });
  return result;
}

}  // namespace abbe
