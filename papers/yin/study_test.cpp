#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "yin/results.h"

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
  // The other reading of Table 3 is another set of numbers: the inverse of the reference's matrix.
  expect_near({rotation_xyz(all.workpiece_to_table.angles), all.workpiece_to_table.translation},
              exact.workpiece_from_table.inverse(), 1e-9);
  EXPECT_GT((all.workpiece_to_table.translation - all.table_to_workpiece.translation).norm(), 100);
  // What is found is off the printed equations, (17) with t_z = z_sR - z_p and (18) with + (x1 - x0), by twice their
  // wrong terms.
  const Eigen::Vector3d o = found.table_from_scanner.rotation * found.on_axis;
  const Eigen::Vector3d moved = exact.scans.moved_since,
                        printed(moved.x() - o.x(), moved.y() - o.y(), o.z() - exact.scans.sphere_height);
  const Eigen::Vector3d wrong(moved.x(), moved.y(), o.z() - exact.scans.sphere_height);
  EXPECT_LT((printed - found.table_from_scanner.translation - 2 * wrong).norm(), 1e-9);
  EXPECT_GT(wrong.cwiseAbs().minCoeff(), 10);
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
  const YinScanFiles files = yin_scan_files(scans, "scans.csv");
  const ScannerPositioningFile file =
      parse_scanner_positioning(files.positioning, "x.positioning.toml", files.points, "scans.csv");
  ASSERT_TRUE(file.workpiece);
  EXPECT_EQ(file.workpiece->labels, scans.labels);
  EXPECT_EQ(file.scans.sphere_radius, scans.scans.sphere_radius);
  EXPECT_EQ(file.scans.moved_since, scans.scans.moved_since);
  EXPECT_EQ(file.scans.target_noise, scans.scans.target_noise);
  EXPECT_EQ(file.scans.height_noise, scans.scans.height_noise);
  EXPECT_TRUE(file.scans.turned_positively);
  EXPECT_NEAR(file.scans.sphere_height, scans.scans.sphere_height, 1e-6);
  EXPECT_LT((file.scans.circles.at(1).back() - scans.scans.circles[1].back()).norm(), 1e-6);
  EXPECT_LT((file.workpiece->points - scans.surface).cwiseAbs().maxCoeff(), 1e-6);
  expect_near(file.workpiece->start, scans.start, 1e-6);
  const std::vector<Shape> part = yin_part();
  ASSERT_EQ(file.workpiece->features.size(), part.size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    EXPECT_EQ(file.workpiece->features[i].kind, part[i].kind);
    EXPECT_EQ(file.workpiece->features[i].point, part[i].point);
    EXPECT_EQ(file.workpiece->features[i].direction, part[i].direction);
    EXPECT_EQ(file.workpiece->features[i].radius, part[i].radius);
  }
  // A name for each feature, and no mesh.
  EXPECT_THROW(scanner_positioning_text(file, "scans.csv", {"cylinder", "top"}), std::invalid_argument);
  EXPECT_THROW(positioning_targets(file, {}), std::invalid_argument);
  ScannerPositioningFile other = file;
  other.scans.turned_positively = false;
  other.workpiece.reset();
  EXPECT_NE(scanner_positioning_text(other, "s.csv").find("turned = \"negatively\""), std::string::npos);
  EXPECT_EQ(positioning_targets(other).size(), 5U);
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

/// The sections of one part; seconds under the sanitizers, therefore once for all tests.
const YinSections& part_sections() {
  static const YinSections sections = yin_sections(yin_positioning(), 5);
  return sections;
}

/// The first of them, not yet evaluated.
YinSections first_sections(std::size_t count) {
  YinSections few = part_sections();
  few.sections.resize(count);
  few.edge.resize(count);
  few.curvature.resize(count);
  return few;
}

TEST(YinSections, ShowWhereTheEdgesAreWhateverTheirRounding) {
  const YinSections& sections = part_sections();
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
  // The radius; noise of 2 um makes a rounding that 15 rays meet look 2.4 um smaller.
  EXPECT_NEAR(sections.rounding.mean, 15, 3);
  // And nothing of the machine: had it engraved all of it 50 um beside, P1 P2 would be the same.
  YinSections beside = first_sections(6);
  for (std::size_t i = 0; i < 6; ++i) {
    Eigen::Matrix2Xd& points = beside.sections[i].points;
    const double k = beside.curvature[i];
    // Along the surface, which falls away by k u^2 / 2.
    points.row(1).array() -= k * (0.05 * points.row(0).array() + 0.05 * 0.05 / 2);
    points.row(0).array() += 0.05;
  }
  evaluate_sections(beside);
  ASSERT_EQ(beside.refused, 0U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(beside.fits[i].corner.x() - sections.fits[i].corner.x(), 0.05, 1e-6);
    EXPECT_NEAR(beside.fits[i].rounding, sections.fits[i].rounding, 1e-6);
  }
  EXPECT_GT(beside.found.mean, 30);
}

TEST(YinSections, WithoutAnEdgeHaveNoPartInTheFigures) {
  EXPECT_EQ(part_sections().refused, 0U);
  YinSections sections = first_sections(5);
  // The others stay as they are; a zero for this one would take a fifth of the mean away.
  sections.sections[3].points = Eigen::Matrix2Xd(sections.sections[3].points.leftCols(12));
  evaluate_sections(sections);
  EXPECT_EQ(sections.refused, 1U);
  EXPECT_EQ(sections.fits[3].status, EdgeStatus::too_few_points);
  double found = 0, truth = 0;
  for (const std::size_t i : {0U, 1U, 2U, 4U}) {
    EXPECT_EQ(sections.fits[i].corner, part_sections().fits[i].corner);
    found += 1e3 * std::abs(sections.fits[i].corner.x()) / 4;
    truth += 1e3 * std::abs(sections.edge[i]) / 4;
  }
  EXPECT_NEAR(sections.found.mean, found, 1e-9);
  EXPECT_NEAR(sections.truth.mean, truth, 1e-9);
  EXPECT_LT(sections.largest_miss, 0.01);
}

/// Results in which everything was found.
YinResults whole_results() {
  YinResults r;
  r.table_moves = yin_steps(LinkageConvention::table_moves);
  r.head_moves = yin_steps(LinkageConvention::head_moves);
  r.positioning = yin_positioning();
  r.scans = yin_simulated_scans(2);
  r.located = yin_locate(r.scans);
  r.sections = first_sections(5);
  evaluate_sections(r.sections);
  BudgetOptions options;
  options.runs = options.runs_per_cause = 10;
  r.contour = yin_contour(r.positioning, options);
  r.joint.converged = true;
  judge(r);
  return r;
}

TEST(YinResults, EveryPublishedNumberSaysWhatTheOneHereIs) {
  YinResults r;
  r.table_moves = yin_steps(LinkageConvention::table_moves);
  r.positioning = yin_positioning();
  std::size_t set = 0;
  for (const PublishedNumber& row : yin_published(r)) {
    EXPECT_FALSE(row.note.empty()) << row.where;
    // Numbers that come out as they went in agree by construction.
    const bool is_input = row.where.starts_with("Table 2") || row.where.starts_with("Table 3");
    EXPECT_EQ(row.note.starts_with("set in the simulation"), is_input) << row.where;
    set += is_input ? 1U : 0U;
  }
  EXPECT_EQ(set, SwingHeadLinkage::kCount + 6);
  r.positioning.failure = "the scan does not determine the pose";
  for (const PublishedNumber& row : yin_published(r)) {
    if (row.where.starts_with("Table 2")) continue;
    EXPECT_EQ(row.note, r.positioning.failure) << row.where;
  }
  r.table_moves.found.status = LinkageStatus::not_run;
  r.table_moves.found.reason = "a line of step 2 has no width";
  for (const PublishedNumber& row : yin_published(r)) {
    if (!row.where.starts_with("Table 2")) continue;
    EXPECT_FALSE(row.here) << row.where;
    EXPECT_EQ(row.note, r.table_moves.found.reason) << row.where;
  }
  const std::vector<ReproducedTable> tables = yin_tables(r);
  ASSERT_EQ(tables[1].name, "table-2");
  for (const std::vector<ReproducedCell>& row : tables[1].rows) EXPECT_FALSE(row[2].has_value());
}

TEST(YinResults, WhatIsNotFoundIsSaidAndDoesNotAgree) {
  const YinResults whole = whole_results();
  ASSERT_TRUE(whole.agrees) << whole.failures.at(0);
  const auto expect_failure = [&](YinResults r, const std::string& words) {
    judge(r);
    EXPECT_FALSE(r.agrees) << words;
    ASSERT_EQ(r.failures.size(), 1U) << words;
    EXPECT_NE(r.failures[0].find(words), std::string::npos) << r.failures[0];
    const Reproduction made = yin_reproduction(r);
    EXPECT_EQ(reproduction_json(made)["failures"][0], r.failures[0]);
    EXPECT_FALSE(reproduction_json(made)["agrees_with_reference"]);
    EXPECT_NE(reproduction_page(made).find("Not found: " + r.failures[0]), std::string::npos);
    const std::string printed = reproduction_text(made);
    EXPECT_NE(printed.find("Not found\n  - " + r.failures[0].substr(0, 20)), std::string::npos) << printed;
    EXPECT_NE(printed.find("DOES NOT agree"), std::string::npos);
  };
  YinResults r = whole;
  r.sections.sections[3].points = Eigen::Matrix2Xd(r.sections.sections[3].points.leftCols(12));
  evaluate_sections(r.sections);
  expect_failure(r, "edge of section 4: fewer than 20 points");
  const auto tables = [](const YinResults& results) { return reproduction_json(yin_reproduction(results))["tables"]; };
  EXPECT_TRUE(tables(r)["sections"]["rows"][3]["contour_error_um"].is_null());

  r = whole;
  r.joint = {};
  r.joint.message = "not converged after 50 steps";
  expect_failure(r, "joint fit of marks: not converged after 50 steps");
  EXPECT_TRUE(tables(r)["table-2"]["rows"][0]["u_by_joint_fit_um"].is_null());  // not an uncertainty of zero

  r = whole;
  r.scans.scans.along_x.resize(1);
  r.located = yin_locate(r.scans);
  expect_failure(r, "simulated scanner: the scanner's position is not found");
  const nlohmann::ordered_json scans = yin_details(r)["positioning"]["simulated_scans"];
  EXPECT_EQ(scans.count("table_to_workpiece") + scans.count("chi_square_of_six"), 0U);
  EXPECT_EQ(scans.count("not_found"), 1U);

  r = whole;
  r.positioning.registration.status = FineRegistrationStatus::undetermined;
  place_workpiece(r.positioning);
  r.contour = {};
  r.sections = {};
  expect_failure(r, "the scan does not determine the pose");

  r = whole;
  r.head_moves.found.status = LinkageStatus::not_run;
  expect_failure(r, "five steps, P");
  EXPECT_EQ(yin_details(r)["linkage"]["P"].count("corrected"), 0U);
  EXPECT_EQ(yin_details(r)["linkage"]["P"].count("not_found"), 1U);

  r = whole;
  const auto conclusion = [&](std::size_t i) { return yin_reproduction(r).conclusions[i]; };
  r.joint.focus_by_steps = 0.01;
  r.joint.focus = 0.5 * r.joint.focus_by_steps;
  r.contour.across.mean = 14;
  EXPECT_NE(conclusion(0).find("the linkage better than"), std::string::npos) << conclusion(0);
  EXPECT_NE(conclusion(1).find(" is about what "), std::string::npos) << conclusion(1);
  r.joint.focus = 2 * r.joint.focus_by_steps;
  r.contour.across.mean = 5;
  EXPECT_NE(conclusion(0).find("the linkage no better than"), std::string::npos) << conclusion(0);
  EXPECT_NE(conclusion(1).find(" is larger than what "), std::string::npos) << conclusion(1);

  // A difference that is no number is no agreement.
  r = whole;
  r.positioning.largest_difference = std::nan("");
  judge(r);
  EXPECT_FALSE(r.agrees);
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
  EXPECT_LT(off.dot(Ldlt<>(joint.covariance).solve(off)), 24.3);  // 0.1 % of chi-square with 7
  EXPECT_LT(joint.focus, joint.focus_by_steps);
  // R_A and z0 share most of their errors: counted one by one they look worse than together.
  EXPECT_LT(joint.focus_by_steps, joint.focus_without_correlations);
}

}  // namespace
}  // namespace abbe
