#include "abbe/formats/controls/table_volumetric.h"

#include <gmock/gmock.h>

#include <numbers>

#include "abbe/formats/controls/table_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

ErrorTables some_tables() {
  ErrorTables tables;
  tables.tables.push_back({0,
                           {-280, -270.5, 260},
                           {Component::X, Component::Y, Component::C},
                           {{0.02, 0, 1.6e-9}, {0.01, -0.1, 0}, {4.2e-6, 0, -1e-12}}});
  tables.tables.push_back({2, {0, std::numbers::pi}, {Component::C}, {{1e-5, 2e-5}}});
  tables.locations = {{1, Component::C, 2.2355737e-5, 0}, {2, Component::X, 0.014, 0}};
  return tables;
}

TEST(VolumetricTable, IsgCsvHasOneBlockPerAxisAndOneOfPositionErrors) {
  EXPECT_EQ(isg_csv_text(some_tables(), test::kXYC),
            "// Errors, actual minus nominal; positions in mm and degrees, values in mm and rad\n"
            "X EXX EYX ECX\n"
            "-280 0.020000000 0.010000000 0.000004200000\n"
            "-270.5 0.000000000 -0.100000000 0.000000000000\n"
            "260 0.000000002 0.000000000 -0.000000000001\n"
            "#\nC ECC\n0 0.000010000000\n180 0.000020000000\n"
            "#\nC0Y X0C\n0.000022355737 0.014000000\n");
}

TEST(VolumetricTable, EtalonHasOneSectionPerError) {
  ErrorTables tables;
  tables.tables.push_back({1, {-280, -270}, {Component::X}, {{-0.001358635, -0.000240680}}});
  tables.locations = {{2, Component::Y, 0.003, 0}};
  EXPECT_EQ(
      etalon_text(tables, test::kXYC),
      "// Errors, actual minus nominal; positions in mm and degrees, values in mm and rad\n"
      "[Y0C]\nVALUE = 0.003000000\n[EXY]\nGridpoints = {\n-280 -0.001358635\n-270 -0.000240680\n}  // end of EXY\n");
}

TEST(VolumetricTable, WhatIsWrittenIsReadBackToItsDigits) {
  const ErrorTables tables = some_tables();
  const ErrorTables read = parse_isg_csv(isg_csv_text(tables, test::kXYC), "v.csv", test::kXYC);
  ASSERT_EQ(read.tables.size(), 2U);
  EXPECT_EQ(read.tables[0].components, tables.tables[0].components);
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t k = 0; k < tables.tables[t].positions.size(); ++k) {
      EXPECT_NEAR(read.tables[t].positions[k], tables.tables[t].positions[k], 1e-9);
      for (std::size_t c = 0; c < tables.tables[t].components.size(); ++c) {
        EXPECT_NEAR(read.tables[t].values[c][k], tables.tables[t].values[c][k], 0.51e-9);
      }
    }
  }
  EXPECT_EQ(read.locations, tables.locations);
  const ErrorTables sections = parse_etalon(etalon_text(tables, test::kXYC), "e.txt", test::kXYC);
  ASSERT_EQ(sections.tables.size(), 4U);
  EXPECT_EQ(sections.locations, tables.locations);
  const ErrorSet a = errors_of(read), b = errors_of(sections);
  for (const double q : {-280.0, -275.0, 100.0, 260.0}) {
    for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(a.evaluate(0, q)[c], b.evaluate(0, q)[c], 1e-12);
  }
}

TEST(VolumetricTable, TheManualsExamplesAreRead) {
  const ErrorTables csv = parse_isg_csv(
      "// The header contains the argument\nX      EXX    EYX    EZX    EAX    EBX    ECX\n"
      "0.0    0.02   0.01   0.07   0.00   0.0042 0.003\n10.0   0.00   -0.1   0.01   0.00   0.0011 0.002\n"
      "// Further records depending on X\n",
      "v.csv", test::kXYC);
  EXPECT_EQ(csv.tables[0].values[4][1], 0.0011);
  const ErrorTables sections = parse_etalon(
      "[C0Y]\nVALUE = 0.000022355737\n[EXY]\nGridpoints = {\n          -280.0 -0.001358635132\n"
      "          -270.0 -0.000240680764\n}  // end of EXY\n",
      "e.txt", test::kXYC);
  EXPECT_EQ(sections.tables[0].positions[0], -280);
  EXPECT_EQ(sections.locations[0].value, 0.000022355737);
}

TEST(VolumetricTable, WhatIsWrongIsRefusedWithItsPlace) {
  const auto csv = [](const std::string& text) {
    return test::refusal([&] { parse_isg_csv(text, "v.csv", test::kXYC); });
  };
  EXPECT_THAT(csv("X EXX EYY\n0 1 1\n"), HasSubstr("v.csv:1: EYY: does not belong"));
  EXPECT_THAT(csv("X EXX\n0 1\n0 1\n"), HasSubstr("v.csv:3: X: is not above"));
  EXPECT_THAT(csv("Y X EXX\n0 0 1\n"), HasSubstr("a second argument"));
  EXPECT_THAT(csv("X EXQ\n0 0\n"), HasSubstr("unknown column"));
  EXPECT_THAT(csv("X EXX EXX\n0 0 0\n"), HasSubstr("given twice"));
  EXPECT_THAT(csv("X EXX\n"), HasSubstr("a header without rows"));
  EXPECT_THAT(csv("X EXX\n0\n"), HasSubstr("1 fields"));
  EXPECT_THAT(csv("C0Y\n1\n2\n"), HasSubstr("a second row"));
  EXPECT_THAT(csv("X EXX\n0 inf\n"), HasSubstr("EXX"));
  EXPECT_THAT(csv("// nothing\n"), HasSubstr("no errors"));
  const auto sections = [](const std::string& text) {
    return test::refusal([&] { parse_etalon(text, "e.txt", test::kXYC); });
  };
  EXPECT_THAT(sections("[EXY]\nGridpoints = {\n0 1\n"), HasSubstr("ends within EXY"));
  EXPECT_THAT(sections("[EXY]\n[EYY]\n"), HasSubstr("has no value"));
  EXPECT_THAT(sections("[EXY]\nVALUE = 1\n"), HasSubstr("Gridpoints"));
  EXPECT_THAT(sections("VALUE = 1\n"), HasSubstr("outside a section"));
  EXPECT_THAT(sections("[EXY]\nGridpoints = {\n}\n"), HasSubstr("no points"));
  EXPECT_THAT(sections("[EXY]\nGridpoints = {\n1 2 3\n}\n"), HasSubstr("not two numbers"));
}

}  // namespace
}  // namespace abbe
