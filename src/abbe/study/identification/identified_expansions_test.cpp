#include "abbe/study/identification/identified_expansions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "abbe/errors/expansion.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

Machine mill_with_three_scales() {
  Machine mill = parse_chain("w X' b Y Z t").machine;
  for (Axis& axis : mill.axes) {
    axis.travel_min = 0;
    axis.travel_max = 800;
  }
  mill.states.push_back({.name = "scale", .unit = "degC", .reference = 20});
  return mill;
}

/// X and Z of one thermometer, Y of another; the part that each has of its own, and what it shares, K.
constexpr double kOwn[3] = {0.1, 0.2, 0.15}, kShared[3] = {0.3, 0.25, 0.2}, kAlpha[3] = {8e-6, 9e-6, 11e-6};
constexpr double kUncertainAlpha = 0.5e-6;
constexpr const char* kThermometer[3] = {"A", "B", "A"};

IdentificationPlan plan_of_three_scales(const Machine& mill) {
  IdentificationPlan plan;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const ScaleExpansion expansion{.axis = axis,
                                   .state = 0,
                                   .coefficient = kAlpha[axis],
                                   .standard_uncertainty = kUncertainAlpha,
                                   .temperature_uncertainty = kOwn[axis],
                                   .thermometer = kThermometer[axis],
                                   .thermometer_uncertainty = kShared[axis]};
    for (const ErrorMotion& term : expansion_terms(mill, expansion)) {
      IdentifiedMotion motion{term.axis, term.component, term.basis, term.basis.order, term.state, false};
      const bool is_temperature = term.state == kNoState;
      motion.expansion = {SetupNumber::within(term.coefficients[1], term.standard_uncertainty[1]), is_temperature,
                          is_temperature ? expansion.thermometer : "",
                          is_temperature ? thermometer_effect(mill, expansion) : 0};
      plan.motions.push_back(motion);
    }
  }
  return plan;
}

ErrorSet errors_of_plan(const IdentificationPlan& plan) {
  ErrorSet errors;
  for (const IdentifiedMotion& one : plan.motions) {
    errors.motions.push_back(
        {one.axis, one.component, one.basis, {0, one.expansion->coefficient.value}, {}, one.state});
  }
  return errors;
}

/// Covariance of the three temperature terms over one metre, mm^2, from the products that they are.
Eigen::Matrix3d dense_covariance() {
  Eigen::Matrix3d covariance;
  const double sign[3] = {-1, 1, 1};  // X' carries the workpiece
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const bool same = std::string(kThermometer[i]) == kThermometer[j];
      covariance(i, j) = same ? 1e6 * sign[i] * sign[j] * kAlpha[i] * kAlpha[j] * kShared[i] * kShared[j] : 0;
    }
    const double size = kAlpha[i] * kAlpha[i] + kUncertainAlpha * kUncertainAlpha;
    covariance(i, i) = 1e6 * size * (kOwn[i] * kOwn[i] + kShared[i] * kShared[i]);
  }
  return covariance;
}

TEST(IdentifiedExpansions, PriorsOfOneThermometerHaveItsCovariance) {
  const Machine mill = mill_with_three_scales();
  const IdentificationPlan plan = plan_of_three_scales(mill);
  Problem problem;
  problem.machine = mill;
  problem.errors = errors_of_plan(plan);
  std::vector<std::size_t> temperature;
  for (const ExpansionParameters& one : expansion_parameters(plan, problem.errors)) {
    problem.machine_parameters.push_back(one.coefficient);
    if (one.identified->expansion->is_temperature) temperature.push_back(problem.machine_parameters.size() - 1);
  }
  ASSERT_EQ(temperature.size(), 3U);
  add_expansion_priors(plan, problem);
  EXPECT_EQ(problem.priors.size(), 3U) << "of the coefficients";
  EXPECT_EQ(problem.joint_priors.size(), 2U) << "one of each thermometer";
  EXPECT_EQ(prior_residual_count(problem), 6);
  const Eigen::MatrixXd rows = prior_rows(problem);
  const Eigen::MatrixXd covariance = Ldlt<>(rows.transpose() * rows).solve_columns(Eigen::MatrixXd::Identity(6, 6));
  const Eigen::Matrix3d expected = dense_covariance();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto k = static_cast<Eigen::Index>(temperature[static_cast<std::size_t>(i)]);
      const auto l = static_cast<Eigen::Index>(temperature[static_cast<std::size_t>(j)]);
      EXPECT_NEAR(covariance(k, l), expected(i, j), 1e-9 * expected(0, 0)) << i << " " << j;
    }
  }
  // Readings that show the temperature term of X narrow that of Z, and not that of Y: a Kalman update by hand.
  const double noise = 1e-4;
  const auto x = static_cast<Eigen::Index>(temperature[0]);
  Eigen::MatrixXd information = rows.transpose() * rows;
  information(x, x) += 1 / (noise * noise);
  const Eigen::MatrixXd posterior = Ldlt<>(information).solve_columns(Eigen::MatrixXd::Identity(6, 6));
  const auto z = static_cast<Eigen::Index>(temperature[2]), y = static_cast<Eigen::Index>(temperature[1]);
  const double gain = expected(2, 0) * expected(2, 0) / (expected(0, 0) + noise * noise);
  EXPECT_NEAR(posterior(z, z), expected(2, 2) - gain, 1e-9 * expected(2, 2));
  EXPECT_LT(posterior(z, z), 0.6 * expected(2, 2));
  EXPECT_NEAR(posterior(y, y), expected(1, 1), 1e-9 * expected(1, 1));
}

TEST(IdentifiedExpansions, TheTruthIsDrawnWithWhatThermometersShare) {
  const Machine mill = mill_with_three_scales();
  Study study;
  study.machine = mill;
  study.identification = plan_of_three_scales(mill);
  constexpr int kDraws = 20000;
  Eigen::Matrix3d found = Eigen::Matrix3d::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    ErrorSet errors;
    add_true_expansions(study, static_cast<std::uint64_t>(draw) + 1, errors);
    ASSERT_EQ(errors.motions.size(), 6U);
    Eigen::Vector3d terms;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(errors.motions[2 * axis + 1].state, kNoState);
      terms[static_cast<Eigen::Index>(axis)] = errors.motions[2 * axis + 1].coefficients[1];
    }
    found += terms * terms.transpose() / kDraws;
  }
  const Eigen::Matrix3d expected = dense_covariance();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(found(i, j), expected(i, j), 0.04 * std::sqrt(expected(i, i) * expected(j, j))) << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace abbe
