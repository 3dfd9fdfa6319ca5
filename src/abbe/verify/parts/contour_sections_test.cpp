#include "abbe/verify/parts/contour_sections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace abbe {
namespace {

/// A sharp-edged section with a rounding of 20 um: surface, quarter of a circle, wall; its corner at `across`.
SectionReadings rounded_section(double across) {
  constexpr int kEach = 80;
  constexpr double kEdgeRadius = 0.02;
  SectionReadings section;
  section.name = "s";
  section.points.resize(2, 3 * kEach);
  for (int i = 0; i < kEach; ++i) {
    const double t = (i + 0.5) / kEach, angle = std::numbers::pi / 2 * (1 - t);
    section.points.col(i) = Eigen::Vector2d(across - kEdgeRadius - 0.3 * (1 - t), 0);
    section.points.col(kEach + i) = Eigen::Vector2d(across - kEdgeRadius + kEdgeRadius * std::cos(angle),
                                                    -kEdgeRadius + kEdgeRadius * std::sin(angle));
    section.points.col(2 * kEach + i) = Eigen::Vector2d(across, -kEdgeRadius - 0.12 * t);
  }
  return section;
}

TEST(ContourSections, FiguresAreThoseOfTheSectionsThatAreEvaluated) {
  std::vector<SectionReadings> sections = {rounded_section(0.003), rounded_section(-0.005), rounded_section(0.001)};
  sections.push_back({"too few", sections[0].points.leftCols(3), {}, {}});
  const SectionsEvaluation all = evaluate_sections(sections, {});
  ASSERT_EQ(all.answers.size(), 4U);
  EXPECT_EQ(all.refused, 1U);
  EXPECT_EQ(all.evaluated(), 3U);
  EXPECT_FALSE(all.answers[3].ok);
  EXPECT_NE(all.answers[3].reason, "");
  EXPECT_EQ(all.largest, 1U);
  EXPECT_NEAR(all.answers[1].error, -0.005, 1e-7);
  EXPECT_NEAR(all.contour.amounts.mean, 0.003, 1e-7);
  EXPECT_NEAR(all.contour.bias, -0.001 / 3, 1e-7);
  EXPECT_NEAR(all.contour.amounts.maximum, 0.005, 1e-7);
  EXPECT_NEAR(all.rounding.amounts.mean, 0.02, 1e-6);
  EXPECT_NEAR(all.radius, 0.02, 1e-6);
  EXPECT_FALSE(along_is_stated(sections));
  const SectionsEvaluation none = evaluate_sections({sections[3]}, {});
  EXPECT_EQ(none.evaluated(), 0U);
  EXPECT_EQ(none.largest, 1U);
}

TEST(ContourSections, PointsAreCountedByWhatIsKnownOfThem) {
  Eigen::Matrix3Xd curve(3, 3), normals(3, 3);
  curve << 0, 10, 20, 0, 0, 0, 0, 0, 0;
  normals << 0, 0, 0, 0, 0, 0, 1, 1, 1;
  const std::vector<CommandPiece> pieces = {{CommandCurve(curve, false), normals}};
  Eigen::Matrix3Xd points(3, 3);
  points << 5, 15, 30, 0.02, -0.04, 0, 0.01, 0.01, 0;
  const ContourPointsEvaluation all = evaluate_contour_points(pieces, points, 0);
  ASSERT_EQ(all.deviations.size(), 3U);
  EXPECT_EQ(all.beyond, 1U);
  EXPECT_EQ(all.undirected, 0U);
  EXPECT_EQ(all.counted, (std::vector<std::size_t>{0, 1}));
  EXPECT_NEAR(all.across.amounts.mean, 0.03, 1e-9);
  EXPECT_NEAR(std::abs(all.across.bias), 0.01, 1e-9);
  EXPECT_NEAR(all.off.amounts.mean, 0.01, 1e-9);
  EXPECT_NEAR(all.distance.amounts.maximum, std::hypot(0.04, 0.01), 1e-9);
}

}  // namespace
}  // namespace abbe
