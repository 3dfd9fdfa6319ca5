#include "abbe/report/drawings/drawn_readings.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/even_choice.h"

namespace abbe {
namespace {

constexpr std::size_t kLargest = 200;
/// Each piece of a scan, of at most so many, may end with a group that is not whole.
constexpr std::size_t kMostPieces = 256;

bool is_larger(const DrawnReading& a, const DrawnReading& b) {
  const double first = std::abs(a.deviation_mm), second = std::abs(b.deviation_mm);
  return first != second ? first > second : a.number < b.number;
}

}  // namespace

DrawnReadings::DrawnReadings(std::size_t measured) {
  constexpr std::size_t kMost = kPointsDrawn - kLargest - kMostPieces;
  every_ = std::max<std::size_t>(1, (measured + kMost - 1) / kMost);
}

void DrawnReadings::keep_if_large(const DrawnReading& reading) {
  if (every_ == 1) return;  // all are there
  if (largest_.size() == kLargest) {
    if (!is_larger(reading, largest_.front())) return;
    std::pop_heap(largest_.begin(), largest_.end(), is_larger);
    largest_.pop_back();
  }
  largest_.push_back(reading);
  std::push_heap(largest_.begin(), largest_.end(), is_larger);
}

void DrawnReadings::add(const Eigen::Vector3d& foot, const Eigen::Vector3d& normal, double deviation_mm) {
  const bool is_of_group = next_ % every_ == chosen_of_group(next_ / every_, every_);
  const bool may_be_large =
      largest_.size() < kLargest || std::abs(deviation_mm) > std::abs(largest_.front().deviation_mm);
  if (is_of_group || may_be_large) {
    const DrawnReading reading{.number = next_,
                               .is_of_group = is_of_group ? 1U : 0U,
                               .foot = {foot.x(), foot.y(), foot.z()},
                               .normal = {normal.x(), normal.y(), normal.z()},
                               .deviation_mm = deviation_mm};
    if (is_of_group) of_groups_.push_back(reading);
    keep_if_large(reading);
  }
  ++next_;
}

void DrawnReadings::append(std::span<const DrawnReading> piece, std::uint64_t before) {
  for (DrawnReading reading : piece) {
    reading.number += before;
    if (reading.is_of_group != 0) of_groups_.push_back(reading);
    keep_if_large(reading);
  }
}

std::vector<DrawnReading> DrawnReadings::chosen() const {
  std::vector<DrawnReading> all = of_groups_;
  for (const DrawnReading& reading : largest_) {
    if (reading.is_of_group == 0) all.push_back(reading);
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  return all;
}

SurfaceReadings DrawnReadings::readings() const {
  const std::vector<DrawnReading> all = chosen();
  SurfaceReadings result;
  result.foot.resize(3, static_cast<Eigen::Index>(all.size()));
  result.normal.resize(3, static_cast<Eigen::Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) {
    result.foot.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3d(all[i].foot.data());
    result.normal.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3d(all[i].normal.data());
    result.deviation_mm.push_back(all[i].deviation_mm);
  }
  return result;
}

}  // namespace abbe
