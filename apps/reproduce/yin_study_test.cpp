#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "abbe/geometry/rotation.h"
#include "reproduce/yin_contour.h"
#include "reproduce/yin_marks.h"
#include "reproduce/yin_scans.h"

namespace abbe {
namespace {

constexpr LinkageConvention kConventions[] = {LinkageConvention::table_moves, LinkageConvention::head_moves};

void expect_near(const RigidTransform& a, const RigidTransform& b, double mm) {
  EXPECT_LT((a.translation - b.translation).norm(), mm);
  EXPECT_LT((a.rotation - b.rotation).norm(), 1e-12);
}

TEST(YinReference, TheFiveStepsGiveItCorrectedAndAsPrintedInBothConventions) {
  for (const LinkageConvention convention : kConventions) {
    const YinLinkageReference reference = yin_linkage_reference(convention);
    const LinkageEvaluation found = evaluate_linkage(reference.readings, {});
    ASSERT_EQ(found.status, LinkageStatus::ok) << found.reason;
    for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
      EXPECT_NEAR(found.linkage.values()[i], reference.recovered[i], 1e-9) << linkage_name(i);
      EXPECT_NEAR(found.printed.values()[i], reference.printed[i], 1e-9) << linkage_name(i);
      EXPECT_NEAR(reference.recovered[i], yin_linkage().values()[i], 1e-9) << linkage_name(i);
    }
    EXPECT_NEAR(found.waist, reference.waist, 1e-9);
    EXPECT_NEAR(found.divergence, reference.divergence, 1e-9);
    EXPECT_GT(std::abs(found.thinnest_z - found.focus_z), 0.03);  // a step of 0.1 mm is what the thinnest line knows
    EXPECT_LT(yin_steps(convention).largest_difference, 1e-9);
  }
}

TEST(YinReference, PositioningMeetsItInEveryStep) {
  const YinPositioningReference exact = yin_positioning_reference();
  const ScannerPosition found = locate_scanner(exact.scans);
  ASSERT_EQ(found.status, PositioningStatus::ok) << found.reason;
  EXPECT_LT((found.x_direction - exact.x_direction).norm(), 1e-12);
  EXPECT_LT((found.y_direction - exact.y_direction).norm(), 1e-12);
  EXPECT_LT((found.axis_direction - exact.axis_direction).norm(), 1e-12);
  EXPECT_LT((found.sphere_centre - exact.sphere_centre).norm(), 1e-9);
  EXPECT_LT((found.on_axis - exact.on_axis).norm(), 1e-9);
  EXPECT_LT((found.table_from_scanner.rotation * found.on_axis - exact.on_axis_turned).norm(), 1e-9);
  expect_near(found.table_from_scanner, exact.table_from_scanner, 1e-9);
  EXPECT_LT(found.axis_tilt.norm() + std::abs(found.squareness), 1e-12);
  const YinPositioning all = yin_positioning();
  expect_near(all.registration.mesh_from_scan, exact.workpiece_from_scanner, 1e-9);
  expect_near(all.placement.table_from_workpiece.inverse(), exact.workpiece_from_table, 1e-9);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(all.table_to_workpiece.translation[i], exact.parameters[k], 1e-9);
    EXPECT_NEAR(all.table_to_workpiece.angles[i] * 180 / std::numbers::pi, exact.parameters[k + 3], 1e-10);
  }
  // The other reading of Table 3 is another set of numbers.
  expect_near({rotation_xyz(all.workpiece_to_table.angles), all.workpiece_to_table.translation},
              all.placement.table_from_workpiece, 1e-9);
  EXPECT_GT((all.workpiece_to_table.translation + all.table_to_workpiece.translation).norm(), 0.1);
  // As printed: (17) with t_z = z_sR - z_p, (18) with + (x1 - x0).
  const Eigen::Vector3d& o = exact.on_axis_turned;
  const Eigen::Vector3d printed(150 - o.x(), -60 - o.y(), o.z() - 95);
  EXPECT_LT((printed - exact.table_from_scanner.translation - Eigen::Vector3d(300, -120, 2 * (o.z() - 95))).norm(),
            1e-6);
}

TEST(YinScans, WhatIsHiddenIsMissingAndTheRestLocatesTheWorkpieceWithinItsCovariance) {
  double squares = 0;
  constexpr int kRuns = 12;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const YinScans scans = yin_simulated_scans(seed);
    EXPECT_LT(scans.targets_seen, scans.targets_placed);
    EXPECT_GT(scans.targets_seen, scans.targets_placed * 4 / 5);
    EXPECT_LT(scans.surface_seen, scans.surface_placed);
    const YinScansFound found = yin_locate(scans);
    ASSERT_EQ(found.positioning.scanner.status, PositioningStatus::ok) << found.positioning.scanner.reason;
    ASSERT_EQ(found.positioning.registration.status, FineRegistrationStatus::ok);
    EXPECT_LT(found.positioning.largest_difference, 0.1);
    squares += found.chi_square / 6 / kRuns;
  }
  // 72 degrees of freedom: 1 within three times sqrt(2 / 72).
  EXPECT_NEAR(squares, 1, 0.5);
}

TEST(YinScans, AreReadBackFromTheirFilesWithTheSameAnswer) {
  const YinScans scans = yin_simulated_scans(3);
  const ScannerPositioningFile file = parse_scanner_positioning(
      yin_positioning_text(scans, "scans.csv"), "x.positioning.toml", target_points_csv(scans.targets), "scans.csv");
  ASSERT_TRUE(file.workpiece);
  EXPECT_EQ(file.workpiece->labels, scans.labels);
  const ScannerPosition direct = locate_scanner(scans.scans), read = locate_scanner(file.scans);
  ASSERT_EQ(read.status, PositioningStatus::ok) << read.reason;
  EXPECT_LT((direct.table_from_scanner.translation - read.table_from_scanner.translation).norm(), 1e-4);
  EXPECT_NEAR(direct.covariance(0, 0), read.covariance(0, 0), 1e-6 * direct.covariance(0, 0));
}

TEST(YinContour, BudgetsBySensitivityAndByMonteCarloAgreeAndPredictWhatThePaperMeasured) {
  BudgetOptions options;
  options.runs = 400;
  options.runs_per_cause = 60;
  options.seed = 7;
  const YinContour contour = yin_contour(yin_positioning(), options);
  EXPECT_LT(contour.budget.largest_disagreement(), 3.7);
  ASSERT_FALSE(contour.budget.lines.empty());
  EXPECT_EQ(contour.budget.lines.front().cause, "placement of the workpiece");
  double shares = 0;
  for (std::size_t i = 0; i < contour.budget.lines.size(); ++i) {
    shares += contour.budget.lines[i].share;
    EXPECT_LE(contour.budget.lines[i].share, contour.budget.lines[i > 0 ? i - 1 : 0].share);
  }
  EXPECT_NEAR(shares, 1, 1e-12);
  // The paper's one part lies within what 95 % of machines stay below.
  EXPECT_GT(contour.upper.mean, 15.1);
  EXPECT_GT(contour.upper.largest, 29.5);
  EXPECT_GT(contour.upper.deviation, 6.8);
  EXPECT_NEAR(contour.printed_l_ta, 217, 15);
}

TEST(YinSections, ShowWhereTheEdgesAreWhateverTheirRounding) {
  const YinSections sections = yin_sections(yin_positioning(), 5);
  ASSERT_EQ(sections.fits.size(), 30U);
  double squares = 0;
  for (std::size_t i = 0; i < 30; ++i) {
    const EdgeFit& fit = sections.fits[i];
    ASSERT_EQ(fit.status, EdgeStatus::ok) << fit.reason;
    const double u = std::hypot(fit.corner_uncertainty(), 2e-3);
    squares += std::pow((fit.corner.x() - sections.edge[i]) / u, 2) / 30;
  }
  EXPECT_NEAR(squares, 1, 0.78);  // three times sqrt(2 / 30)
  EXPECT_NEAR(sections.found.mean, sections.truth.mean, 2);
  // The radius, and nothing of the machine; noise of 2 um makes a rounding that 15 rays meet look 2.4 um smaller.
  EXPECT_NEAR(sections.rounding.mean, 15, 3);
  EXPECT_GT(std::abs(sections.truth.mean - 15) + sections.truth.largest, 5);
}

TEST(YinMarks, OneFitOfMarksDeterminesAllSevenParametersBetterThanTheFiveSteps) {
  const YinSteps steps = yin_steps(LinkageConvention::table_moves);
  const YinJointFit joint = yin_joint_fit(steps.found);
  ASSERT_TRUE(joint.converged) << joint.message;
  Eigen::Matrix<double, 7, 1> off;
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    off[static_cast<Eigen::Index>(i)] = joint.found.values()[i] - joint.truth.values()[i];
    EXPECT_GT(joint.standard_uncertainty(i), 0) << linkage_name(i);
  }
  EXPECT_LT(off.dot(joint.covariance.ldlt().solve(off)), 24.3);  // 0.1 % of chi-square with 7
  EXPECT_LT(joint.focus, joint.focus_by_steps);
  // R_A and z0 share most of their errors: counted one by one they look worse than together.
  EXPECT_LT(joint.focus_by_steps, joint.focus_without_correlations);
}

}  // namespace
}  // namespace abbe
