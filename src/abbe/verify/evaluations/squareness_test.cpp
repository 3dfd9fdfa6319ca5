#include "abbe/verify/evaluations/squareness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace abbe {
namespace {

TEST(Squareness, SlopesThatTurnTheLinesTowardsEachOtherMakeTheAngleSmaller) {
  const std::vector<double> x{0, 250, 500}, along_x{0, 0.0025, 0.005}, y{0, 200, 400}, along_y{0.001, 0.009, 0.017};
  const Squareness result = squareness({x, along_x}, {y, along_y}, {.artefact = 5e-6});
  ASSERT_EQ(result.status, StraightnessStatus::done);
  // 10 urad and 40 urad, less the 5 urad by which the reference square is too open.
  EXPECT_NEAR(result.value, -45e-6, 1e-12);
  EXPECT_NEAR(result.uncertainty, 0, 1e-12);
}

TEST(Squareness, DoesNotDependOnHowTheSquareLiesOnTheTable) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 1e-3);
  for (const ReferenceLine reference : {ReferenceLine::least_squares, ReferenceLine::minimum_zone}) {
    std::vector<double> x, first, second, first_turned, second_turned;
    const double turned = 3e-4;  // the square turned counterclockwise: the arms read less and more
    for (int i = 0; i < 30; ++i) {
      x.push_back(20.0 * i);
      first.push_back(noise(random));
      second.push_back(noise(random) + 1e-4 * x.back());
      first_turned.push_back(first.back() - std::tan(turned) * x.back());
      second_turned.push_back(second.back() + std::tan(turned) * x.back());
    }
    const SquarenessOptions options{.reference = reference};
    const double plain = squareness({x, first}, {x, second}, options).value;
    EXPECT_NEAR(squareness({x, first_turned}, {x, second_turned}, options).value, plain, 1e-10);
  }
}

TEST(Squareness, StandardUncertaintyAgreesWithRepeatedSimulation) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise(0, 5e-4);
  std::vector<double> x;
  for (int i = 0; i < 15; ++i) x.push_back(30.0 * i);
  double squares = 0, stated = 0;
  const int repetitions = 3000;
  for (int k = 0; k < repetitions; ++k) {
    std::vector<double> first, second;
    for (std::size_t i = 0; i < x.size(); ++i) {
      first.push_back(noise(random));
      second.push_back(noise(random));
    }
    const Squareness result = squareness({x, first}, {x, second});
    squares += result.value * result.value / repetitions;
    stated += result.uncertainty * result.uncertainty / repetitions;
  }
  EXPECT_NEAR(std::sqrt(stated / squares), 1, 0.05);
  // What is stated and is larger than the scatter counts instead; the artefact adds to it.
  const std::vector<double> straight(x.size(), 0.0);
  double spread = 0;
  for (const double position : x) spread += (position - 210) * (position - 210);
  const Squareness result =
      squareness({x, straight}, {x, straight}, {.reading_uncertainty = 1e-3, .artefact_uncertainty = 2e-6});
  EXPECT_NEAR(result.uncertainty, std::sqrt(2 * 1e-6 / spread + 4e-12), 1e-15);
}

TEST(Squareness, OfALineWithTwoPositionsIsNotGiven) {
  const std::vector<double> good{0, 1, 2}, short_line{0, 1}, zero{0, 0, 0}, short_zero{0, 0};
  EXPECT_EQ(squareness({good, zero}, {short_line, short_zero}).status, StraightnessStatus::too_few_positions);
  EXPECT_EQ(squareness({short_line, short_zero}, {good, zero}).status, StraightnessStatus::too_few_positions);
}

}  // namespace
}  // namespace abbe
