#include "abbe/compensate/axis_directions.h"

#include <gtest/gtest.h>

#include <random>

namespace abbe {
namespace {

/// Moves an axis; true if that is another direction than before.
bool turns(AxisDirections& directions, double position) {
  const int before = directions.direction(0);
  directions.move(0, position);
  return directions.direction(0) != before;
}

TEST(AxisDirections, BeforeItMovesByMoreThanTheDeadBandAnAxisHasNone) {
  AxisDirections directions({0.5, 0.5});
  directions.stand(0, 10);
  EXPECT_FALSE(turns(directions, 10.4));
  EXPECT_FALSE(turns(directions, 9.95));
  EXPECT_EQ(directions.direction(0), 0);
  // From the highest place so far, not from where it began.
  EXPECT_TRUE(turns(directions, 9.85));
  EXPECT_EQ(directions.direction(0), -1);
  EXPECT_TRUE(directions.stands(0));
  EXPECT_FALSE(directions.stands(1));
}

TEST(AxisDirections, GoingBackByLessThanTheDeadBandIsNoReversal) {
  AxisDirections directions({0.5});
  directions.stand(0, 0);
  EXPECT_TRUE(turns(directions, 3));
  EXPECT_FALSE(turns(directions, 2.6));
  EXPECT_FALSE(turns(directions, 2.9));
  EXPECT_FALSE(turns(directions, 3.1));
  EXPECT_FALSE(turns(directions, 2.65));
  EXPECT_TRUE(turns(directions, 2.5));
  EXPECT_EQ(directions.direction(0), -1);
  EXPECT_FALSE(turns(directions, 2.5));
  EXPECT_EQ(directions.direction(0), -1);
  // Small steps add up.
  EXPECT_FALSE(turns(directions, 2.7));
  EXPECT_FALSE(turns(directions, 2.9));
  EXPECT_TRUE(turns(directions, 3.1));
  EXPECT_EQ(directions.direction(0), 1);
}

TEST(AxisDirections, ASmallerDeadBandHoldsFromTheNextMotionOn) {
  AxisDirections directions({0.5});
  directions.stand(0, 0);
  EXPECT_TRUE(turns(directions, 3));
  EXPECT_FALSE(turns(directions, 2.6));
  directions.set_dead_band(0, 0.2);
  EXPECT_EQ(directions.direction(0), 1);
  EXPECT_TRUE(turns(directions, 2.7));
  EXPECT_EQ(directions.direction(0), -1);
}

TEST(AxisDirections, AnAxisIsNeverBehindItsFurthestPlaceByMoreThanTheDeadBand) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  for (const double band : {0.1, 1.0, 3.0}) {
    AxisDirections directions({band});
    directions.stand(0, 0);
    double position = 0, furthest = 0;
    int turned = 0;
    for (int k = 0; k < 5000; ++k) {
      position += normal(generator);
      if (turns(directions, position)) {
        furthest = position;
        ++turned;
      }
      const int direction = directions.direction(0);
      if (direction == 0) continue;
      if ((position - furthest) * direction > 0) furthest = position;
      ASSERT_LE((furthest - position) * direction, band);
    }
    EXPECT_GE(turned, 100);
  }
}

}  // namespace
}  // namespace abbe
