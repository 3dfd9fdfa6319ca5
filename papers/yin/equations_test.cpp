#include "yin/equations.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "abbe/geometry/angle_units.h"
#include "yin/commands.h"
#include "yin/printed.h"
#include "yin/reference.h"

namespace abbe {
namespace {

TEST(YinEquations, WrongOnesFailTheirTestAndWhatReplacesThemPassesIt) {
  std::size_t wrong = 0;
  for (const YinEquation& e : yin_equations()) {
    // Finite differences know the second one to a micrometre.
    EXPECT_LT(e.right_off, e.number == "(2)" ? 1e-6 : 1e-9) << e.number;
    if (e.is_right) {
      EXPECT_EQ(e.printed_off, e.right_off) << e.number;
    } else {
      EXPECT_GT(e.printed_off, 1) << e.number;
      ++wrong;
    }
  }
  EXPECT_EQ(wrong, 4U);  // (1), (3), (6) in A and C1, (7)
  EXPECT_NEAR(yin_equations()[0].printed_off, 2 * 240.745, 1e-9);
  EXPECT_NEAR(yin_equations()[2].printed_off, 2 * yin_linkage().origin.norm(), 1e-9);
}

TEST(YinEquations, AHeadThatLooksDownSwingsItsFocusForwardAsInConventionU) {
  // Rotation about +X takes a point below the axis towards +Y: the sign of R_A that (1) must have.
  const SwingHeadLinkage l = yin_linkage();
  constexpr double kStep = 1e-6;
  const auto slope = [&](LinkageConvention convention) {
    return (swing_head_focus(l, convention, {0, 0, 0, kStep, 0}).y() -
            swing_head_focus(l, convention, {0, 0, 0, -kStep, 0}).y()) /
           (2 * kStep);
  };
  EXPECT_NEAR(slope(LinkageConvention::table_moves), l.focus_to_a, 1e-6);
  EXPECT_NEAR(slope(LinkageConvention::head_moves), -l.focus_to_a, 1e-6);
}

TEST(YinEquations, PrintedInversePointsTheBeamToTheOtherSide) {
  const SwingHeadLinkage l = yin_linkage();
  const Eigen::Vector3d point(10, 20, 30), beam = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
  const SwingHeadCommand six = yin_printed::inverse(l, point, beam);
  EXPECT_LT((swing_head_beam(six) - Eigen::Vector3d(-beam.x(), -beam.y(), beam.z())).norm(), 1e-12);
  EXPECT_LT((yin_printed::focus(l, six) - point).norm(), 1e-9);
  for (const LinkageConvention convention : {LinkageConvention::table_moves, LinkageConvention::head_moves}) {
    for (const int sign : {1, -1}) {
      const SwingHeadCommand c = swing_head_command(l, convention, point, beam, sign);
      EXPECT_GT(sign * c.a, 0);
      EXPECT_LT((swing_head_beam(c) - beam).norm(), 1e-12);
      EXPECT_LT((swing_head_focus(l, convention, c) - point).norm(), 1e-9);
    }
  }
  // With the beam along Z every C1 is right; the one held is kept.
  const SwingHeadCommand held =
      swing_head_command(l, LinkageConvention::table_moves, point, Eigen::Vector3d::UnitZ(), 1, 0.7);
  EXPECT_EQ(held.c1, 0.7);
  EXPECT_LT((swing_head_focus(l, LinkageConvention::table_moves, held) - point).norm(), 1e-9);
  // arccos has lost a tilt of a hundredth of an arcsecond.
  const double tilt = 0.01 * kArcsec;
  const SwingHeadCommand small =
      swing_head_command(l, LinkageConvention::table_moves, point, Eigen::Vector3d(std::sin(tilt), 0, std::cos(tilt)));
  EXPECT_NEAR(small.a, tilt, 1e-15);
  EXPECT_GT(std::abs(std::acos(std::cos(tilt)) - tilt), 0.01 * tilt);
}

TEST(YinCommands, AreThoseOfAnIndependentProgramInBothBranches) {
  const std::vector<YinAxisCommands> commands = yin_axis_commands(yin_positioning());
  ASSERT_EQ(commands.size(), 30U);
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/tests/golden/yin/p0_A4_chain.csv"));
  std::string line;
  std::getline(file, line);
  int compared = 0;
  while (std::getline(file, line)) {
    std::vector<std::string> f;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) f.push_back(field);
    if (f[1] != "U" || f[2] != "DBW" || f[3] != "0.0") continue;
    const YinAxisCommands& c = commands.at(std::stoul(f[0]) - 1);
    std::size_t at = 22;  // pos_X
    for (const SwingHeadCommand* found : {&c.positive, &c.negative}) {
      for (const double value :
           {found->x, found->y, found->z, found->a * 180 / std::numbers::pi, found->c1 * 180 / std::numbers::pi}) {
        EXPECT_NEAR(value, std::stod(f[at++]), 2e-8) << f[0];
      }
    }
    EXPECT_GT(c.printed_beam_off, 175 * kDegree);  // the beam lies nearly level: the other side of the cylinder
    ++compared;
  }
  EXPECT_EQ(compared, 15);
}

}  // namespace
}  // namespace abbe
