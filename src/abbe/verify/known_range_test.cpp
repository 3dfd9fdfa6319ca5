#include "abbe/verify/known_range.h"

#include <gtest/gtest.h>

#include <numbers>

namespace abbe {
namespace {

constexpr double kWholeTurn = 2 * std::numbers::pi;

/// Table C, endless, and carriage X with a travel of 0 to 400 mm.
Machine table_and_carriage() {
  Machine machine;
  Axis table{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece, .primed = true};
  table.direction = Eigen::Vector3d::UnitZ();
  table.endless = true;
  Axis carriage{.name = "X", .kind = AxisKind::linear, .side = ChainSide::tool};
  carriage.travel_max = 400;
  machine.axes = {table, carriage};
  return machine;
}

ErrorSet known_over(std::size_t axis, const Basis& basis) {
  ErrorSet errors;
  errors.motions.push_back({axis, Component::X, basis, std::vector<double>(basis.size(), 0.0), {}});
  return errors;
}

Basis line_from_to(double from, double to) { return {.order = 1, .from = from, .to = to}; }

TEST(KnownRange, IsThatOfAllErrorMotionsOfTheAxis) {
  const Machine machine = table_and_carriage();
  ErrorSet errors = known_over(1, line_from_to(20, 380));
  errors.motions.push_back({1, Component::A, line_from_to(50, 400), {0, 0}, {}});
  const AxisRange range = known_range(machine, errors, 1, 9);
  EXPECT_EQ(range.from, 50);
  EXPECT_EQ(range.to, 380);
  EXPECT_EQ(range.count, 9U);
}

TEST(KnownRange, IsTheTravelWithoutErrorMotionsAndWithThoseThatHoldEverywhere) {
  const Machine machine = table_and_carriage();
  const AxisRange travel = known_range(machine, known_over(1, line_from_to(20, 380)), 0, 5);
  for (const double to : {kWholeTurn, 3 * kWholeTurn}) {
    const Basis turns{.kind = BasisKind::fourier, .order = 2, .from = 0, .to = to, .period = kWholeTurn};
    AxisRange whole = travel;
    EXPECT_FALSE(narrow_to_known_range(machine, known_over(0, turns), 0, whole));
    EXPECT_EQ(whole.to, travel.to);
  }
  const Basis half{.kind = BasisKind::fourier, .order = 2, .from = 0, .to = kWholeTurn / 2, .period = kWholeTurn};
  AxisRange narrowed = travel;
  EXPECT_TRUE(narrow_to_known_range(machine, known_over(0, half), 0, narrowed));
  EXPECT_EQ(narrowed.to, kWholeTurn / 2);
}

TEST(KnownRange, OfSeveralSetsIsWhatTheyHaveInCommon) {
  const Machine machine = table_and_carriage();
  const ErrorSet left = known_over(1, line_from_to(0, 250)), right = known_over(1, line_from_to(100, 400));
  const AxisRange common = common_known_ranges(machine, {&left, &right}, 9)[1];
  EXPECT_EQ(common.from, 100);
  EXPECT_EQ(common.to, 250);
  EXPECT_EQ(common.count, 9U);

  const ErrorSet touching = known_over(1, line_from_to(250, 400));
  const AxisRange place = common_known_ranges(machine, {&left, &touching}, 9)[1];
  EXPECT_TRUE(place.is_fixed());
  EXPECT_EQ(place.count, 1U);

  // Nothing in common: the first one stays, so that poses without a result are seen.
  const ErrorSet far = known_over(1, line_from_to(300, 400));
  const AxisRange first = common_known_ranges(machine, {&left, &far}, 9)[1];
  EXPECT_EQ(first.from, 0);
  EXPECT_EQ(first.to, 250);
}

}  // namespace
}  // namespace abbe
