#include "abbe/plan/readings/planning_best.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/numbered_work.h"

namespace abbe {
namespace {

/// Candidates, many of which are equal but for ties or for rounding, impossible, or no number.
std::vector<ScoredCandidate> random_scores(RandomStream& random, bool one_tie) {
  std::vector<ScoredCandidate> all(random.bits() % 200);
  const double tie = random.bits() % 8 == 0 ? 0 : 1e-8, level = -3 * random.uniform();
  double trend = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    ScoredCandidate& one = all[i];
    one.candidate = 7 * i;
    const std::uint64_t kind = random.bits() % 10;
    if (kind == 0) continue;
    trend -= kind == 1 ? 0.01 * random.uniform() : 0;
    one.tie = one_tie ? tie : tie * (1 + random.uniform());
    const double near = static_cast<double>(random.bits() % 9) / 4 - 1;  // in ties, exactly or nearly
    one.score = level + trend + near * tie * (kind < 5 ? 1 : 1 + 1e-9 * random.normal());
    if (kind == 9) one.score = level + trend * (1 + 1e-15 * random.normal());
    if (kind == 8) one.score = std::abs(random.normal());
    if (random.bits() % 50 == 0) one.score = std::numeric_limits<double>::quiet_NaN();
    one.change = 2 * one.score;
  }
  return all;
}

/// By its definition: the first one whose score is at most a tie above the lowest one.
ScoredCandidate best_of(const std::vector<ScoredCandidate>& all) {
  double least = ScoredCandidate::kImpossible;
  for (const ScoredCandidate& one : all)
    if (one.score < least) least = one.score;
  for (const ScoredCandidate& one : all)
    if (one.score < ScoredCandidate::kImpossible && one.score - one.tie <= least) return one;
  return {};
}

PossibleBests possible_of(const std::vector<ScoredCandidate>& all) {
  PossibleBests possible;
  for (const ScoredCandidate& one : all) possible.add(one);
  return possible;
}

std::vector<std::byte> bytes_of_one(const PossibleBests& list) { return bytes_of({&list, 1}); }

/// Merges neighbouring lists, any of them first.
std::vector<std::byte> merged_anyhow(std::vector<std::vector<std::byte>> lists, RandomStream& random) {
  while (lists.size() > 1) {
    const std::size_t at = random.bits() % (lists.size() - 1);
    merge_possible_bests(lists[at], lists[at + 1]);
    lists.erase(lists.begin() + static_cast<std::ptrdiff_t>(at) + 1);
  }
  return lists.front();
}

bool is_same(const ScoredCandidate& a, const ScoredCandidate& b) {
  return a.candidate == b.candidate && std::bit_cast<std::uint64_t>(a.score) == std::bit_cast<std::uint64_t>(b.score) &&
         a.change == b.change;
}

TEST(PossibleBestsTest, ContainTheBestOfAll) {
  RandomStream random(12);
  std::size_t most = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::vector<ScoredCandidate> all = random_scores(random, round % 2 == 0);
    const PossibleBests possible = possible_of(all);
    ASSERT_TRUE(is_same(possible.best(), best_of(all))) << round;
    most = std::max(most, possible.list().size());
  }
  EXPECT_GT(most, 2U);
}

TEST(PossibleBestsTest, AreTheSameBytesForAnyNumberOfProcessesAndAnyTree) {
  RandomStream random(11);
  for (int round = 0; round < 20000; ++round) {
    const std::vector<ScoredCandidate> all = random_scores(random, round % 2 == 0);
    const std::vector<std::byte> expected = bytes_of_one(possible_of(all));
    const std::size_t processes = 1 + random.bits() % 12;
    std::vector<std::vector<ScoredCandidate>> own(processes);
    // Dealt out in turn, as a plan does it, or anyhow.
    for (const ScoredCandidate& one : all)
      own[round % 3 == 0 ? random.bits() % processes : one.candidate % processes].push_back(one);
    std::vector<std::vector<std::byte>> lists;
    for (const std::vector<ScoredCandidate>& list : own) lists.push_back(bytes_of_one(possible_of(list)));
    ASSERT_EQ(merged_anyhow(std::move(lists), random), expected) << round;
  }
}

TEST(PossibleBestsTest, LoseNothingIfThoseAreLeftOutThatAreNotEqualToTheBest) {
  RandomStream random(14);
  for (int round = 0; round < 20000; ++round) {
    std::vector<ScoredCandidate> all = random_scores(random, round % 2 == 0);
    const ScoredCandidate expected = best_of(all);
    double least = ScoredCandidate::kImpossible;
    for (const ScoredCandidate& one : all)
      if (one.score < least) least = one.score;
    std::erase_if(
        all, [&](const ScoredCandidate& one) { return !(one.score - one.tie <= least) && random.bits() % 2 == 0; });
    ASSERT_TRUE(is_same(possible_of(all).best(), expected)) << round;
  }
}

TEST(PossibleBestsTest, AreFew) {
  // Of 100,000 that are equal, in no order, about log(100,000).
  RandomStream random(13);
  PossibleBests possible;
  for (std::size_t i = 0; i < 100000; ++i) {
    const double score = -1e-8 * random.uniform();
    possible.add({i, score, score, 1e-8});
  }
  EXPECT_LT(possible.list().size(), 30U);
  EXPECT_GT(possible.list().size(), 3U);
  EXPECT_EQ(possible.best().candidate, 0U);
}

TEST(PossibleBestsTest, OfTwoPartsAreThoseOfTheWhole) {
  RandomStream random(15);
  for (int round = 0; round < 5000; ++round) {
    const std::vector<ScoredCandidate> all = random_scores(random, round % 2 == 0);
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.empty() ? 0 : random.bits() % all.size());
    PossibleBests parts = possible_of({all.begin(), middle});
    parts.append(possible_of({middle, all.end()}));
    ASSERT_EQ(bytes_of_one(parts), bytes_of_one(possible_of(all))) << round;
  }
}

TEST(PossibleBestsTest, OfSeveralPlacesAreMergedPlaceByPlace) {
  RandomStream random(16);
  std::vector<PossibleBests> first, second, expected;
  for (int place = 0; place < 5; ++place) {
    const std::vector<ScoredCandidate> all = random_scores(random, true);
    std::vector<ScoredCandidate> parts[2];
    for (const ScoredCandidate& one : all) parts[random.bits() % 2].push_back(one);
    first.push_back(possible_of(parts[0]));
    second.push_back(possible_of(parts[1]));
    expected.push_back(possible_of(all));
  }
  std::vector<std::byte> merged = bytes_of(first);
  merge_possible_bests(merged, bytes_of(second));
  EXPECT_EQ(merged, bytes_of(expected));
  second.pop_back();
  EXPECT_THROW(merge_possible_bests(merged, bytes_of(second)), WorkError);
}

TEST(PossibleBestsTest, RefuseWhatIsCutOff) {
  PossibleBests possible;
  possible.add({3, -1, -1, 0});
  std::vector<std::byte> bytes = bytes_of_one(possible);
  bytes.pop_back();
  EXPECT_THROW(lists_of(bytes), WorkError);
  bytes.resize(5);
  EXPECT_THROW(lists_of(bytes), WorkError);
}

}  // namespace
}  // namespace abbe
