// An identification whose readings are summed by several processes has the bytes of one process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/errors/random_stream.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_steps.h"
#include "property/summing_processes.h"

namespace abbe {
namespace {

using test::SummingProcesses;
using testing::HasSubstr;
using testing::StartsWith;

Study example(const std::string& file) {
  Study study = read_study(ABBE_SOURCE_DIR "/examples/" + file);
  study.identification->monte_carlo = 0;
  study.threads = 1;
  return study;
}

/// Consecutive ranges of random lengths, some of them empty.
std::vector<PieceRange> uneven_ranges(std::size_t pieces, std::size_t count, RandomStream& random) {
  std::vector<std::size_t> cuts = {0, pieces};
  while (cuts.size() < count + 1) cuts.push_back(random.bits() % (pieces + 1));
  std::sort(cuts.begin(), cuts.end());
  std::vector<PieceRange> ranges;
  for (std::size_t i = 0; i < count; ++i) ranges.push_back({cuts[i], cuts[i + 1]});
  return ranges;
}

struct Case {
  const char* name;
  std::function<Study()> study;
};

void expect_same_bits(const Identification& a, const Identification& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.message, b.message);
  EXPECT_EQ(a.estimates, b.estimates);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.setup, b.setup);
  EXPECT_EQ(a.gauge.warnings, b.gauge.warnings);
  EXPECT_EQ(a.gauge.rank_at_start, b.gauge.rank_at_start);
  EXPECT_EQ(a.gauge.rank_at_solution, b.gauge.rank_at_solution);
  EXPECT_EQ(a.gauge.singular_values, b.gauge.singular_values);
  EXPECT_EQ(a.space.directions, b.space.directions);
  EXPECT_EQ(a.statistics.chi_square, b.statistics.chi_square);
  EXPECT_EQ(a.statistics.robust_factor, b.statistics.robust_factor);
  EXPECT_EQ(a.statistics.observability.o1, b.statistics.observability.o1);
  EXPECT_EQ(a.robust_scale, b.robust_scale);
  ASSERT_EQ(a.history.size(), b.history.size());
  for (std::size_t i = 0; i < a.history.size(); ++i) {
    EXPECT_EQ(a.history[i].cost, b.history[i].cost);
    EXPECT_EQ(a.history[i].step, b.history[i].step);
    EXPECT_EQ(a.history[i].gradient, b.history[i].gradient);
  }
  ASSERT_EQ(a.outliers.size(), b.outliers.size());
  for (std::size_t i = 0; i < a.outliers.size(); ++i) {
    EXPECT_EQ(a.outliers[i].reading, b.outliers[i].reading);
    EXPECT_EQ(a.outliers[i].norm, b.outliers[i].norm);
    EXPECT_EQ(a.outliers[i].weight, b.outliers[i].weight);
  }
}

class SeveralProcesses : public testing::TestWithParam<Case> {};

TEST_P(SeveralProcesses, GiveTheBytesOfOne) {
  const Study study = GetParam().study();
  const StudyResult alone = run_study(study, {.map = false});
  ASSERT_GT(alone.identification.estimates.size(), 0) << alone.identification.message;
  ASSERT_TRUE(alone.identification.converged) << alone.identification.message;
  for (const std::size_t count : {1, 2, 3, 7}) {
    SummingProcesses processes(count, [&](std::size_t) { return prepared_problem(study); });
    RandomStream random(count);
    int sums = 0;
    RunOptions options;
    options.map = false;
    options.summation = [&](const SumRequest& request, const std::stop_token&) {
      ++sums;
      return merge_all(processes.sums(request, uneven_ranges(request.pieces, count, random)));
    };
    const StudyResult together = run_study(study, options);
    EXPECT_GT(sums, 3);
    EXPECT_EQ(study_summary(study, together).dump(), study_summary(study, alone).dump()) << count;
    expect_same_bits(together.identification, alone.identification);
    ASSERT_EQ(together.weighed.has_value(), alone.weighed.has_value());
    if (!alone.weighed) continue;
    EXPECT_EQ(together.weighed->components.variance, alone.weighed->components.variance);
    EXPECT_EQ(together.weighed->components.covariance, alone.weighed->components.covariance);
    EXPECT_EQ(together.weighed->components.iterations, alone.weighed->components.iterations);
  }
}

Study robust_tracker() {
  Study study = example("aguado/aguado.study.toml");
  EXPECT_NE(study.identification->loss, LossKind::none);
  return study;
}

Study with_variances() {
  Study study = robust_tracker();
  study.identification->loss = LossKind::none;
  study.identification->estimate_variance_factor = true;
  study.identification->estimate_pose_noise = true;
  return study;
}

INSTANTIATE_TEST_SUITE_P(
    Example, SeveralProcesses,
    testing::Values(Case{"PrismAndRTest", [] { return example("trunnion/polygon-and-r-test.study.toml"); }},
                    Case{"RobustTracker", robust_tracker}, Case{"VarianceComponents", with_variances}),
    [](const auto& one) { return one.param.name; });

/// Fails if the identification gives a number although one of three processes goes wrong.
class OneOfThreeProcesses : public testing::Test {
 protected:
  std::string failure(const std::function<void(std::size_t, int, SumOfReadings&)>& spoil,
                      const std::function<Study(std::size_t)>& study_of = {},
                      const std::function<void(std::vector<SumOfReadings>&)>& lose = {}) {
    SummingProcesses processes(
        3, [&](std::size_t process) { return prepared_problem(study_of ? study_of(process) : study_); }, spoil);
    RunOptions options;
    options.map = false;
    options.summation = [&](const SumRequest& request, const std::stop_token&) {
      std::vector<PieceRange> ranges;
      for (std::size_t i = 0; i < 3; ++i) ranges.push_back(share_of_pieces(request.pieces, i, 3));
      std::vector<SumOfReadings> parts = processes.sums(request, ranges);
      if (lose) lose(parts);
      return merge_all(std::move(parts));
    };
    try {
      run_study(study_, options);
    } catch (const SumError& error) {
      return error.what();
    }
    return "a number";
  }

  Study study_ = example("trunnion/polygon-and-r-test.study.toml");
};

TEST_F(OneOfThreeProcesses, ThatEndsIsNamed) {
  EXPECT_EQ(failure([](std::size_t process, int number, SumOfReadings&) {
              if (process == 1 && number == 4) ::_exit(3);
            }),
            "process 1 has ended without its sum");
}

TEST_F(OneOfThreeProcesses, ThatHasOtherReadingsIsFoundOut) {
  const auto other_seed = [&](std::size_t process) {
    Study study = study_;
    if (process == 2) study.seed += 1;
    return study;
  };
  EXPECT_THAT(failure({}, other_seed), StartsWith("the sum of the readings is of another problem: readings "));
}

TEST_F(OneOfThreeProcesses, ThatHasAnotherModelIsFoundOut) {
  // Ends at the very first request, which tells of other parameters than there are.
  const auto other_model = [&](std::size_t process) {
    Study study = study_;
    if (process == 0) study.identification->motions.pop_back();
    return study;
  };
  EXPECT_EQ(failure({}, other_model), "process 0 has ended without its sum");
}

TEST_F(OneOfThreeProcesses, ThatAnswersAnEarlierRequestIsFoundOut) {
  std::optional<SumOfReadings> earlier;
  EXPECT_THAT(failure([&](std::size_t process, int, SumOfReadings& sum) {
                if (process != 1 || sum.kind != SumKind::normal) return;
                if (earlier)
                  sum = *earlier;
                else
                  earlier = sum;
              }),
              HasSubstr("are of different parameters"));
}

TEST_F(OneOfThreeProcesses, WhosePiecesAreMissingOrComeTwiceIsFoundOut) {
  EXPECT_THAT(failure({}, {}, [](std::vector<SumOfReadings>& parts) { parts.pop_back(); }), HasSubstr("is missing"));
  EXPECT_THAT(failure({}, {}, [](std::vector<SumOfReadings>& parts) { parts.push_back(parts[1]); }),
              HasSubstr("summed twice"));
}

TEST(StoppedIdentification, EndsWithItsSummingProcesses) {
  const Study study = example("trunnion/polygon-and-r-test.study.toml");
  SummingProcesses processes(2, [&](std::size_t) { return prepared_problem(study); });
  std::stop_source source;
  int sums = 0;
  RunOptions options;
  options.stop = source.get_token();
  options.summation = [&](const SumRequest& request, const std::stop_token& stop) {
    EXPECT_FALSE(stop.stop_requested());
    if (++sums == 3) source.request_stop();
    EXPECT_EQ(stop.stop_requested(), sums == 3);
    return merge_all(
        processes.sums(request, {share_of_pieces(request.pieces, 0, 2), share_of_pieces(request.pieces, 1, 2)}));
  };
  EXPECT_THROW(run_study(study, options), Stopped);
  EXPECT_EQ(sums, 3);
}

}  // namespace
}  // namespace abbe
