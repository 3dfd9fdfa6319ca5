#include "abbe/formats/controls/table_fanuc_lattice.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/controls/table_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<TableAxisName> kReversedNumbers = {{2, "1", false}, {1, "2", false}, {0, "3", false}, {3, "4", true}};
constexpr std::array<double, 3> kReference = {0, -7.5, 250};

CorrectionLattice some_lattice(double size) {
  CorrectionLattice lattice;
  lattice.inputs = lattice.outputs = {2, 1, 0};
  lattice.positions = {{-40, 0, 40}, {-7.5, 5}, {200, 225, 250, 275}};
  lattice.modulo.assign(3, false);
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> any(-size, size);
  lattice.corrections.resize(3);
  for (std::vector<double>& values : lattice.corrections) {
    for (std::size_t k = 0; k < lattice.count(); ++k) values.push_back(any(generator));
  }
  return lattice;
}

FanucLattice some_fanuc(double size = 0.05, double unit = 1e-3) {
  return fanuc_lattice(some_lattice(size), unit, {1, 0, 2});
}

FanucLattice read_back(const FanucLattice& lattice) {
  return parse_fanuc_lattice(fanuc_lattice_parameter_text(lattice, kReversedNumbers), "p",
                             fanuc_lattice_point_text(lattice, kReversedNumbers), "d", kReversedNumbers);
}

TEST(FanucLatticeTable, WhatIsWrittenIsReadBackAndIsTheLatticeToHalfAStep) {
  for (const double size : {0.05, 0.6}) {
    const FanucLattice lattice = some_fanuc(size);
    EXPECT_EQ(read_back(lattice), lattice);
    const CorrectionLattice wanted = some_lattice(size);
    const CorrectionLattice found = fanuc_lattice_corrections(read_back(lattice), 1e-3, kReference);
    EXPECT_EQ(found.inputs, wanted.inputs);
    EXPECT_EQ(found.positions, wanted.positions);
    for (std::size_t a = 0; a < 3; ++a) {
      const double step = 1e-3 * lattice.magnification[a];
      double largest = 0;
      for (std::size_t k = 0; k < wanted.count(); ++k) {
        const double off = std::abs(found.corrections[a][k] - wanted.corrections[a][k]);
        largest = std::max(largest, off);
      }
      EXPECT_LE(largest, 0.5 * step + 1e-12);
      EXPECT_GT(largest, 0.3 * step);
    }
  }
}

TEST(FanucLatticeTable, TheMagnificationIsTheSmallestThatHoldsTheLargestValue) {
  CorrectionLattice lattice = some_lattice(0.05);
  lattice.corrections[0][3] = 0.127;
  lattice.corrections[1][3] = -0.1275;
  lattice.corrections[2][3] = 20;
  const FanucLattice rounded = fanuc_lattice(lattice, 1e-3, {0, 0, 0});
  EXPECT_THAT(rounded.magnification, ElementsAre(1, 2, 158));
  EXPECT_EQ(rounded.values[0][3], 127);
  EXPECT_EQ(rounded.values[1][3], -64);
  EXPECT_EQ(rounded.values[2][3], 127);
}

TEST(FanucLatticeTable, ParametersAndPointsAreBlocksOfAParameterFile) {
  CorrectionLattice lattice = some_lattice(0);
  lattice.outputs = {1, 0};
  lattice.corrections.pop_back();
  lattice.corrections[0][1] = 0.003;
  lattice.corrections[1][2] = -0.0021;
  const FanucLattice rounded = fanuc_lattice(lattice, 1e-3, {1, 0, 2});
  EXPECT_EQ(fanuc_lattice_parameter_text(rounded, kReversedNumbers),
            "%\nN10800P1\nN10801P2\nN10802P3\nN10803P3\nN10804P2\nN10805P4\nN10806P2\nN10807P1\nN10808P3\n"
            "N10809P1\nN10810P1\nN10811P1\nN10812P40.0\nN10813P12.5\nN10814P25.0\n%\n");
  EXPECT_THAT(fanuc_lattice_point_text(rounded, kReversedNumbers),
              testing::StartsWith("%\nN00001A1P0A2P0A3P0\nN00002A1P0A2P3A3P0\nN00003A1P0A2P0A3P-2\nN00004A1P0"));
}

TEST(FanucLatticeTable, PointsMayComeInAnyOrderAndLinesMayEndAsThoseOfControls) {
  const FanucLattice lattice = some_fanuc();
  std::string points = fanuc_lattice_point_text(lattice, kReversedNumbers);
  const std::size_t second = points.find("N00002"), third = points.find("N00003");
  points = "%\r\n" + points.substr(second, third - second - 1) + ";\r\n" + points.substr(2, second - 2) +
           points.substr(third);
  EXPECT_EQ(
      parse_fanuc_lattice(fanuc_lattice_parameter_text(lattice, kReversedNumbers), "p", points, "d", kReversedNumbers),
      lattice);
}

TEST(FanucLatticeTable, WrongParametersAreRefusedWithTheirLine) {
  const FanucLattice lattice = some_fanuc();
  const std::string points = fanuc_lattice_point_text(lattice, kReversedNumbers);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = fanuc_lattice_parameter_text(lattice, kReversedNumbers);
    text.replace(text.find(from), from.size(), to);
    return test::refusal([&] { parse_fanuc_lattice(text, "p", points, "d", kReversedNumbers); });
  };
  EXPECT_THAT(changed("N10800P1", "N10799P1"), testing::AllOf(HasSubstr("p:2"), HasSubstr("unknown parameter")));
  EXPECT_THAT(changed("N10800P1\n", ""), HasSubstr("N10800"));
  EXPECT_THAT(changed("N10801P2", "N10801P9"), testing::AllOf(HasSubstr("p:3"), HasSubstr("axis 1, 2 or 3")));
  EXPECT_THAT(changed("N10801P2", "N10801P4"), HasSubstr("a rotary axis"));
  EXPECT_THAT(changed("N10801P2", "N10801P1"), testing::AllOf(HasSubstr("p:3"), HasSubstr("an axis twice")));
  EXPECT_THAT(changed("N10801P2", "N10800P2"), HasSubstr("is given twice"));
  EXPECT_THAT(changed("N10803P3", "N10803P26"), HasSubstr("a whole number from 2 to 25"));
  EXPECT_THAT(changed("N10803P3", "N10803P1"), HasSubstr("out of range"));
  EXPECT_THAT(changed("N10807P1", "N10807P3"), testing::AllOf(HasSubstr("p:9"), HasSubstr("behind the last point")));
  EXPECT_THAT(changed("N10809P1", "N10809P101"), HasSubstr("0 to 100"));
  EXPECT_THAT(changed("N10812P40.0", "N10812P0.0"), testing::AllOf(HasSubstr("p:14"), HasSubstr("mm")));
  EXPECT_THAT(changed("N10812P40.0", "N10812A1P40.0"), HasSubstr("not one value"));
  EXPECT_THAT(changed("N10812P40.0", "G10L50"), HasSubstr("is not a block"));
}

TEST(FanucLatticeTable, WrongPointsAreRefusedWithTheirLine) {
  const FanucLattice lattice = some_fanuc(0);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = fanuc_lattice_point_text(lattice, kReversedNumbers);
    text.replace(text.find(from), from.size(), to);
    return test::refusal([&] {
      parse_fanuc_lattice(fanuc_lattice_parameter_text(lattice, kReversedNumbers), "p", text, "d", kReversedNumbers);
    });
  };
  const std::string second = "N00002A1P0A2P0A3P0";
  EXPECT_THAT(changed(second + "\n", ""), testing::AllOf(HasSubstr("N00002"), HasSubstr("is missing")));
  EXPECT_THAT(changed("N00002", "N00025"), testing::AllOf(HasSubstr("d:3"), HasSubstr("from 1 to 24")));
  EXPECT_THAT(changed("N00002", "N00001"), testing::AllOf(HasSubstr("d:3"), HasSubstr("is given twice")));
  EXPECT_THAT(changed(second, "N00002A1P0A2P128A3P0"), HasSubstr("from -128 to 127"));
  EXPECT_THAT(changed(second, "N00002A1P0A2P0.5A3P0"), HasSubstr("out of range"));
  EXPECT_THAT(changed(second, "N00002A1P0A2P0"), HasSubstr("not three values"));
  EXPECT_THAT(changed(second, second + "A1P0"), HasSubstr("an axis twice"));
  EXPECT_THAT(changed(second, second + "A1"), HasSubstr("not three values"));
  EXPECT_THAT(changed(second, "N00002P0A1P0A2P0"), HasSubstr("A and P in turns"));
  EXPECT_THAT(changed(second, "N00002A1P0A2P0A4P0"), HasSubstr("a rotary axis"));
  EXPECT_THAT(changed(second, "N00002A1P0A2P0A3Px"), testing::AllOf(HasSubstr("d:3"), HasSubstr("not a number")));
}

}  // namespace
}  // namespace abbe
