#include "abbe/formats/controls/table_aerotech.h"

#include <gmock/gmock.h>

#include <random>

#include "abbe/formats/controls/table_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::vector<TableAxisName> kNumberedAxes = {{0, "1", false}, {1, "2", false}, {2, "3", false}, {3, "4", true}};

AxisTable line_of(std::size_t input, std::size_t output, std::vector<double> positions, std::vector<double> values) {
  AxisTable table;
  table.input = input;
  table.output = output;
  table.positions = std::move(positions);
  table.forward = table.reverse = std::move(values);
  return table;
}

CorrectionLattice random_plane(std::size_t columns, std::size_t rows, std::vector<std::size_t> outputs,
                               std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> place(-300, 300), step(0.5, 40), value(-0.05, 0.05);
  CorrectionLattice lattice;
  lattice.inputs = {0, 1};
  lattice.modulo = {false, false};
  lattice.outputs = std::move(outputs);
  for (const std::size_t count : {columns, rows}) {
    const double first = place(generator), distance = step(generator);
    std::vector<double>& nodes = lattice.positions.emplace_back();
    for (std::size_t k = 0; k < count; ++k) nodes.push_back(first + distance * static_cast<double>(k));
  }
  for (std::size_t o = 0; o < lattice.outputs.size(); ++o) {
    std::vector<double>& values = lattice.corrections.emplace_back();
    for (std::size_t k = 0; k < lattice.count(); ++k) values.push_back(value(generator));
  }
  return lattice;
}

void expect_near(const CorrectionLattice& read, const CorrectionLattice& written) {
  EXPECT_EQ(read.inputs, written.inputs);
  EXPECT_EQ(read.outputs, written.outputs);
  ASSERT_EQ(read.positions.size(), 2U);
  for (std::size_t a = 0; a < 2; ++a) {
    ASSERT_EQ(read.positions[a].size(), written.positions[a].size());
    for (std::size_t k = 0; k < read.positions[a].size(); ++k) {
      EXPECT_NEAR(read.positions[a][k], written.positions[a][k], 1e-6);
    }
  }
  for (std::size_t o = 0; o < read.corrections.size(); ++o) {
    for (std::size_t k = 0; k < written.count(); ++k) {
      EXPECT_NEAR(read.corrections[o][k], written.corrections[o][k], 0.51e-7);
    }
  }
}

TEST(AerotechLineTable, NamesTheCorrectedAxisAndTheOneThatIsLookedUp) {
  EXPECT_EQ(
      aerotech_1d_text({line_of(0, 0, {-400, 0, 400}, {0, 0.01, -0.0123456}), line_of(0, 1, {0, 5}, {0.002, -0.25})},
                       kNumberedAxes),
      ":START 1 POSUNIT=PRIMARY CORUNIT=PRIMARY SAMPLEDIST=400 OFFSET=400\n"
      "0 0.01 -0.0123456\n:END\n"
      ":START 2 MASTER=1 POSUNIT=PRIMARY CORUNIT=PRIMARY SAMPLEDIST=5 OFFSET=0\n"
      "0.002 -0.25\n:END\n");
}

TEST(AerotechLineTable, WhatIsWrittenIsReadBackToItsDigits) {
  std::vector<AxisTable> tables = {test::some_table(0, 0, 38, 1), test::some_table(0, 1, 77, 2),
                                   test::some_table(1, 2, 2, 3)};
  tables.push_back(test::some_turn(3, 35));
  const std::vector<AxisTable> read =
      parse_aerotech_1d(aerotech_1d_text(tables, kNumberedAxes), "X.cal", kNumberedAxes);
  ASSERT_EQ(read.size(), tables.size());
  for (std::size_t t = 0; t < read.size(); ++t) test::expect_near(read[t], tables[t], 1e-7, 0.51e-7);
}

TEST(AerotechLineTable, IsReadAsOthersWriteItInOtherUnitsAndDownwards) {
  // Keywords on several lines, blanks around =, comments, values in um, a step below zero (CountsPerUnit below zero).
  const std::string text =
      ";*** Aerotech Axis Calibration ***\r\n' of Z over X\r\n\r\n"
      ":start 3 MASTER = 1 POSUNIT=METRIC CORUNIT=METRIC/1000\r\n:START SAMPLEDIST= -50 OFFSET=-10 NEGCOR\r\n"
      "1.0\t2.5 ; two\r\n-3\r\n:END\r\n";
  const std::vector<AxisTable> read = parse_aerotech_1d(text, "Z.cal", kNumberedAxes);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].input, 0U);
  EXPECT_EQ(read[0].output, 2U);
  EXPECT_EQ(read[0].positions, (std::vector<double>{-90, -40, 10}));
  EXPECT_EQ(read[0].forward, (std::vector<double>{0.003, -0.0025, -0.001}));
}

TEST(AerotechLineTable, WhatIsWrongIsRefusedWithItsPlace) {
  const auto refused = [](const std::string& text) {
    return test::refusal([&] { parse_aerotech_1d(text, "A.cal", kNumberedAxes); });
  };
  const std::string head = ":START 1 POSUNIT=PRIMARY CORUNIT=PRIMARY SAMPLEDIST=10\n";
  EXPECT_NO_THROW(parse_aerotech_1d(head + "1 2\n:END\n", "A.cal", kNumberedAxes));
  EXPECT_EQ(refused(head + "1 x\n:END\n"),
            "A.cal:2: correction: 'x' is not a number; expected a number in the unit of the axis (mm, degrees)");
  EXPECT_THAT(refused(head + "1\n:END\n"), HasSubstr("A.cal:1: SAMPLEDIST: 1 places; expected two places or more"));
  EXPECT_THAT(refused(head + "1 2\n"), HasSubstr("A.cal:1: :START: the table has no end"));
  EXPECT_THAT(refused(head + "1 2\n" + head + ":END\n"), HasSubstr("A.cal:3: :START: stands between corrections"));
  EXPECT_THAT(refused("1 2\n"), HasSubstr("A.cal:1: correction: stands outside a table"));
  EXPECT_THAT(refused(":END\n"), HasSubstr("A.cal:1: :END: ends no table"));
  EXPECT_THAT(refused(":START 9 SAMPLEDIST=1\n"), HasSubstr("unknown axis '9'; expected 1, 2, 3 or 4"));
  EXPECT_THAT(refused(":START\n"), HasSubstr("A.cal:1: :START: names no axis"));
  EXPECT_THAT(refused(":START 1\n1 2\n:END\n"), HasSubstr("SAMPLEDIST: is missing"));
  EXPECT_THAT(refused(":START 1 SAMPLEDIST=0\n1 2\n:END\n"), HasSubstr("places too close together"));
  EXPECT_THAT(refused(":START 1 SAMPLEDIST=1 SAMPLEDIST=2\n"), HasSubstr("SAMPLEDIST: is given twice"));
  EXPECT_THAT(refused(":START 1 MASTER=2 MASTER=3\n"), HasSubstr("A.cal:1: MASTER: is given twice"));
  EXPECT_THAT(refused(":START 1 CORUNIT=METRIC\n:START CORUNIT=METRIC/1000\n"),
              HasSubstr("A.cal:2: CORUNIT: is given"));
  EXPECT_THAT(refused(":START 1 SAMPLEDIST\n"), HasSubstr("SAMPLEDIST: has no value; expected SAMPLEDIST=value"));
  EXPECT_THAT(refused(":START 1 HOMEDIRECTION=CW\n"), HasSubstr("HOMEDIRECTION: is not read"));
  EXPECT_THAT(refused(":START 1 CORUNIT=INCH\n"), HasSubstr("CORUNIT: unknown unit 'INCH'"));
  EXPECT_THAT(refused(":START 1 CORUNIT=PRIMARY/0\n"), HasSubstr("CORUNIT: out of range"));
  EXPECT_THAT(refused(":START 4 CORUNIT=METRIC SAMPLEDIST=1\n1 2\n:END\n"), HasSubstr("METRIC for a rotary axis"));
  EXPECT_THAT(refused(":START2D 1 2 1 2 1 1 2\n"), HasSubstr(":START2D: not understood; expected :START or :END"));
  EXPECT_THAT(refused("; nothing\n"), HasSubstr("A.cal: no tables"));
}

TEST(AerotechPlaneTable, HasARowPerStepOfTheRowAxisAndThePairsOrTripletsOfItsColumnsInIt) {
  CorrectionLattice lattice;
  lattice.inputs = {0, 1};
  lattice.modulo = {false, false};
  lattice.positions = {{-10, 0, 10}, {20, 25}};
  lattice.outputs = {0, 1};
  lattice.corrections = {{0.001, 0.002, 0.003, 0.004, 0.005, 0.006}, {-0.1, -0.2, -0.3, -0.4, -0.5, -0.6}};
  EXPECT_EQ(aerotech_2d_text({lattice}, kNumberedAxes),
            ":START2D 2 1 1 2 5 10 3\n:START2D POSUNIT=PRIMARY CORUNIT=PRIMARY OFFSETROW=-20 OFFSETCOL=10\n"
            "0.001 -0.1 0.002 -0.2 0.003 -0.3\n0.004 -0.4 0.005 -0.5 0.006 -0.6\n:END\n");
  lattice.outputs.push_back(2);
  lattice.corrections.push_back({0, 0, 0, 0, 0, 7e-7});
  EXPECT_THAT(aerotech_2d_text({lattice}, kNumberedAxes), HasSubstr(":START2D OUTAXIS3=3 POSUNIT=PRIMARY"));
  EXPECT_THAT(aerotech_2d_text({lattice}, kNumberedAxes), HasSubstr("0.005 -0.5 0 0.006 -0.6 0.0000007\n:END\n"));
}

TEST(AerotechPlaneTable, WhatIsWrittenIsReadBackToItsDigits) {
  const std::vector<CorrectionLattice> tables = {random_plane(2, 2, {0, 1}, 1), random_plane(31, 17, {0, 1, 2}, 2),
                                                 random_plane(3, 90, {2, 0}, 3)};
  const std::vector<CorrectionLattice> read =
      parse_aerotech_2d(aerotech_2d_text(tables, kNumberedAxes), "XY.cal", kNumberedAxes);
  ASSERT_EQ(read.size(), tables.size());
  for (std::size_t t = 0; t < read.size(); ++t) expect_near(read[t], tables[t]);
}

TEST(AerotechPlaneTable, IsReadAsOthersWriteItInOtherUnitsAndDownwards) {
  const std::string text =
      "' RowAxis ColumnAxis OutputAxis1 OutputAxis2 SampDistRow SampDistCol NumCols\n"
      ":START2D 2 1 1 2 5.0 -2.5 2\n:START2D OUTAXIS3=3 POSUNIT=PRIMARY CORUNIT=PRIMARY/1000 OFFSETROW = -1 "
      "OFFSETCOL=4\n:START2D SERIALNUMBER=\"164764\"\n\n1 2 3\t4 5 6\n7 8 9 10 11 12\n:END\n' Notes:\n";
  const std::vector<CorrectionLattice> read = parse_aerotech_2d(text, "XY.cal", kNumberedAxes);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].positions[0], (std::vector<double>{-6.5, -4}));
  EXPECT_EQ(read[0].positions[1], (std::vector<double>{1, 6}));
  EXPECT_EQ(read[0].outputs, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(read[0].corrections[0], (std::vector<double>{0.004, 0.001, 0.01, 0.007}));
  EXPECT_EQ(read[0].corrections[2], (std::vector<double>{0.006, 0.003, 0.012, 0.009}));
}

TEST(AerotechPlaneTable, WhatIsWrongIsRefusedWithItsPlace) {
  const auto refused = [](const std::string& text) {
    return test::refusal([&] { parse_aerotech_2d(text, "P.cal", kNumberedAxes); });
  };
  const std::string head = ":START2D 2 1 1 2 10 5 2\n";
  EXPECT_NO_THROW(parse_aerotech_2d(head + "1 2 3 4\n5 6 7 8\n:END\n", "P.cal", kNumberedAxes));
  EXPECT_THAT(refused(head + "1 2 3 4\n5 6 7\n:END\n"),
              HasSubstr("P.cal:1: NumCols: 7 corrections for 2 columns; expected a multiple of 4: 2 per column"));
  EXPECT_THAT(refused(head + "1 2 3 4\n:END\n"), HasSubstr("SampDistRow: 1 places"));
  EXPECT_THAT(refused(head + ":END\n"), HasSubstr("SampDistRow: 0 places"));
  EXPECT_THAT(refused(":START2D 2 1 1 2 10 5\n"), HasSubstr("P.cal:1: :START2D: 6 of 7 numbers; expected RowAxis"));
  EXPECT_THAT(refused(":START2D 1 1 1 2 10 5 2\n"), HasSubstr("ColumnAxis: is the row axis"));
  EXPECT_THAT(refused(":START2D 2 1 1 1 10 5 2\n"), HasSubstr("OutputAxis2: an axis is corrected twice"));
  EXPECT_THAT(refused(":START2D 2 1 1 7 10 5 2\n"), HasSubstr("OutputAxis2: unknown axis '7'"));
  EXPECT_THAT(refused(":START2D 2 1 1 2 10 5 1\n"), HasSubstr("NumCols: '1' is out of range"));
  EXPECT_THAT(refused(":START2D 2 1 1 2 x 5 2\n"), HasSubstr("SampDistRow: 'x' is not a number"));
  EXPECT_THAT(refused(head + ":START2D OUTAXIS3=2\n"), HasSubstr("P.cal:2: OUTAXIS3: an axis is corrected twice"));
  EXPECT_THAT(refused(head + ":START2D OFFSETROW=1 OFFSETROW=1\n"), HasSubstr("OFFSETROW: is given twice"));
  EXPECT_THAT(refused(head + ":START2D INTABLE\n"), HasSubstr("INTABLE: is not read"));
  EXPECT_THAT(refused(head + "1 2 3 1e400\n"), HasSubstr("P.cal:2: correction"));
  EXPECT_THAT(refused(head + "1 2 3 nan\n"), HasSubstr("P.cal:2: correction"));
}

}  // namespace
}  // namespace abbe
