#include "wang/dials.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "abbe/errors/random_stream.h"
#include "wang/ball_bar.h"
#include "wang/dial_tables.h"
#include "wang/study.h"

namespace abbe {
namespace {

TEST(WangDials, SimulatedReadingsGiveTheErrorsWithoutBias) {
  const WangDialStudy study = wang_dial_study(1);
  ASSERT_EQ(study.axes.size(), 6U);
  EXPECT_EQ(study.seen_by_dials, 33U);
  EXPECT_EQ(study.with_noise.errors.motions.size(), 36U);
  for (const WangDialAxis& axis : study.axes) {
    ASSERT_EQ(axis.without_noise.status, DecouplingStatus::ok) << axis.without_noise.message;
    // Second order in the angles: (2e-5)^2 x 170 mm.
    EXPECT_LE(axis.bias_mm, 1e-7) << axis.table;
    EXPECT_LE(axis.bias_rad, 2e-9) << axis.table;
    EXPECT_GT(axis.truth.cwiseAbs().maxCoeff(), 0.002);
  }
}

TEST(WangDials, StatedUncertaintiesHoldOverSeeds) {
  std::size_t values = 0, inside = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const WangDialStudy study = wang_dial_study(seed);
    values += study.values;
    inside += study.inside;
  }
  const double share = static_cast<double>(inside) / static_cast<double>(values);
  EXPECT_GT(values, 2500U);
  EXPECT_NEAR(share, 0.9545, 0.015);
}

TEST(WangDials, MapUncertaintyIsThatOfItsScatterOverCampaigns) {
  const WangDialMap map = wang_dial_map(wang_dial_study(1));
  EXPECT_EQ(map.poses, 729U);
  EXPECT_GT(map.inside, 0.8);
  // E at the zero pose over 150 campaigns against the propagated uncertainty.
  const Machine machine = wang_machine();
  const std::vector<double> zero = wang_zero_pose();
  const Eigen::Vector3d centre = wang_integrated_error(machine, wang_dial_study(1).without_noise.errors, zero).machine;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  constexpr int kCampaigns = 150;
  for (int seed = 1; seed <= kCampaigns; ++seed) {
    const WangDialStudy study = wang_dial_study(static_cast<std::uint64_t>(seed));
    const Eigen::Vector3d off = wang_integrated_error(machine, study.with_noise.errors, zero).machine - centre;
    sum += off.cwiseAbs2() / kCampaigns;
  }
  for (int d = 0; d < 3; ++d) {
    // A standard deviation of 150 scatters by 1 / sqrt(300) = 5.8 %.
    EXPECT_NEAR(std::sqrt(sum[d]) / map.zero_pose_uncertainty[d], 1, 0.2) << d;
  }
}

TEST(WangDials, PrintedFormulasHaveTheirBiasAndTheCorrectFormHasNone) {
  const std::vector<WangGridComparison> grids = wang_grid_comparison();
  ASSERT_EQ(grids.size(), 3U);
  EXPECT_NEAR(1e3 * grids[0].printed_second, 56.751, 1e-3);
  EXPECT_NEAR(1e3 * grids[0].printed_first, 20.811, 1e-3);
  for (const WangGridComparison& grid : grids) {
    EXPECT_LE(grid.correct_second, 1e-15);
    EXPECT_LE(grid.correct_first, 1e-15);
    EXPECT_LE(grid.correct_roll, 1e-17);
    EXPECT_GT(grid.printed_roll, 3e-6);
  }
  // arctan of the printed degrees over a face of 120 mm: no lever-type dial reaches that far.
  EXPECT_NEAR(grids[0].dial_range_mm, 120 * 1.25 * 3.14159265 / 180, 3e-6);
}

TEST(WangBallBar, StraightnessMovesTheBarAsTheGeometrySays) {
  // Displacements only: bar length along a direction is the component of the displacement along it.
  const WangReading reading{.angles = WangAngleUnit::none, .composition = {}};
  const ErrorSet errors = wang_errors(reading);
  const std::vector<WangCircle> circles = wang_ball_bar(errors);
  ASSERT_EQ(circles.size(), 3U);
  EXPECT_EQ(circles[2].plane, "ZX");
  const Machine machine = wang_machine();
  const auto error_at = [&](double x, double y, double z) {
    std::vector<double> pose(6, 0.0);
    pose[machine.find_axis("X")] = x;
    pose[machine.find_axis("Y")] = y;
    pose[machine.find_axis("Z")] = z;
    return Eigen::Vector3d(-wang_integrated_error(machine, errors, pose).machine);
  };
  // E is taken at other points of both bodies, which without angles is the same; (0.02 mm)^2 / 200 mm of second order.
  EXPECT_NEAR(circles[0].deviation[0], error_at(300, 100, 200).x(), 3e-6);
  EXPECT_NEAR(circles[0].deviation[90], error_at(200, 200, 200).y(), 3e-6);
  EXPECT_NEAR(circles[1].deviation[180], -error_at(200, 0, 200).y(), 3e-6);
  EXPECT_NEAR(circles[2].deviation[270], -error_at(100, 100, 200).x(), 3e-6);
  for (const WangCircle& circle : circles) {
    EXPECT_TRUE(circle.converged);
    // Figure 15's 0.1 mm is far from what displacements can do.
    EXPECT_LT(circle.circular, 0.025);
    EXPECT_GT(circle.circular, 0.002);
  }
}

TEST(WangBallBar, UncertaintyOfTheTraceIsThatOfItsScatterOverCampaigns) {
  const WangDialStudy study = wang_dial_study(1);
  const std::vector<WangCircle> exact = wang_ball_bar(study.without_noise.errors);
  const std::vector<WangCircle> circles = wang_ball_bar(study.with_noise.errors, &study.with_noise.covariance);
  // Whole campaigns of dials and laser, decoupled each and driven on the exact chain: no derivative is used.
  constexpr int kCampaigns = 120;
  const std::size_t angles[] = {0, 37, 90, 200, 315};
  double squares[3][5] = {}, circular[3] = {}, within = 0;
  for (std::uint64_t seed = 1; seed <= kCampaigns; ++seed) {
    const WangDialStudy campaign = wang_dial_study(100 + seed);
    const std::vector<WangCircle> one = wang_ball_bar(campaign.with_noise.errors);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < 5; ++i) {
        const double off = one[c].deviation[angles[i]] - exact[c].deviation[angles[i]];
        squares[c][i] += off * off / kCampaigns;
        within += std::abs(off) <= 2 * circles[c].uncertainty[angles[i]] ? 1 : 0;
      }
      const double off = one[c].circular - exact[c].circular;
      circular[c] += off * off / kCampaigns;
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < 5; ++i) {
      // A standard deviation of 120 scatters by 1 / sqrt(240) = 6.5 %.
      EXPECT_NEAR(std::sqrt(squares[c][i]) / circles[c].uncertainty[angles[i]], 1, 0.25) << c << " " << angles[i];
    }
    EXPECT_NEAR(std::sqrt(circular[c]) / circles[c].circular_uncertainty, 1, 0.25) << c;
  }
  EXPECT_NEAR(within / (kCampaigns * 15), 0.9545, 0.03);
}

TEST(WangBallBar, ThePictureCarriesTheBand) {
  const WangDialStudy study = wang_dial_study(1);
  const WangCircle exact = wang_ball_bar(study.without_noise.errors)[0];
  const WangCircle circle = wang_ball_bar(study.with_noise.errors, &study.with_noise.covariance)[0];
  const std::string svg = wang_circle_picture(circle, exact).wide;
  EXPECT_NE(svg.find("expanded uncertainty, k = 2"), std::string::npos);
  EXPECT_GT(wang_share_within(circle, exact), 0.6);
}

TEST(WangBallBar, NoErrorsGiveACircle) {
  for (const WangCircle& circle : wang_ball_bar({})) EXPECT_LE(circle.circular, 1e-12);
}

}  // namespace
}  // namespace abbe
