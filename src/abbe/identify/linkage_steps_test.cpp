#include "abbe/identify/linkage_steps.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/errors/random_stream.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr LinkageConvention kConventions[] = {LinkageConvention::table_moves, LinkageConvention::head_moves};

SwingHeadLinkage published() { return {240.745, 209.476, -0.265, -0.145, {-197.236, 25.306, -528.996}}; }

LinkageReadings published_commands(LinkageConvention convention) {
  return linkage_commands(published(), convention, 120, 4);
}

nlohmann::json reference() {
  std::ifstream file(std::string(ABBE_GOLDEN) + "/yin/linkage_five_steps.json");
  return nlohmann::json::parse(file);
}

LinkageReadings readings_of(const nlohmann::json& raw, LinkageConvention convention) {
  LinkageReadings r;
  r.convention = convention;
  const nlohmann::json &two = raw["step2"], &three = raw["step3"], &four = raw["step4"], &five = raw["step5"];
  r.exit_z = two["z1"];
  r.focus_z = two["z"].get<std::vector<double>>();
  r.focus_width = two["width"].get<std::vector<double>>();
  r.exit_to_axis = two["d"];
  r.board_thickness = two["h"];
  r.height_first = three["height_l1"];
  r.height_second = three["height_l2"];
  r.x_first = four["x1"];
  r.x_second = four["x2"];
  r.line3_x = four["l3_x"];
  r.line5_x = four["l5_x"];
  r.line4_y = four["l4_y"];
  r.line6_y = four["l6_y"];
  r.circle_x = five["x3"];
  r.circle_y = five["y3"];
  r.circle_z = five["z3"];
  return r;
}

void expect_linkage(const SwingHeadLinkage& linkage, const nlohmann::json& expected, double tolerance) {
  const auto values = linkage.values();
  const char* names[] = {"R_A", "R_C1", "L_tA", "L_AC1", "x0", "y0", "z0"};
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(values[i], expected[names[i]].get<double>(), tolerance) << names[i];
  }
}

TEST(LinkageSteps, ReproduceTheReferenceCorrectedAndAsPrintedInBothConventions) {
  const nlohmann::json json = reference();
  for (const LinkageConvention convention : kConventions) {
    const nlohmann::json& part = json[convention == LinkageConvention::table_moves ? "U" : "P"];
    const LinkageEvaluation found = evaluate_linkage(readings_of(part["raw"], convention), {});
    ASSERT_EQ(found.status, LinkageStatus::ok) << found.reason;
    expect_linkage(found.linkage, part["recovered"], 1e-9);
    expect_linkage(found.printed, part["printed"], 1e-9);
    EXPECT_NEAR(found.waist, 2 * json["assumptions"]["w0"].get<double>(), 1e-9);
    EXPECT_NEAR(found.divergence, found.waist / json["assumptions"]["zR"].get<double>(), 1e-9);
    EXPECT_GT(std::abs(found.thinnest_z - found.focus_z), 0.03);  // a step of 0.1 mm is what the thinnest line knows
  }
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
    const Eigen::SelfAdjointEigenSolver<Matrix7> stated(once.covariance);
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
  // A zero error of A moves L_tA and is hardly seen anywhere else: 1.17 um per arcsec.
  LinkageAccuracy zero;
  zero.zero_a = kDegree / 3600;
  const LinkageEvaluation turned = evaluate_linkage(
      simulate_linkage(published(), published_commands(LinkageConvention::table_moves), 0.03, 0.05), zero);
  EXPECT_NEAR(turned.standard_uncertainty(2), 1.17e-3, 0.005e-3);
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
