#include "abbe/plan/readings/planning_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <thread>

#include "abbe/errors/random_stream.h"
#include "abbe/plan/readings/planning.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

/// Threads in place of processes. Each merges what all give in a grouping of its own.
class StepThreads {
 public:
  explicit StepThreads(std::size_t count) : parts_(count), fingerprints_(count), all_(static_cast<int>(count)) {}

  WorkInStep of(std::size_t rank) {
    return {parts_.size(), rank,
            [this, rank](std::uint64_t fingerprint, std::vector<std::byte> own, const WorkInStep::Merge& merge) {
              parts_[rank] = std::move(own);
              fingerprints_[rank] = fingerprint;
              all_.arrive_and_wait();
              std::vector<std::byte> total = merged(parts_, merge, rank);
              for (const std::uint64_t one : fingerprints_) same_ = same_ && one == fingerprint;
              all_.arrive_and_wait();
              if (rank == 0) ++exchanges_;
              return total;
            }};
  }
  std::size_t exchanges() const { return exchanges_; }
  bool same_fingerprints() const { return same_; }

 private:
  std::vector<std::byte> merged(std::vector<std::vector<std::byte>> parts, const WorkInStep::Merge& merge,
                                std::size_t rank) const {
    for (RandomStream random(10 + rank, exchanges_); parts.size() > 1;) {
      const auto first = parts.begin() + static_cast<std::ptrdiff_t>(random.bits() % (parts.size() - 1));
      merge(*first, *std::next(first));
      parts.erase(std::next(first));
    }
    return std::move(parts.front());
  }

  std::vector<std::vector<std::byte>> parts_;
  std::vector<std::uint64_t> fingerprints_;
  std::barrier<> all_;
  std::atomic<bool> same_ = true;
  std::atomic<std::size_t> exchanges_ = 0;
};

/// Many candidates, so that they are shared. Of each third one there is another that is worth the same but for
/// rounding, as mirrored poses are, in a block far away.
PlanningCandidates mirrored_candidates(std::size_t count, std::size_t rows, Index columns) {
  PlanningCandidates candidates;
  candidates.rows.resize(static_cast<Index>(count * rows), columns);
  candidates.first_row.push_back(0);
  const std::size_t half = count / 2;
  for (std::size_t i = 0; i < count; ++i) {
    const bool mirrors = i >= half && i % 3 == 0;
    RandomStream random(7, mirrors ? i - half : i), rounding(8, i);
    for (std::size_t k = i * rows; k < (i + 1) * rows; ++k)
      for (Index j = 0; j < columns; ++j)
        candidates.rows(static_cast<Index>(k), j) = random.normal() * (1 + (mirrors ? 1e-12 * rounding.normal() : 0));
    candidates.first_row.push_back((i + 1) * rows);
  }
  return candidates;
}

struct SharedCase {
  bool variance;
  bool in_time;    // costs, and a time instead of a number
  bool in_groups;  // of which no more than some may be chosen
};

class SharedPlan : public ::testing::TestWithParam<SharedCase> {
 protected:
  SharedPlan() : candidates_(mirrored_candidates(3501, 3, 24)) {
    if (GetParam().variance) {
      options_.criterion = PlanningCriterion::variance;
      options_.functionals.resize(12, 24);
      RandomStream random(9);
      for (Index i = 0; i < options_.functionals.size(); ++i) options_.functionals.data()[i] = random.normal();
    }
    options_.count = 30;
    options_.starts = 2;
    if (GetParam().in_time) {
      for (std::size_t i = 0; i < candidates_.count(); ++i)
        candidates_.cost_s.push_back(1 + static_cast<double>(i % 5));
      options_.time_s = 60;
    }
    if (GetParam().in_groups) {
      for (std::uint32_t i = 0; i < candidates_.count(); ++i) options_.group.push_back(i % 7);
      options_.most_of_group = {3, 5, 2, 9, 4, 6, 8};
    }
  }

  std::vector<ReadingPlan> planned(int threads, const WorkInStep& in_step = {}) const {
    PlanningOptions options = options_;
    options.threads = threads;
    options.in_step = in_step;
    const PlanningSpace space(candidates_, Eigen::MatrixXd(), in_step, threads);
    std::vector<ReadingPlan> all = {plan_readings(space, options)};
    options.most_passes = 2;
    const std::vector<std::size_t> counts = {5, 20, 30, 37, 60};
    for (ReadingPlan& plan : plan_curve(space, options, counts)) all.push_back(std::move(plan));
    return all;
  }

  PlanningCandidates candidates_;
  PlanningOptions options_;
};

void expect_same(const std::vector<ReadingPlan>& found, const std::vector<ReadingPlan>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(found[k].status, expected[k].status);
    EXPECT_EQ(found[k].chosen, expected[k].chosen);
    EXPECT_EQ(found[k].history, expected[k].history);
    EXPECT_EQ(found[k].exchanges, expected[k].exchanges);
    EXPECT_EQ(found[k].passes, expected[k].passes);
    EXPECT_EQ(found[k].value.rank, expected[k].value.rank);
    EXPECT_EQ(found[k].value.log_determinant, expected[k].value.log_determinant);
    EXPECT_EQ(found[k].value.variance, expected[k].value.variance);
    EXPECT_EQ(found[k].value.cost, expected[k].value.cost);
  }
}

TEST_P(SharedPlan, IsTheSameForAnyNumberOfProcessesAndThreads) {
  const std::vector<ReadingPlan> expected = planned(1);
  ASSERT_EQ(expected.front().status, PlanningStatus::done);
  EXPECT_GT(expected.front().exchanges, 0U);
  for (const std::size_t processes : {2U, 3U, 9U}) {
    StepThreads group(processes);
    std::vector<std::vector<ReadingPlan>> found(processes);
    {
      std::vector<std::jthread> threads;
      for (std::size_t rank = 0; rank < processes; ++rank)
        threads.emplace_back([&, rank] { found[rank] = planned(processes == 3 ? 2 : 1, group.of(rank)); });
    }
    for (const std::vector<ReadingPlan>& one : found) expect_same(one, expected);
    EXPECT_TRUE(group.same_fingerprints());
    EXPECT_GT(group.exchanges(), 100U);
  }
}

INSTANTIATE_TEST_SUITE_P(ByCriterion, SharedPlan,
                         ::testing::Values(SharedCase{false, false, false}, SharedCase{true, false, false},
                                           SharedCase{true, true, false}, SharedCase{false, false, true}));

TEST(PlanSharesTest, GiveEveryBlockToOneProcess) {
  for (const std::size_t blocks : {0U, 1U, 5U, 63U, 64U, 65U, 1000U, 5209U, 70001U}) {
    for (const std::size_t processes : {1U, 2U, 3U, 7U, 100U}) {
      std::vector<std::size_t> owners(blocks, processes);
      std::size_t least = blocks, most = 0;
      for (std::size_t rank = 0; rank < processes; ++rank) {
        const PlanShares shares({processes, rank, {}}, 0, blocks);
        least = std::min(least, shares.own_count());
        most = std::max(most, shares.own_count());
        for (std::size_t k = 0; k < shares.own_count(); ++k) {
          ASSERT_LT(shares.own(k), blocks);
          ASSERT_EQ(owners[shares.own(k)], processes);
          owners[shares.own(k)] = rank;
          ASSERT_EQ(shares.owner(shares.own(k)), rank);
          if (k > 0) ASSERT_LT(shares.own(k - 1), shares.own(k));
        }
      }
      EXPECT_EQ(std::count(owners.begin(), owners.end(), processes), 0);
      EXPECT_LE(most, least + least / 128 + 1);
    }
  }
}

TEST(SharedPlanTest, HasAnotherFingerprintWhereAnythingIsAnother) {
  const auto fingerprint = [](const PlanningCandidates& candidates, const PlanningOptions& options) {
    struct Stop {};
    std::uint64_t found = 0;
    PlanningOptions shared = options;
    shared.in_step = {
        2, 0,
        [&](std::uint64_t given, const std::vector<std::byte>&, const WorkInStep::Merge&) -> std::vector<std::byte> {
          found = given;
          throw Stop();
        }};
    try {
      plan_readings(PlanningSpace(candidates, Eigen::MatrixXd()), shared);
    } catch (const Stop&) {
    }
    return found;
  };
  const PlanningCandidates candidates = mirrored_candidates(6001, 3, 24);
  PlanningOptions options;
  options.count = 30;
  const std::uint64_t expected = fingerprint(candidates, options);
  EXPECT_EQ(fingerprint(candidates, options), expected);
  options.count = 31;
  EXPECT_NE(fingerprint(candidates, options), expected);
  options.count = 30;
  PlanningCandidates others = candidates;
  others.rows(5000, 3) += 1e-6;
  EXPECT_NE(fingerprint(others, options), expected);
  others = candidates;
  others.cost_s.assign(others.count(), 1.5);
  EXPECT_NE(fingerprint(others, options), expected);
}

}  // namespace
}  // namespace abbe
