#include "abbe/plan/readings/planning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/plan/readings/random_candidates_for_test.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
using test::random_candidates;
using test::random_matrix;

/// One row per point: the functions there.
template <typename Functions>
PlanningCandidates regression(const std::vector<double>& points, Index parameters, const Functions& functions) {
  PlanningCandidates candidates;
  candidates.rows.resize(static_cast<Index>(points.size()), parameters);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (Index j = 0; j < parameters; ++j) candidates.rows(static_cast<Index>(i), j) = functions(points[i], j);
  for (std::size_t i = 0; i <= points.size(); ++i) candidates.first_row.push_back(i);
  return candidates;
}

Eigen::MatrixXd information(const PlanningCandidates& candidates, const std::vector<std::size_t>& chosen) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(candidates.rows.cols(), candidates.rows.cols());
  for (const std::size_t i : chosen) {
    const auto rows =
        candidates.rows.middleRows(static_cast<Index>(candidates.first_row[i]),
                                   static_cast<Index>(candidates.first_row[i + 1] - candidates.first_row[i]));
    sum += rows.transpose() * rows;
  }
  return sum;
}

/// Smallest criterion over all choices of `count`, by trying every one.
double best_of_all(const PlanningCandidates& candidates, std::size_t count, const Eigen::MatrixXd& functionals) {
  double best = 1e300;
  std::vector<std::size_t> chosen(count);
  for (std::size_t i = 0; i < count; ++i) chosen[i] = i;
  while (true) {
    const Eigen::MatrixXd m = information(candidates, chosen);
    const double determinant = m.determinant();
    if (determinant > 1e-12)
      best = std::min(best, functionals.rows() > 0
                                ? (functionals * PartialLu(m).inverse() * functionals.transpose()).trace()
                                : -std::log(determinant));
    std::size_t k = count;
    while (k > 0 && chosen[k - 1] == candidates.count() - count + k - 1) --k;
    if (k == 0) return best;
    ++chosen[k - 1];
    for (std::size_t j = k; j < count; ++j) chosen[j] = chosen[j - 1] + 1;
  }
}

double criterion(const PlanningCandidates& candidates, const ReadingPlan& plan, const Eigen::MatrixXd& functionals) {
  const Eigen::MatrixXd m = information(candidates, plan.chosen);
  return functionals.rows() > 0 ? (functionals * PartialLu(m).inverse() * functionals.transpose()).trace()
                                : -std::log(m.determinant());
}

struct BruteForceCase {
  std::size_t candidates, rows, parameters, count, functionals;
};
class SmallPlan : public ::testing::TestWithParam<BruteForceCase> {};

TEST_P(SmallPlan, IsTheBestOfAllChoices) {
  const BruteForceCase c = GetParam();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const PlanningCandidates candidates = random_candidates(c.candidates, c.rows, c.parameters, seed);
    PlanningOptions options;
    options.count = c.count;
    options.starts = 20;
    options.pass_gain = 0;
    if (c.functionals > 0) {
      options.criterion = PlanningCriterion::variance;
      options.functionals = random_matrix(static_cast<Index>(c.functionals), static_cast<Index>(c.parameters), seed);
    }
    const PlanningSpace space(candidates, Eigen::MatrixXd());
    const ReadingPlan plan = plan_readings(space, options);
    ASSERT_EQ(plan.status, PlanningStatus::done);
    EXPECT_EQ(plan.chosen.size(), c.count);
    EXPECT_NEAR(criterion(candidates, plan, options.functionals), best_of_all(candidates, c.count, options.functionals),
                1e-9);
    if (c.functionals > 0) {
      EXPECT_NEAR(plan.value.variance, criterion(candidates, plan, options.functionals), 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(ByCriterion, SmallPlan,
                         ::testing::Values(BruteForceCase{12, 1, 3, 5, 0}, BruteForceCase{12, 1, 3, 5, 1},
                                           BruteForceCase{12, 1, 3, 5, 8}, BruteForceCase{11, 3, 5, 4, 0},
                                           BruteForceCase{11, 2, 4, 4, 6}, BruteForceCase{13, 1, 4, 4, 0}));

TEST(PlanningTest, CandidatesOfOneRowAndOfThreeAreChosenTogether) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    PlanningCandidates candidates = random_candidates(24, 1, 4, seed);
    candidates.first_row = {0};
    for (std::size_t i = 0; i < 12; ++i)
      candidates.first_row.push_back(candidates.first_row.back() + (i % 2 == 0 ? 1 : 3));
    PlanningOptions options;
    options.count = 4;
    options.starts = 20;
    options.pass_gain = 0;
    options.criterion = PlanningCriterion::variance;
    options.functionals = random_matrix(3, 4, seed);
    const ReadingPlan plan = plan_readings(PlanningSpace(candidates, Eigen::MatrixXd()), options);
    ASSERT_EQ(plan.status, PlanningStatus::done);
    EXPECT_NEAR(criterion(candidates, plan, options.functionals), best_of_all(candidates, 4, options.functionals),
                1e-9);
  }
}

TEST(PlanningTest, EveryExchangeImprovesTheCriterion) {
  const PlanningSpace space(random_candidates(300, 3, 24, 4), Eigen::MatrixXd());
  for (const bool variance : {false, true}) {
    PlanningOptions options;
    options.count = 14;
    if (variance) {
      options.criterion = PlanningCriterion::variance;
      options.functionals = random_matrix(10, 24, 6);
    }
    const ReadingPlan plan = plan_readings(space, options);
    ASSERT_GT(plan.exchanges, 1u);
    for (std::size_t k = 1; k <= plan.exchanges; ++k) EXPECT_LT(plan.history[k], plan.history[k - 1]);
    const double last = variance ? plan.value.variance : -plan.value.log_determinant;
    EXPECT_NEAR(plan.history.back(), last, 1e-8 * std::abs(last));
  }
}

TEST(PlanningTest, PolynomialsAreMeasuredAtTheLobattoPoints) {
  // Zeros of (1 - x^2) P_d'(x): Guest, Ann. Math. Statist. 29 (1958) 294; Hoel, ibid. 1134.
  const std::vector<std::vector<double>> lobatto = {{-1, 0, 1},
                                                    {-1, -std::sqrt(1 / 5.0), std::sqrt(1 / 5.0), 1},
                                                    {-1, -std::sqrt(3 / 7.0), 0, std::sqrt(3 / 7.0), 1}};
  std::vector<double> points;
  for (int i = 0; i <= 2000; ++i) points.push_back(-1 + 1e-3 * i);
  for (const std::vector<double>& expected : lobatto) {
    const Index parameters = static_cast<Index>(expected.size());
    const PlanningSpace space(regression(points, parameters, [](double x, Index j) { return std::pow(x, j); }),
                              Eigen::MatrixXd());
    PlanningOptions options;
    options.count = expected.size();
    options.pass_gain = 0;
    options.starts = 3;
    const ReadingPlan plan = plan_readings(space, options);
    ASSERT_EQ(plan.chosen.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(points[plan.chosen[k]], expected[k], 0.6e-3);
    // Twice as many readings: each of these points twice.
    options.count *= 2;
    options.repeats = 5;
    const ReadingPlan doubled = plan_readings(space, options);
    for (std::size_t k = 0; k < 2 * expected.size(); ++k)
      EXPECT_NEAR(points[doubled.chosen[k]], expected[k / 2], 1.6e-3);
  }
}

TEST(PlanningTest, HarmonicsAreMeasuredAtEqualAngles) {
  // Pukelsheim, Optimal Design of Experiments (1993), section 9.16: equally spaced points are D-optimal, M = n/2 I.
  const Index harmonics = 3;
  std::vector<double> angles;
  for (int i = 0; i < 420; ++i) angles.push_back(i * std::numbers::pi / 210);
  const PlanningCandidates candidates = regression(angles, 2 * harmonics + 1, [](double a, Index j) {
    const Index harmonic = (j + 1) / 2;
    const double k = static_cast<double>(harmonic);
    return j == 0 ? std::sqrt(0.5) : j % 2 == 1 ? std::cos(k * a) : std::sin(k * a);
  });
  PlanningOptions options;
  options.count = 7;
  options.starts = 5;
  options.pass_gain = 0;
  const ReadingPlan plan = plan_readings(PlanningSpace(candidates, Eigen::MatrixXd()), options);
  EXPECT_NEAR(std::log(information(candidates, plan.chosen).determinant()), 7 * std::log(3.5), 1e-9);
  for (std::size_t k = 1; k < 7; ++k) EXPECT_EQ(plan.chosen[k] - plan.chosen[k - 1], 60u);
}

TEST(PlanningTest, WhatNoCandidateSeesDoesNotMatter) {
  PlanningCandidates full = random_candidates(60, 2, 6, 7);
  PlanningOptions options;
  options.count = 8;
  const ReadingPlan expected = plan_readings(PlanningSpace(full, Eigen::MatrixXd()), options);
  // Two parameters that cannot be told from others, and one without any influence, with other units.
  PlanningCandidates gauge = full;
  gauge.rows.resize(full.rows.rows(), 9);
  gauge.rows << full.rows, 1e3 * full.rows.col(0), full.rows.col(1) - 2 * full.rows.col(2),
      Eigen::VectorXd::Zero(full.rows.rows());
  const PlanningSpace space(gauge, Eigen::MatrixXd());
  EXPECT_EQ(space.dimension(), 6u);
  EXPECT_EQ(space.unseen().cols(), 3);
  EXPECT_LT((gauge.rows * space.unseen()).cwiseAbs().maxCoeff(), 1e-9);
  const ReadingPlan plan = plan_readings(space, options);
  EXPECT_EQ(plan.chosen, expected.chosen);
  EXPECT_NEAR(plan.value.log_determinant, expected.value.log_determinant, 1e-9);
  Eigen::MatrixXd functionals = Eigen::MatrixXd::Zero(2, 9);
  functionals(0, 3) = 1;  // seen
  functionals(1, 8) = 1;  // not at all
  EXPECT_NEAR(space.unseen_part(functionals)[0], 0, 1e-12);
  EXPECT_NEAR(space.unseen_part(functionals)[1], 1, 1e-12);
  const Eigen::MatrixXd covariance = planned_covariance(space, plan.chosen);
  const Eigen::MatrixXd seen = PartialLu(information(full, plan.chosen)).inverse();
  EXPECT_NEAR(covariance(3, 3), seen(3, 3), 1e-9 * seen(3, 3));
}

TEST(PlanningTest, AWeaklySeenDirectionIsNotTakenForAnUnseenOne) {
  PlanningCandidates candidates = random_candidates(60, 2, 6, 8);
  // Only the last candidates tell the last two parameters apart, and hardly.
  for (Index i = 0; i < 120; ++i)
    candidates.rows(i, 5) = candidates.rows(i, 4) + (i >= 116 ? 1e-9 * candidates.rows(i, 5) : 0.0);
  const PlanningSpace space(candidates, Eigen::MatrixXd());
  EXPECT_EQ(space.dimension(), 6u);
  PlanningOptions options;
  options.count = 6;
  const ReadingPlan plan = plan_readings(space, options);
  ASSERT_EQ(plan.status, PlanningStatus::done);
  EXPECT_GE(plan.chosen.back(), 58u);
  const std::vector<std::size_t> blind = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_FALSE(value_of(space, blind, Eigen::MatrixXd()).determined);
  EXPECT_EQ(value_of(space, blind, Eigen::MatrixXd()).rank, 5u);
  EXPECT_EQ(planned_covariance(space, blind).size(), 0);
}

TEST(PlanningTest, ReadingsThatAreNoCandidatesAreValuedAlike) {
  const PlanningCandidates candidates = random_candidates(40, 2, 6, 8);
  const Eigen::MatrixXd known = random_matrix(2, 6, 1), functionals = random_matrix(4, 6, 2);
  const PlanningSpace space(candidates, known);
  const std::vector<std::size_t> first = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  PlanningCandidates others;
  others.rows = candidates.rows.topRows(20);
  others.first_row.assign(candidates.first_row.begin(), candidates.first_row.begin() + 11);
  const PlanValue chosen = value_of(space, first, functionals), other = value_of(space, others, functionals);
  EXPECT_NEAR(chosen.variance, other.variance, 1e-10 * chosen.variance);
  EXPECT_NEAR(chosen.log_determinant, other.log_determinant, 1e-9);
  EXPECT_EQ(other.cost, 10);
}

TEST(PlanningTest, KnownReadingsCount) {
  // What is known needs no reading: with x known, all readings go to y.
  PlanningCandidates candidates = random_candidates(20, 1, 2, 1);
  for (Index i = 0; i < 20; ++i) candidates.rows(i, i % 2) = 0;
  Eigen::MatrixXd known = Eigen::MatrixXd::Zero(1, 2);
  known(0, 0) = 1e4;
  PlanningOptions options;
  options.count = 5;
  const ReadingPlan plan = plan_readings(PlanningSpace(candidates, known), options);
  for (const std::size_t i : plan.chosen) EXPECT_EQ(i % 2, 0u);
}

TEST(PlanningTest, TheTimeIsKeptAndCheapReadingsArePreferred) {
  PlanningCandidates candidates = random_candidates(100, 1, 4, 2);
  candidates.rows.bottomRows(50) = candidates.rows.topRows(50);  // the same readings at a higher price
  for (std::size_t i = 0; i < 100; ++i) candidates.cost_s.push_back(i < 50 ? 2 + 0.1 * static_cast<double>(i % 7) : 9);
  const PlanningSpace space(candidates, Eigen::MatrixXd());
  PlanningOptions options;
  options.time_s = 60;
  const ReadingPlan plan = plan_readings(space, options);
  EXPECT_LE(plan.value.cost, 60);
  EXPECT_GT(plan.value.cost, 57);
  for (const std::size_t i : plan.chosen) EXPECT_LT(i, 50u);
  options.time_s = 6;  // three readings cannot determine four parameters
  EXPECT_EQ(plan_readings(space, options).status, PlanningStatus::not_determined);
  options.time_s = 1;
  EXPECT_EQ(plan_readings(space, options).status, PlanningStatus::nothing_fits);
}

TEST(PlanningTest, TheResultDoesNotDependOnTheNumberOfThreads) {
  const PlanningSpace space(random_candidates(1500, 3, 60, 5), Eigen::MatrixXd());
  PlanningOptions options;
  options.criterion = PlanningCriterion::variance;
  options.functionals = random_matrix(60, 60, 3);
  options.count = 40;
  options.most_passes = 1;
  options.threads = 1;
  const ReadingPlan one = plan_readings(space, options);
  options.threads = 2;
  const ReadingPlan two = plan_readings(space, options);
  EXPECT_EQ(one.chosen, two.chosen);
  EXPECT_EQ(one.history, two.history);
  EXPECT_GT(one.exchanges, 0u);
}

TEST(PlanningTest, FunctionalsThatLeaveDirectionsOpenStillGetAPlanForAll) {
  // Only one parameter is asked for, and the number of readings just determines all.
  const PlanningCandidates candidates = random_candidates(80, 1, 8, 6);
  PlanningOptions options;
  options.criterion = PlanningCriterion::variance;
  options.functionals = Eigen::MatrixXd::Zero(1, 8);
  options.functionals(0, 2) = 1;
  options.count = 8;
  const PlanningSpace space(candidates, Eigen::MatrixXd());
  EXPECT_EQ(plan_readings(space, options).status, PlanningStatus::done);
  options.count = 7;
  EXPECT_EQ(plan_readings(space, options).status, PlanningStatus::not_determined);
}

TEST(PlanningTest, TheCurveFallsAndSaysWhereItOnlyAverages) {
  const PlanningCandidates candidates = random_candidates(400, 1, 12, 6);
  const PlanningSpace space(candidates, Eigen::MatrixXd());
  PlanningOptions options;
  options.criterion = PlanningCriterion::variance;
  options.functionals = Eigen::MatrixXd::Identity(12, 12);
  const std::vector<std::size_t> counts = {6, 12, 14, 18, 24, 36, 60, 100};
  const std::vector<ReadingPlan> curve = plan_curve(space, options, counts);
  ASSERT_EQ(curve.size(), counts.size());
  EXPECT_EQ(curve[0].status, PlanningStatus::not_determined);
  std::vector<double> uncertainty;
  for (std::size_t k = 1; k < counts.size(); ++k) {
    ASSERT_EQ(curve[k].status, PlanningStatus::done);
    EXPECT_EQ(curve[k].chosen.size(), counts[k]);
    uncertainty.push_back(std::sqrt(curve[k].value.variance));
    if (k > 1) {
      EXPECT_LT(uncertainty[k - 1], uncertainty[k - 2]);
    }
  }
  const std::size_t enough = enough_points(std::span(counts).subspan(1), uncertainty);
  EXPECT_GT(enough, 0u);
  EXPECT_LT(enough, 6u);
}

TEST(PlanningTest, EnoughIsWhereOnlyNoiseIsAveraged) {
  const std::vector<std::size_t> counts = {10, 20, 40, 80, 160};
  // Halved, more than halved, then falling with the root.
  EXPECT_EQ(enough_points(counts, std::vector<double>{100, 30, 12, 8.5, 6}), 2u);
  EXPECT_EQ(enough_points(counts, std::vector<double>{100, 30, 12, 5, 2}), 5u);
  EXPECT_EQ(enough_points(counts, std::vector<double>{10, 8, 6, 5, 4}), 0u);
}

TEST(PlanningTest, RefusesWhatDoesNotAgree) {
  PlanningCandidates candidates = random_candidates(5, 2, 3, 1);
  candidates.cost_s = {1, 1, 0, 1, 1};
  EXPECT_THROW(PlanningSpace(candidates, Eigen::MatrixXd()), std::invalid_argument);
  candidates.cost_s.clear();
  candidates.rows(3, 1) = std::nan("");
  EXPECT_THROW(PlanningSpace(candidates, Eigen::MatrixXd()), std::invalid_argument);
  candidates.rows(3, 1) = 1;
  const PlanningSpace space(candidates, Eigen::MatrixXd());
  EXPECT_THROW(plan_readings(space, {}), std::invalid_argument);
  PlanningOptions options;
  options.count = 3;
  options.criterion = PlanningCriterion::variance;
  EXPECT_THROW(plan_readings(space, options), std::invalid_argument);
}

/// Rounding differs between processors (vectors of other lengths, fused products); the plan must not. Readings of a
/// symmetric machine are worth the same in groups of eight and more.
TEST(PlanningTest, ReadingsThatAreWorthTheSameAreChosenAlikeWhateverTheRounding) {
  PlanningCandidates candidates;
  candidates.rows.resize(11 * 11 * 2, 7);
  for (Index i = 0; i < candidates.rows.rows(); ++i) {
    const Index column = i / 2 % 11, row = i / 22;
    const double x = static_cast<double>(column - 5) / 5, y = static_cast<double>(row - 5) / 5;
    const double sign = i % 2 == 0 ? 1 : -1;
    candidates.rows.row(i) << 1, x, y, x * x, x * y, y * y, sign;
  }
  for (std::size_t i = 0; i <= static_cast<std::size_t>(candidates.rows.rows()); ++i) candidates.first_row.push_back(i);
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(7, 7);
  for (const bool by_time : {false, true}) {
    for (const PlanningCriterion criterion : {PlanningCriterion::determinant, PlanningCriterion::variance}) {
      PlanningOptions options;
      options.criterion = criterion;
      if (criterion == PlanningCriterion::variance) options.functionals = unit;
      if (by_time) {
        options.time_s = 100;
        for (std::size_t i = 0; i < candidates.count(); ++i) candidates.cost_s.push_back(i % 3 == 0 ? 2 : 3);
      } else {
        options.count = 25;
        candidates.cost_s.clear();
      }
      options.starts = 3;
      const ReadingPlan plan = plan_readings(PlanningSpace(candidates, Eigen::MatrixXd()), options);
      ASSERT_EQ(plan.status, PlanningStatus::done);
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        RandomStream random(seed);
        PlanningCandidates rounded = candidates;
        for (double& value : rounded.rows.reshaped()) value *= 1 + 4e-16 * random.uniform(-1, 1);
        const ReadingPlan other = plan_readings(PlanningSpace(rounded, Eigen::MatrixXd()), options);
        EXPECT_EQ(other.chosen, plan.chosen) << "criterion " << static_cast<int>(criterion) << ", seed " << seed;
      }
      candidates.cost_s.clear();
    }
  }
}

}  // namespace
}  // namespace abbe
