#include "abbe/plan/readings/planning_best.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <type_traits>

#include "abbe/geometry/numbered_work.h"

namespace abbe {
namespace {

static_assert(std::is_trivially_copyable_v<ScoredCandidate>);

double lowest_equal(const ScoredCandidate& one) { return one.score - one.tie; }

}  // namespace

void PossibleBests::lower_least(double score) {
  least_ = std::min(least_, score);
  const auto is_equal = [this](const ScoredCandidate& one) { return lowest_equal(one) <= least_; };
  list_.erase(list_.begin(), std::find_if(list_.begin(), list_.end(), is_equal));
}

void PossibleBests::add(const ScoredCandidate& one) {
  if (!std::isfinite(one.score) || lowest_equal(one) > least_) return;
  if (list_.empty() || lowest_equal(one) < lowest_equal(list_.back())) list_.push_back(one);
  lower_least(one.score);
}

void PossibleBests::append(const PossibleBests& following) {
  for (const ScoredCandidate& one : following.list_) add(one);
  lower_least(following.least_);
}

void PossibleBests::merge(const PossibleBests& others) {
  std::vector<ScoredCandidate> both;
  std::merge(list_.begin(), list_.end(), others.list_.begin(), others.list_.end(), std::back_inserter(both),
             [](const ScoredCandidate& a, const ScoredCandidate& b) { return a.candidate < b.candidate; });
  list_.clear();
  lower_least(others.least_);
  for (const ScoredCandidate& one : both) add(one);
}

void PossibleBests::clear() {
  list_.clear();
  least_ = ScoredCandidate::kImpossible;
}

void PossibleBests::pack(std::vector<std::byte>& bytes) const {
  const double numbers[] = {least_, static_cast<double>(list_.size())};
  pack_numbers(numbers, bytes);
  const auto list = std::as_bytes(std::span(list_));
  bytes.insert(bytes.end(), list.begin(), list.end());
}

PossibleBests PossibleBests::unpack(std::span<const std::byte>& bytes) {
  double numbers[2];
  unpack_numbers(bytes, numbers);
  PossibleBests bests;
  bests.least_ = numbers[0];
  const std::size_t most = bytes.size() / sizeof(ScoredCandidate);
  if (!(numbers[1] >= 0 && numbers[1] <= static_cast<double>(most))) throw WorkError("a list of candidates is cut off");
  bests.list_.resize(static_cast<std::size_t>(numbers[1]));
  const std::size_t size = bests.list_.size() * sizeof(ScoredCandidate);
  if (size > 0) std::memcpy(bests.list_.data(), bytes.data(), size);
  bytes = bytes.subspan(size);
  return bests;
}

std::vector<std::byte> bytes_of(std::span<const PossibleBests> lists) {
  std::vector<std::byte> bytes;
  for (const PossibleBests& list : lists) list.pack(bytes);
  return bytes;
}

std::vector<PossibleBests> lists_of(std::span<const std::byte> bytes) {
  std::vector<PossibleBests> lists;
  while (!bytes.empty()) lists.push_back(PossibleBests::unpack(bytes));
  return lists;
}

void merge_possible_bests(std::vector<std::byte>& all, std::span<const std::byte> following) {
  std::vector<PossibleBests> lists = lists_of(all), others = lists_of(following);
  if (lists.size() != others.size()) throw WorkError("another number of lists of candidates");
  for (std::size_t k = 0; k < lists.size(); ++k) lists[k].merge(others[k]);
  all = bytes_of(lists);
}

}  // namespace abbe
