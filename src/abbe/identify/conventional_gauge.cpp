#include "abbe/identify/conventional_gauge.h"

#include <cmath>

namespace abbe {
namespace {

using Index = Eigen::Index;
// A candidate is taken if at least this part of it (as a cosine) lies in what is still open.
constexpr double kOpenPart = 1e-3;
// A location error waits if another one fixes the same direction by this much more: equations that hardly fix what they
// are meant for turn small errors of the machine into large parameters.
constexpr double kClearPart = 0.1;
// Candidates that fix equally much but for rounding: the first is taken.
constexpr double kEquallyFirm = 1e-6;

}  // namespace

ConventionalGauge::ConventionalGauge(const std::vector<GaugeCandidate>& candidates, const Eigen::VectorXd& scale,
                                     const Eigen::MatrixXd& open)
    : candidates_(candidates), parts_(open.cols(), static_cast<Index>(candidates.size())), fixed_(open.cols(), 0) {
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Eigen::VectorXd scaled = candidates[i].functional.cwiseQuotient(scale);
    parts_.col(static_cast<Index>(i)) = open.transpose() * scaled / scaled.norm();
  }
}

std::vector<std::size_t> ConventionalGauge::chosen(GaugeOrder order) {
  std::size_t next = 0;
  for (; next < candidates_.size() && !is_complete(); ++next) {
    if (order == GaugeOrder::firmest && candidates_[next].exchangeable) break;
    if (!candidates_[next].of_location) {
      take_waiting();
      if (is_complete()) break;
    }
    const Eigen::VectorXd part = part_left_open(next);
    if (part.norm() >= kOpenPart && has_to_wait(next, part))
      waiting_.push_back(next);
    else
      take(next);
  }
  take_waiting();
  if (order == GaugeOrder::firmest) take_firmest(next);
  return chosen_;
}

Eigen::VectorXd ConventionalGauge::part_left_open(std::size_t candidate) const {
  Eigen::VectorXd part = parts_.col(static_cast<Index>(candidate));
  for (int pass = 0; pass < 2; ++pass) part -= fixed_ * (fixed_.transpose() * part);
  return part;
}

// True for a location error if another one fixes much better what this one would fix.
bool ConventionalGauge::has_to_wait(std::size_t candidate, const Eigen::VectorXd& part) const {
  if (!candidates_[candidate].of_location) return false;
  const Eigen::VectorXd direction = part.normalized();
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    if (candidates_[i].of_location &&
        kClearPart * std::abs(direction.dot(parts_.col(static_cast<Index>(i)))) > part.norm())
      return true;
  return false;
}

void ConventionalGauge::take(std::size_t candidate) {
  const Eigen::VectorXd part = part_left_open(candidate);
  if (part.norm() < kOpenPart) return;
  fixed_.conservativeResize(Eigen::NoChange, fixed_.cols() + 1);
  fixed_.rightCols(1) = part.normalized();
  chosen_.push_back(candidate);
}

void ConventionalGauge::take_waiting() {
  for (const std::size_t candidate : waiting_)
    if (!is_complete()) take(candidate);
  waiting_.clear();
}

void ConventionalGauge::take_firmest(std::size_t first) {
  while (!is_complete()) {
    std::size_t best = first;
    double most = 0;
    for (std::size_t i = first; i < candidates_.size(); ++i) {
      const double part = part_left_open(i).norm();
      if (part > (1 + kEquallyFirm) * most) {
        best = i;
        most = part;
      }
    }
    if (most < kOpenPart) return;
    take(best);
  }
}

}  // namespace abbe
