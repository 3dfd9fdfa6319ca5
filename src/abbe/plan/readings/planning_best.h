#pragma once

// Internal to plan: the best candidate of all blocks, from those of each, which several processes have.
#include <cstddef>
#include <span>
#include <vector>

#include "abbe/plan/readings/planning_design.h"

namespace abbe {

struct BestOfBlock {
  std::size_t block = 0;
  PlanDesign::Best best{};
};

/// Of blocks in their order, those that may have the best candidate of all.
///
/// Best candidates that differ by no more than a tie are equal, and the first one counts. So the one with the lowest
/// score is not enough. But the best one of some blocks is at most a tie above each of them: a block after them can
/// only become the best if it is better than the best of each less its tie. These are few. Half a tie is far above
/// rounding.
///
/// What is left of several lists together does not depend on what was left out of each before, to the last bit: what
/// is left out has a bound that is no lower than that of a block before it. So lists can be merged in any grouping.
class PossibleBests {
 public:
  /// @param one  of a block after all those before
  void add(const BestOfBlock& one);
  const std::vector<BestOfBlock>& blocks() const { return blocks_; }

 private:
  std::vector<BestOfBlock> blocks_{};
  double least_ = PlanDesign::kImpossible;
};

/// The bytes of such a list, and back.
std::vector<std::byte> bytes_of(std::span<const BestOfBlock> blocks);
std::vector<BestOfBlock> blocks_in(std::span<const std::byte> bytes);

/// What is left of two lists together; their blocks are different ones (WorkInStep::Merge).
void merge_possible_bests(std::vector<std::byte>& all, std::span<const std::byte> following);

/// The first one of those that are equal to the best.
PlanDesign::Best best_of(std::span<const BestOfBlock> blocks);

}  // namespace abbe
