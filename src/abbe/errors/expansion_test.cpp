#include "abbe/errors/expansion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

Machine mill_with_warm_scales() {
  Machine mill = parse_chain("w X' b Y Z t").machine;
  for (Axis& axis : mill.axes) {
    axis.travel_min = 0;
    axis.travel_max = 800;
  }
  mill.axes[2].direction = {0, 0, -1};
  mill.axes[2].travel_max = 1700;
  mill.states.push_back({.name = "scale", .unit = "degC", .reference = 20});
  mill.states.push_back({.name = "load", .unit = "kg"});
  mill.states.push_back({.name = "side", .kind = StateKind::approach, .axis = 0});
  return mill;
}

ErrorSet errors_of(const Machine& machine, const ScaleExpansion& expansion) {
  ErrorSet errors;
  errors.motions = expansion_terms(machine, expansion);
  return errors;
}

/// Displacement of the tool against the workpiece at one place, mm, all axes at 300 mm.
Eigen::Vector3d shift_at(const Machine& machine, const ErrorSet& errors, double temperature) {
  const std::vector<double> at(machine.axes.size(), 300.0), given = {temperature, 0, 0};
  return actual_workpiece_from_tool(machine, errors, at, given).translation -
         nominal_workpiece_from_tool(machine, at).translation;
}

TEST(ScaleExpansion, AWarmScaleMakesEveryAxisMoveTooFar) {
  const Machine mill = mill_with_warm_scales();
  // 8 um/(m K), 5 K, 300 mm from 50 mm: 8 * 5 * 0.25 = 10 um farther than commanded. What a table carries goes the
  // other way, so the tool goes in the positive direction against the workpiece; Z points down.
  const double too_far = 8e-6 * 5 * 250;
  EXPECT_NEAR(too_far, 0.010, 1e-15);
  const Eigen::Vector3d expected[] = {{too_far, 0, 0}, {0, too_far, 0}, {0, 0, -too_far}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ScaleExpansion expansion{.axis = axis, .state = 0, .coefficient = 8e-6, .fixed_point = 50};
    const Eigen::Vector3d shift = shift_at(mill, errors_of(mill, expansion), 25);
    EXPECT_LT((shift - expected[axis]).norm(), 1e-12) << axis << ": " << shift.transpose();
    EXPECT_LT(shift_at(mill, errors_of(mill, expansion), 20).norm(), 1e-13) << "at the reference";
    expansion.fixed_point = 300;
    EXPECT_LT(shift_at(mill, errors_of(mill, expansion), 25).norm(), 1e-13) << "at the fixed point";
    // Independent: it stands as if too_far had been commanded besides.
    expansion.fixed_point = 50;
    std::vector<double> farther(3, 300.0);
    farther[axis] += too_far;
    const Eigen::Vector3d commanded = nominal_workpiece_from_tool(mill, farther).translation -
                                      nominal_workpiece_from_tool(mill, {300.0, 300.0, 300.0}).translation;
    EXPECT_LT((shift_at(mill, errors_of(mill, expansion), 25) - commanded).norm(), 1e-12);
  }
}

TEST(ScaleExpansion, CoversTheTravelWithACoefficientInUmPerMetre) {
  const Machine mill = mill_with_warm_scales();
  const ErrorMotion y = expansion_terms(mill, {.axis = 1, .state = 0, .coefficient = 11.5e-6})[0];
  EXPECT_NEAR(1e3 * y.coefficients[1], 11.5, 1e-12) << "um per K over one metre";
  const ErrorMotion z = expansion_terms(mill, {.axis = 2, .state = 0, .coefficient = 11.5e-6, .fixed_point = -50})[0];
  EXPECT_NEAR(1e3 * z.coefficients[1], -23, 1e-12) << "over two metres, against Z";
  EXPECT_TRUE(z.basis.covers(0) && z.basis.covers(1700));
  EXPECT_EQ(expansion_scale(mill, z), -2000);
}

TEST(ScaleExpansion, UncertaintiesOfCoefficientAndTemperatureAreIndependent) {
  const Machine mill = mill_with_warm_scales();
  const ScaleExpansion expansion{.axis = 1,
                                 .state = 0,
                                 .coefficient = 8e-6,
                                 .standard_uncertainty = 0.5e-6,
                                 .temperature_uncertainty = 0.2,
                                 .fixed_point = 0};
  const std::vector<ErrorMotion> terms = expansion_terms(mill, expansion);
  ASSERT_EQ(terms.size(), 2U);
  // At 1 m and 6 K: u^2 = (0.5 * 6)^2 + (8^2 + 0.5^2) 0.2^2 um^2.
  const double factor = 6;
  const double variance =
      std::pow(terms[0].standard_uncertainty[1] * factor, 2) + std::pow(terms[1].standard_uncertainty[1], 2);
  EXPECT_NEAR(variance, 1e-6 * (9 + 64.25 * 0.04), 1e-15);
  EXPECT_EQ(terms[1].state, kNoState);
  EXPECT_EQ(terms[1].coefficients, (std::vector<double>{0, 0}));
  EXPECT_TRUE(is_expansion_temperature(mill, errors_of(mill, expansion), 1));
  EXPECT_FALSE(is_expansion_temperature(mill, errors_of(mill, expansion), 0));
}

TEST(ScaleExpansion, IsRecognisedAmongErrorMotions) {
  const Machine mill = mill_with_warm_scales();
  const ScaleExpansion expansion{
      .axis = 0, .state = 0, .coefficient = 8.3e-6, .standard_uncertainty = 0.4e-6, .fixed_point = 120};
  ErrorMotion term = expansion_terms(mill, expansion)[0];
  const std::optional<ScaleExpansion> back = expansion_of(mill, term);
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->coefficient, expansion.coefficient, 1e-20);
  EXPECT_NEAR(back->standard_uncertainty, expansion.standard_uncertainty, 1e-20);
  EXPECT_NEAR(back->fixed_point, 120, 1e-12);
  term.coefficients[0] = 1e-6;
  EXPECT_FALSE(expansion_of(mill, term)) << "it does not pass through zero";
  term.coefficients[0] = 0;
  term.component = Component::Y;
  EXPECT_FALSE(expansion_of(mill, term));
  term.component = Component::X;
  term.basis.from += 1;
  EXPECT_FALSE(expansion_of(mill, term));
}

TEST(ScaleExpansion, SaysWhatCannotExpand) {
  Machine machine = mill_with_warm_scales();
  EXPECT_EQ(expansion_problem(machine, 0, 0).problem, "");
  EXPECT_EQ(expansion_problem(machine, 0, 1).problem, "load is not a temperature");
  EXPECT_EQ(expansion_problem(machine, 0, 2).field, "state");
  machine.axes[1].direction = Eigen::Vector3d(1, 1, 0).normalized();
  EXPECT_THAT(expansion_problem(machine, 1, 0).problem, testing::HasSubstr("parallel to none of X, Y, Z"));
  Machine turntable = parse_chain("w C' b Z t").machine;
  turntable.states = machine.states;
  EXPECT_THAT(expansion_problem(turntable, 0, 0).problem, testing::HasSubstr("rotary"));
}

}  // namespace
}  // namespace abbe
