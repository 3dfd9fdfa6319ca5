#include "abbe/identify/linkage/linkage_steps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

constexpr LinkageConvention kConventions[] = {LinkageConvention::table_moves, LinkageConvention::head_moves};

SwingHeadLinkage published() { return {240.745, 209.476, -0.265, -0.145, {-197.236, 25.306, -528.996}}; }

LinkageReadings published_commands(LinkageConvention convention) {
  return linkage_commands(published(), convention, 120, 4);
}

TEST(LinkageSteps, FocusAndBeamAreThoseOfTheMachine) {
  RandomStream random(3);
  for (const LinkageConvention convention : kConventions) {
    const bool table = convention == LinkageConvention::table_moves;
    Machine machine = test::yin_engraver(table ? 'U' : 'P');
    EXPECT_EQ(linkage_of(machine, convention).values()[1], published().values()[1]);
    const SwingHeadLinkage other = {231.5, 190.25, 0.5, -0.75, {11, -22, -333}};
    set_linkage(machine, other, convention);
    const auto back = linkage_of(machine, convention).values();
    for (std::size_t i = 0; i < back.size(); ++i) EXPECT_NEAR(back[i], other.values()[i], 1e-12) << i;
    for (int i = 0; i < 20; ++i) {
      const SwingHeadCommand c = {random.uniform(-300, 300), random.uniform(-300, 300), random.uniform(-300, 300),
                                  random.uniform(-2, 2), random.uniform(-3, 3)};
      std::vector<double> commands(6, 0.0);
      for (const auto& [name, value] : {std::pair{"X", c.x}, std::pair{"Y", c.y}, std::pair{"Z", c.z},
                                        std::pair{"A", c.a}, std::pair{"C1", c.c1}}) {
        commands[machine.find_axis(name)] = value;
      }
      const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
      EXPECT_LT((pose.translation - swing_head_focus(other, convention, c)).norm(), 1e-11);
      EXPECT_LT((pose.rotation.col(2) - swing_head_beam(c)).norm(), 1e-13);
    }
  }
}

TEST(LinkageSteps, ExactReadingsGiveEveryMachineBack) {
  RandomStream random(4);
  for (const LinkageConvention convention : kConventions) {
    for (int i = 0; i < 10; ++i) {
      const SwingHeadLinkage truth = {
          random.uniform(150, 300),
          random.uniform(100, 300),
          random.uniform(-1, 1),
          random.uniform(-1, 1),
          {random.uniform(-300, 300), random.uniform(-300, 300), random.uniform(-600, -400)}};
      // The operator knows the machine to half a millimetre only.
      SwingHeadLinkage about = truth;
      about.focus_to_a += 0.3;
      about.a_to_c1 -= 0.5;
      about.origin += Eigen::Vector3d(0.5, -0.5, 0.2);
      const LinkageReadings readings = simulate_linkage(truth, linkage_commands(about, convention, 110, 5), 0.03, 0.05);
      const LinkageEvaluation found = evaluate_linkage(readings, {});
      ASSERT_EQ(found.status, LinkageStatus::ok) << found.reason;
      for (std::size_t k = 0; k < SwingHeadLinkage::kCount; ++k) {
        EXPECT_NEAR(found.linkage.values()[k], truth.values()[k], 1e-9) << linkage_name(k);
      }
      EXPECT_GT(found.circle_arm.norm(), 0.1);  // the circle was a circle
    }
  }
}

TEST(LinkageSteps, StatedUncertaintiesAreThoseOfRepeatedMeasurements) {
  using Matrix7 = Eigen::Matrix<double, 7, 7>;
  for (const LinkageConvention convention : kConventions) {
    const LinkageReadings commands = published_commands(convention);
    const LinkageAccuracy accuracy = LinkageAccuracy::published();
    const std::vector<LinkageDisturbance> causes = linkage_disturbances(commands, accuracy);
    const LinkageEvaluation once = evaluate_linkage(simulate_linkage(published(), commands, 0.03, 0.05), accuracy);
    ASSERT_EQ(once.status, LinkageStatus::ok);
    constexpr int kRuns = 1500;
    Matrix7 sampled = Matrix7::Zero();
    RandomStream random(5);
    for (int run = 0; run < kRuns; ++run) {
      std::vector<double> disturbance;
      for (const LinkageDisturbance& cause : causes) {
        disturbance.push_back(cause.standard_uncertainty * random.normal());
      }
      // The covariance of a run is not wanted here: no accuracy, no sums over causes.
      const LinkageEvaluation found =
          evaluate_linkage(simulate_linkage(published(), commands, 0.03, 0.05, disturbance), {});
      ASSERT_EQ(found.status, LinkageStatus::ok);
      Eigen::Matrix<double, 7, 1> difference;
      for (std::size_t k = 0; k < 7; ++k) {
        difference[static_cast<Eigen::Index>(k)] = found.linkage.values()[k] - published().values()[k];
      }
      sampled += difference * difference.transpose() / kRuns;
    }
    // Whitened by the stated covariance the sampled one is the unit matrix within its own scatter.
    const SymmetricEigen<> stated(once.covariance);
    const Matrix7 whiten =
        stated.eigenvalues().cwiseInverse().cwiseSqrt().asDiagonal() * stated.eigenvectors().transpose();
    EXPECT_LT((whiten * sampled * whiten.transpose() - Matrix7::Identity()).cwiseAbs().maxCoeff(), 0.15);
  }
}

TEST(LinkageSteps, UncertaintiesWithTheAccuraciesOfTableOne) {
  // By hand: R_C1 from two positions of X and two readings; L_tA from two of Z, of A and of the microscope.
  const LinkageAccuracy accuracy = LinkageAccuracy::published();
  const LinkageEvaluation found = evaluate_linkage(
      simulate_linkage(published(), published_commands(LinkageConvention::table_moves), 0.03, 0.05), accuracy);
  ASSERT_EQ(found.status, LinkageStatus::ok);
  EXPECT_NEAR(found.standard_uncertainty(1), std::sqrt(2 * 2.77 * 2.77 + 2 * 2 * 2) / 2 * 1e-3, 2e-5);
  const double arm = 240.745 * accuracy.a;
  EXPECT_NEAR(found.standard_uncertainty(2), std::sqrt((2 * 3.55 * 3.55e-6 + 2 * 4e-6 + 2 * arm * arm) / 4 + arm * arm),
              2e-5);
  EXPECT_NEAR(found.standard_uncertainty(2), 3.8e-3, 0.1e-3);
  // The focus drops out of z0: the same board carries it in steps 2 and 5, which leaves two positions of Z.
  EXPECT_NEAR(found.standard_uncertainty(6), std::sqrt(2.0) * 3.55e-3, 2e-5);
  EXPECT_GT(found.standard_uncertainty(0), 2 * found.standard_uncertainty(6));
  double sum = 0;
  for (const LinkageShare& share : found.shares) sum += share.variance[0];
  EXPECT_NEAR(sum, found.covariance(0, 0), 1e-15);
  EXPECT_NEAR(found.standard_uncertainty(0), 12.4e-3, 0.1e-3);
  // A zero error of A moves L_tA and is hardly seen anywhere else: 1.17 um per arcsec.
  LinkageAccuracy zero;
  zero.zero_a = kDegree / 3600;
  const LinkageEvaluation turned = evaluate_linkage(
      simulate_linkage(published(), published_commands(LinkageConvention::table_moves), 0.03, 0.05), zero);
  EXPECT_NEAR(turned.standard_uncertainty(2), 1.17e-3, 0.005e-3);
}

/// Standard uncertainty of the focus by a parabola through width squared, from the formula: a linear combination of the
/// squares, each of standard uncertainty 2 w u(w).
double focus_uncertainty(const LinkageReadings& commands, double focus, double u_width, bool weighted) {
  const auto n = static_cast<Eigen::Index>(commands.focus_z.size());
  Eigen::MatrixXd rows(n, 3);
  Eigen::VectorXd u(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = commands.focus_z[static_cast<std::size_t>(i)] - focus, width = std::hypot(0.03, 0.05 * t);
    rows.row(i) << 1, t, t * t;
    u[i] = 2 * width * u_width;
  }
  const Eigen::VectorXd weight = weighted ? Eigen::VectorXd(u.cwiseAbs2().cwiseInverse()) : Eigen::VectorXd::Ones(n);
  const Eigen::MatrixXd from_squares =
      PartialLu(rows.transpose() * weight.asDiagonal() * rows).inverse() * rows.transpose() * weight.asDiagonal();
  // Lowest point of c0 + c2 t^2: its shift is -dc1 / (2 c2), c2 = 0.05^2.
  return (from_squares.row(1).transpose().cwiseProduct(u)).norm() / (2 * 0.05 * 0.05);
}

TEST(LinkageSteps, WhatTheFocusAndZ0AreKnownToDependsOnHowTheyAreRead) {
  const LinkageReadings commands = published_commands(LinkageConvention::table_moves);
  const LinkageReadings readings = simulate_linkage(published(), commands, 0.03, 0.05);
  LinkageAccuracy accuracy = LinkageAccuracy::published();
  constexpr double kFocus = -284.251, kZ = 3.55e-3;
  // Widths as good as positions of lines, 2 um: R_A 12.4 um, by the formula too.
  const LinkageEvaluation found = evaluate_linkage(readings, accuracy);
  const double focus = focus_uncertainty(commands, kFocus, 2e-3, true);
  EXPECT_NEAR(found.standard_uncertainty(0), std::hypot(focus, kZ), 0.1e-3);
  // 7.3 um is what an unweighted parabola gives if widths are known to 1 um, half of what a position of a line is.
  EXPECT_NEAR(std::hypot(focus_uncertainty(commands, kFocus, 1e-3, false), kZ), 7.3e-3, 0.1e-3);
  accuracy.width = 1e-3;
  EXPECT_NEAR(evaluate_linkage(readings, accuracy).standard_uncertainty(0), 6.9e-3, 0.1e-3);
  // z0 = z1 - d + (z3 - z2): the error of the focus is in R_A and in z3 alike and drops out, whatever the widths.
  EXPECT_NEAR(found.standard_uncertainty(6), std::sqrt(2.0) * kZ, 2e-5);
  EXPECT_NEAR(evaluate_linkage(readings, accuracy).standard_uncertainty(6), std::sqrt(2.0) * kZ, 2e-5);
  // 8.1 um counts it once: as if step 5 knew the focus without error where step 2 does not.
  EXPECT_NEAR(std::hypot(7.3e-3, kZ), 8.1e-3, 0.05e-3);
  // What the height of the focus at A = 0 needs is z0 + R_A, in which the focus counts once.
  const auto& c = found.covariance;
  EXPECT_NEAR(std::sqrt(c(0, 0) + c(6, 6) + 2 * c(0, 6)), std::hypot(focus, kZ), 0.1e-3);
  EXPECT_LT(c(0, 6), 0);
}

TEST(LinkageSteps, ParabolaFindsTheFocusTenTimesBetterThanTheThinnestLine) {
  LinkageReadings commands = published_commands(LinkageConvention::table_moves);
  LinkageAccuracy accuracy;
  accuracy.width = 2e-3;
  const std::size_t causes = linkage_disturbances(commands, accuracy).size();
  RandomStream random(6);
  double parabola = 0, thinnest = 0;
  for (int run = 0; run < 300; ++run) {
    std::vector<double> disturbance(causes, 0.0);
    const std::vector<LinkageDisturbance> list = linkage_disturbances(commands, accuracy);
    for (std::size_t i = 0; i < causes; ++i) disturbance[i] = list[i].standard_uncertainty * random.normal();
    const LinkageEvaluation found =
        evaluate_linkage(simulate_linkage(published(), commands, 0.03, 0.05, disturbance), {});
    ASSERT_EQ(found.status, LinkageStatus::ok);
    const double truth = -284.251;
    parabola += (found.focus_z - truth) * (found.focus_z - truth) / 300;
    thinnest += (found.thinnest_z - truth) * (found.thinnest_z - truth) / 300;
  }
  EXPECT_LT(std::sqrt(parabola), 0.0125);  // at best 2 um / (0.05 sqrt(25)) = 8 um, were the beam all divergence
  EXPECT_GT(std::sqrt(thinnest), 10 * std::sqrt(parabola));
}

TEST(LinkageSteps, WhatCannotBeEvaluatedIsRefused) {
  const LinkageReadings good =
      simulate_linkage(published(), published_commands(LinkageConvention::table_moves), 0.03, 0.05);
  LinkageReadings r = good;
  r.focus_z.resize(3), r.focus_width.resize(3);
  EXPECT_EQ(evaluate_linkage(r, {}).status, LinkageStatus::too_few_readings);
  r = good;
  for (double& z : r.focus_z) z += 2.5;
  r = simulate_linkage(published(), r, 0.03, 0.05);
  EXPECT_EQ(evaluate_linkage(r, {}).status, LinkageStatus::focus_outside);
  r = good;
  for (std::size_t i = 0; i < r.focus_z.size(); ++i) {
    const double t = static_cast<double>(i) - 12;
    r.focus_width[i] = std::sqrt(0.01 - 1e-5 * t * t);
  }
  EXPECT_EQ(evaluate_linkage(r, {}).status, LinkageStatus::no_focus);
  r = good;
  for (double& angle : r.table_angle) angle = 0.5;
  EXPECT_EQ(evaluate_linkage(r, {}).status, LinkageStatus::circle_undetermined);
  r = good;
  r.table_angle.resize(1), r.circle_marks.resize(1);
  EXPECT_EQ(evaluate_linkage(r, {}).status, LinkageStatus::too_few_readings);
}

}  // namespace
}  // namespace abbe
