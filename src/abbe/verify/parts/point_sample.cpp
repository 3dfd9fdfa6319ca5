#include "abbe/verify/parts/point_sample.h"

#include <algorithm>

#include "abbe/geometry/mixed_bits.h"

namespace abbe {
namespace {

// What "comes first" stays longest; the heap has the last one in front.
bool hash_first(const SampledPoint& a, const SampledPoint& b) { return mixed_bits(a.number) < mixed_bits(b.number); }
bool least_first(const SampledPoint& a, const SampledPoint& b) {
  return a.deviation_mm != b.deviation_mm ? a.deviation_mm < b.deviation_mm : a.number < b.number;
}
bool largest_first(const SampledPoint& a, const SampledPoint& b) {
  return a.deviation_mm != b.deviation_mm ? a.deviation_mm > b.deviation_mm : a.number < b.number;
}

template <class First>
void keep_sampled(const SampledPoint& point, std::size_t most, const First& first, std::vector<SampledPoint>& heap) {
  if (most == 0) return;
  if (heap.size() == most) {
    if (!first(point, heap.front())) return;
    std::pop_heap(heap.begin(), heap.end(), first);
    heap.pop_back();
  }
  heap.push_back(point);
  std::push_heap(heap.begin(), heap.end(), first);
}

}  // namespace

bool PointSample::wants(std::uint64_t number, double deviation_mm) const {
  if (sample_.size() < most_ || least_.size() < kExtremes) return true;
  return deviation_mm <= least_.front().deviation_mm || deviation_mm >= largest_.front().deviation_mm ||
         (most_ > 0 && mixed_bits(number) < mixed_bits(sample_.front().number));
}

bool PointSample::keeps(const SampledPoint& point) const {
  const auto within = [&](const auto& heap, std::size_t most, const auto& first) {
    return heap.size() < most || (most > 0 && !first(heap.front(), point));
  };
  return within(sample_, most_, hash_first) || within(least_, kExtremes, least_first) ||
         within(largest_, kExtremes, largest_first);
}

void PointSample::add(const SampledPoint& point) {
  keep_sampled(point, most_, hash_first, sample_);
  keep_sampled(point, kExtremes, least_first, least_);
  keep_sampled(point, kExtremes, largest_first, largest_);
}

std::vector<SampledPoint> PointSample::points() const {
  std::vector<SampledPoint> all = sample_;
  all.insert(all.end(), least_.begin(), least_.end());
  all.insert(all.end(), largest_.begin(), largest_.end());
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  all.erase(std::unique(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.number == b.number; }),
            all.end());
  return all;
}

const SampledPoint* PointSample::least() const {
  return least_.empty() ? nullptr : &*std::min_element(least_.begin(), least_.end(), least_first);
}

const SampledPoint* PointSample::largest() const {
  return largest_.empty() ? nullptr : &*std::min_element(largest_.begin(), largest_.end(), largest_first);
}

}  // namespace abbe
