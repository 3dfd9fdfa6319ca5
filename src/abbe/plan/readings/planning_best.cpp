#include "abbe/plan/readings/planning_best.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <type_traits>

#include "abbe/geometry/numbered_work.h"

namespace abbe {

static_assert(std::is_trivially_copyable_v<BestOfBlock>);

void PossibleBests::add(const BestOfBlock& one) {
  if (!(one.best.score + one.best.tie / 2 < least_)) return;
  least_ = std::min(least_, one.best.score + one.best.tie);
  blocks_.push_back(one);
}

std::vector<std::byte> bytes_of(std::span<const BestOfBlock> blocks) {
  const std::span<const std::byte> bytes = std::as_bytes(blocks);
  return {bytes.begin(), bytes.end()};
}

std::vector<BestOfBlock> blocks_in(std::span<const std::byte> bytes) {
  std::vector<BestOfBlock> blocks(bytes.size() / sizeof(BestOfBlock));
  if (blocks.size() * sizeof(BestOfBlock) != bytes.size()) throw WorkError("a list of candidates is cut off");
  if (!bytes.empty()) std::memcpy(blocks.data(), bytes.data(), bytes.size());
  return blocks;
}

void merge_possible_bests(std::vector<std::byte>& all, std::span<const std::byte> following) {
  const std::vector<BestOfBlock> first = blocks_in(all), second = blocks_in(following);
  std::vector<BestOfBlock> both;
  std::merge(first.begin(), first.end(), second.begin(), second.end(), std::back_inserter(both),
             [](const BestOfBlock& a, const BestOfBlock& b) { return a.block < b.block; });
  PossibleBests possible;
  for (const BestOfBlock& one : both) possible.add(one);
  all = bytes_of(possible.blocks());
}

PlanDesign::Best best_of(std::span<const BestOfBlock> blocks) {
  PlanDesign::Best best;
  for (const BestOfBlock& one : blocks)
    if (one.best.score < best.score - one.best.tie) best = one.best;
  return best;
}

}  // namespace abbe
