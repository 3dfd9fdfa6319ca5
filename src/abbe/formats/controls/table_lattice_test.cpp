#include "abbe/formats/controls/table_lattice.h"

#include <gmock/gmock.h>

#include "abbe/formats/controls/table_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

CorrectionLattice some_lattice() {
  CorrectionLattice lattice;
  lattice.inputs = {0, 1, 2};
  lattice.positions = {{-10, 0, 17.25}, {0, 100}, {0, 0.5, 1, 2}};
  lattice.modulo = {false, false, false};
  lattice.outputs = {0, 2};
  std::mt19937_64 generator(9);
  std::uniform_real_distribution<double> size(-0.04, 0.04);
  lattice.corrections.resize(2);
  for (std::size_t k = 0; k < lattice.count(); ++k) {
    lattice.corrections[0].push_back(size(generator));
    lattice.corrections[1].push_back(1e-3 * size(generator));
  }
  return lattice;
}

void expect_same(const CorrectionLattice& read, const CorrectionLattice& lattice) {
  EXPECT_EQ(read.inputs, lattice.inputs);
  EXPECT_EQ(read.outputs, lattice.outputs);
  ASSERT_EQ(read.count(), lattice.count());
  for (std::size_t a = 0; a < lattice.inputs.size(); ++a) {
    ASSERT_EQ(read.positions[a].size(), lattice.positions[a].size());
    for (std::size_t k = 0; k < lattice.positions[a].size(); ++k) {
      EXPECT_NEAR(read.positions[a][k], lattice.positions[a][k], 1e-9);
    }
  }
  for (std::size_t k = 0; k < lattice.count(); ++k) {
    EXPECT_NEAR(read.corrections[0][k], lattice.corrections[0][k], 0.51e-7);
    EXPECT_NEAR(read.corrections[1][k], lattice.corrections[1][k], 0.51e-10);
  }
}

TEST(LatticeTable, WhatIsWrittenIsReadBackToItsDigits) {
  const CorrectionLattice lattice = some_lattice();
  expect_same(parse_lattice_csv(lattice_csv_text(lattice, test::kXYC), "l.csv", test::kXYC), lattice);
  expect_same(parse_lattice_vtk(lattice_vtk_text(lattice, test::kXYC), "l.vtk", test::kXYC), lattice);
}

TEST(LatticeTable, HeadersSayAxesAndUnits) {
  CorrectionLattice lattice;
  lattice.inputs = {0};
  lattice.positions = {{0, 50}};
  lattice.modulo = {false};
  lattice.outputs = {1};
  lattice.corrections = {{0.001, -0.0025}};
  EXPECT_THAT(lattice_csv_text(lattice, test::kXYC), HasSubstr("\nX_mm,correction_Y_um\n0,1.0000\n50,-2.5000\n"));
  EXPECT_EQ(lattice_vtk_text(lattice, test::kXYC),
            "# vtk DataFile Version 3.0\ncorrections over X_mm\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 1 1\n"
            "X_COORDINATES 2 double\n0 50\nY_COORDINATES 1 double\n0\nZ_COORDINATES 1 double\n0\nPOINT_DATA 2\n"
            "SCALARS correction_Y_um double 1\nLOOKUP_TABLE default\n1.0000\n-2.5000\n");
}

TEST(LatticeTable, GridsWithGapsAndWrongWordsAreRefused) {
  const auto csv = [](const std::string& text) {
    return test::refusal([&] { parse_lattice_csv(text, "l.csv", test::kXYC); });
  };
  EXPECT_THAT(csv("X_mm,Y_mm,correction_X_um\n0,0,1\n1,0,1\n0,1,1\n"), HasSubstr("3 rows, but a grid of 4 nodes"));
  EXPECT_THAT(csv("X_mm,Y_mm,correction_X_um\n0,0,1\n1,1,1\n0,1,1\n0,1,2\n"), HasSubstr("l.csv:5"));
  EXPECT_THAT(csv("X_deg,correction_X_um\n0,0\n"), HasSubstr("X"));
  EXPECT_THAT(csv("X_mm\n0\n"), HasSubstr("no grid"));
  const std::string good = lattice_vtk_text(some_lattice(), test::kXYC);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return test::refusal([&] { parse_lattice_vtk(text, "l.vtk", test::kXYC); });
  };
  EXPECT_THAT(changed("X_mm", "Q_mm"), HasSubstr("unknown axis 'Q_mm'"));
  EXPECT_THAT(changed("Y_mm", "X_mm"), HasSubstr("named twice"));
  EXPECT_THAT(changed("DIMENSIONS 3", "DIMENSIONS 4"), HasSubstr("another count"));
  EXPECT_THAT(changed("DIMENSIONS 3", "DIMENSIONS 99999999"), HasSubstr("out of range"));
  EXPECT_THAT(changed("17.25", "-17.25"), HasSubstr("not increasing"));
  EXPECT_THAT(changed("correction_C_urad", "correction_C_um"), HasSubstr("unknown field"));
  EXPECT_THAT(test::refusal([&] { parse_lattice_vtk("", "l.vtk", test::kXYC); }), HasSubstr("no legacy VTK file"));
}

}  // namespace
}  // namespace abbe
