#include "abbe/plan/readings/planning_best.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/numbered_work.h"

namespace abbe {
namespace {

/// Best candidates of blocks, many of which are equal but for ties or for rounding, impossible, or no number.
std::vector<BestOfBlock> random_blocks(RandomStream& random, bool one_tie) {
  std::vector<BestOfBlock> blocks(random.bits() % 200);
  const double tie = random.bits() % 8 == 0 ? 0 : 1e-8, level = -3 * random.uniform();
  double trend = 0;
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    PlanDesign::Best& best = blocks[block].best;
    blocks[block].block = block;
    const std::uint64_t kind = random.bits() % 10;
    if (kind == 0) continue;
    trend -= kind == 1 ? 0.01 * random.uniform() : 0;
    best.candidate = 7 * block;
    best.tie = one_tie ? tie : tie * (1 + random.uniform());
    const double near = static_cast<double>(random.bits() % 9) / 4 - 1;  // in ties, exactly or nearly
    best.score = level + trend + near * tie * (kind < 5 ? 1 : 1 + 1e-9 * random.normal());
    if (kind == 9) best.score = level + trend * (1 + 1e-15 * random.normal());
    if (kind == 8) best.score = std::abs(random.normal());
    if (random.bits() % 50 == 0) best.score = std::numeric_limits<double>::quiet_NaN();
    best.change = 2 * best.score;
  }
  return blocks;
}

std::vector<std::byte> possible_of(std::span<const BestOfBlock> blocks) {
  PossibleBests possible;
  for (const BestOfBlock& one : blocks) possible.add(one);
  return bytes_of(possible.blocks());
}

/// Merges neighbouring lists, any of them first.
std::vector<std::byte> merged_anyhow(std::vector<std::vector<std::byte>> lists, RandomStream& random) {
  while (lists.size() > 1) {
    const std::size_t at = random.bits() % (lists.size() - 1);
    merge_possible_bests(lists[at], lists[at + 1]);
    lists.erase(lists.begin() + static_cast<std::ptrdiff_t>(at) + 1);
  }
  return lists.front();
}

TEST(PossibleBestsTest, AreTheSameBytesForAnyNumberOfProcessesAndAnyTree) {
  RandomStream random(11);
  std::size_t most = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::vector<BestOfBlock> blocks = random_blocks(random, round % 2 == 0);
    const std::vector<std::byte> expected = possible_of(blocks);
    most = std::max(most, expected.size() / sizeof(BestOfBlock));
    const std::size_t processes = 1 + random.bits() % 12;
    std::vector<std::vector<BestOfBlock>> own(processes);
    // Dealt out in turn, as a plan does it, or anyhow.
    for (const BestOfBlock& one : blocks)
      own[round % 3 == 0 ? random.bits() % processes : one.block % processes].push_back(one);
    std::vector<std::vector<std::byte>> lists;
    for (const std::vector<BestOfBlock>& list : own) lists.push_back(possible_of(list));
    ASSERT_EQ(merged_anyhow(std::move(lists), random), expected) << round;
  }
  EXPECT_GT(most, 10U);
}

TEST(PossibleBestsTest, ContainTheBestOfAll) {
  RandomStream random(12);
  for (int round = 0; round < 20000; ++round) {
    const std::vector<BestOfBlock> blocks = random_blocks(random, round % 2 == 0);
    const std::vector<BestOfBlock> possible = blocks_in(possible_of(blocks));
    const PlanDesign::Best expected = best_of(blocks), found = best_of(possible);
    ASSERT_EQ(found.candidate, expected.candidate) << round;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(found.score), std::bit_cast<std::uint64_t>(expected.score)) << round;
  }
}

TEST(PossibleBestsTest, AreFew) {
  // Of 100,000 blocks in no order, about log(100,000).
  RandomStream random(13);
  PossibleBests possible;
  for (std::size_t block = 0; block < 100000; ++block) {
    const double score = -random.uniform();
    possible.add({block, {block, score, score, 1e-8}});
  }
  EXPECT_LT(possible.blocks().size(), 30U);
  EXPECT_GT(possible.blocks().size(), 3U);
}

TEST(PossibleBestsTest, RefuseWhatIsCutOff) {
  std::vector<std::byte> bytes = bytes_of(std::vector<BestOfBlock>(2));
  bytes.pop_back();
  EXPECT_THROW(blocks_in(bytes), WorkError);
}

}  // namespace
}  // namespace abbe
