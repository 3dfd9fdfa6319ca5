#include "abbe/plan/readings/planning_design.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/plan/readings/random_candidates_for_test.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
using test::random_candidates;
using test::random_matrix;

ScoredCandidate best_instead(PlanDesign& design, std::size_t place) {
  const PlanDesign::Allowed rules;
  return design.best_instead({&place, 1}, {&rules, 1}).front();
}

struct DesignCase {
  std::size_t rows, functionals;  // rows of a candidate; without functionals: the determinant
};

class UpdatedDesign : public ::testing::TestWithParam<DesignCase> {
 protected:
  static Eigen::MatrixXd functionals_of(const PlanningSpace& space) {
    const auto count = static_cast<Index>(GetParam().functionals);
    return count > 0 ? space.functionals(random_matrix(count, 20, 5)) : Eigen::MatrixXd();
  }
};

TEST_P(UpdatedDesign, EqualsOneFactorisedAnew) {
  const PlanningCandidates candidates = random_candidates(200, GetParam().rows, 20, 3);
  const PlanningSpace space(candidates, random_matrix(4, 20, 9));
  const Eigen::MatrixXd functionals = functionals_of(space);
  PlanDesign updated(space, functionals, 2);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < 45 / GetParam().rows; ++i) chosen.push_back(i);
  ASSERT_TRUE(updated.rebuild(chosen, 0));
  RandomStream random(1);
  for (int step = 0; step < 100; ++step) {
    const std::size_t candidate = static_cast<std::size_t>(random.uniform() * 200);
    const std::size_t place = static_cast<std::size_t>(random.uniform() * static_cast<double>(updated.chosen().size()));
    const double before = updated.objective();
    if (step % 4 == 0) {
      const double gain = updated.gain(candidate);
      updated.add(candidate);
      EXPECT_NEAR(updated.objective() - before, gain, 1e-9 * std::abs(before));
    } else if (step % 4 == 1) {
      const double loss = updated.losses()[place];
      ASSERT_TRUE(updated.remove(place));
      EXPECT_NEAR(updated.objective() - before, loss, 1e-9 * std::abs(before));
    } else {
      const ScoredCandidate best = best_instead(updated, place);
      ASSERT_TRUE(updated.exchange(place, step % 4 == 2 ? best.candidate : candidate));
      if (step % 4 == 2) {
        EXPECT_NEAR(updated.objective() - before, best.change, 1e-9 * std::abs(before));
      }
    }
  }
  PlanDesign anew(space, functionals, 1);
  ASSERT_TRUE(anew.rebuild(updated.chosen(), 0));
  EXPECT_EQ(updated.updates(), 25u + 25u + 2 * 50u);
  EXPECT_NEAR(updated.objective(), anew.objective(), 1e-9 * std::abs(anew.objective()));
  for (std::size_t i = 0; i < 200; ++i) EXPECT_NEAR(updated.gain(i), anew.gain(i), 1e-9 * std::abs(anew.gain(i)));
  const std::vector<double> losses = updated.losses(), expected = anew.losses();
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(losses[i], expected[i], 1e-9 * std::abs(expected[i]));
}

TEST_P(UpdatedDesign, FindsTheBestOfAllWhateverTheBoundPassesOver) {
  const PlanningCandidates candidates = random_candidates(250, GetParam().rows, 20, 4);
  const PlanningSpace space(candidates, Eigen::MatrixXd());
  const Eigen::MatrixXd functionals = functionals_of(space);
  PlanDesign design(space, functionals, 2);
  std::vector<std::size_t> chosen, places;
  const std::size_t readings = 36 / GetParam().rows;
  for (std::size_t i = 0; i < readings; ++i) chosen.push_back(i);
  for (std::size_t i = 0; i < PlanDesign::kMostPlaces; ++i) places.push_back(i);
  ASSERT_TRUE(design.rebuild(chosen, 0));
  const std::vector<PlanDesign::Allowed> rules(places.size());
  const std::vector<ScoredCandidate> together = design.best_instead(places, rules);
  for (const std::size_t place : places) {
    const ScoredCandidate best = best_instead(design, place);
    EXPECT_EQ(together[place].candidate, best.candidate);
    EXPECT_EQ(together[place].change, best.change);
    // Every exchange by itself.
    double least = 1e300;
    for (std::size_t i = readings; i < 250; i += place == 0 ? 1 : 23) {
      PlanDesign other(space, functionals, 1);
      std::vector<std::size_t> exchanged = chosen;
      exchanged[place] = i;
      if (other.rebuild(exchanged, 0)) least = std::min(least, other.objective() - design.objective());
    }
    EXPECT_LE(best.change, least + 1e-9 * std::abs(design.objective()));
  }
}

INSTANTIATE_TEST_SUITE_P(ByCriterion, UpdatedDesign,
                         ::testing::Values(DesignCase{3, 0}, DesignCase{3, 30}, DesignCase{1, 0}, DesignCase{1, 30},
                                           DesignCase{2, 30}));

TEST(PlanningSpaceTest, ManyCandidatesMeasuredOnceHaveTheUnitMatrixAsInformation) {
  // More rows than one block of the factorisation has, and not a multiple of anything.
  const PlanningCandidates candidates = random_candidates(6671, 3, 13, 21);
  const Eigen::MatrixXd known = random_matrix(5, 13, 22);
  const PlanningSpace space(candidates, known, WorkInStep(), 1), same(candidates, known, WorkInStep(), 3);
  ASSERT_EQ(space.dimension(), 13u);
  Eigen::MatrixXd information = space.known_information();
  for (std::size_t k = 0; k < 3 * 6671; ++k) {
    const Eigen::Map<const Eigen::VectorXd> row(space.row(k), 13);
    information += row * row.transpose();
    EXPECT_EQ(row, Eigen::Map<const Eigen::VectorXd>(same.row(k), 13));
    for (std::size_t behind = 13; behind < space.stride(); ++behind) EXPECT_EQ(space.row(k)[behind], 0);
  }
  EXPECT_LT((information - Eigen::MatrixXd::Identity(13, 13)).norm(), 1e-11);
}

}  // namespace
}  // namespace abbe
