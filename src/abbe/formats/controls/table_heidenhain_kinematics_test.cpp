#include "abbe/formats/controls/table_heidenhain_kinematics.h"

#include <gmock/gmock.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using Key = KinematicsRow::Key;

const std::vector<TableAxisName> kNumbered = {{0, "4", true}, {1, "1", false}};

/// The rows of the manual, pages 671 and 684.
std::vector<KinematicsRow> some_rows() {
  return {{.axis = 'Z', .doc = "Z of C", .coord = 250.051},
          {.axis = 'Y', .doc = "EYX", .column = ComptabColumn{1, 1}},
          {.axis = 'A', .doc = "EAX", .column = ComptabColumn{1, 3}},
          {.axis = 'A', .doc = "EA0X", .coord = 0, .constant = 0.0015 * kDegree},
          {.key = Key::mach_axis, .axis = 'X'},
          {.key = Key::mach_base},
          {.key = Key::mach_axis, .axis = 'C'}};
}

constexpr const char* kText =
    "BEGIN KINEMATICS.TAB MM\n"
    "NR   DOC             KEY       AXIS  COORD               COMPTAB\n"
    "0    Z of C          Trans     Z     250.051000\n"
    "1    EYX             Trans     Y                         A1C2\n"
    "2    EAX             Trans     A                         A1C4\n"
    "3    EA0X            Trans     A     0.0000000           0.0015000\n"
    "4                    MachAxis  X\n"
    "5                    MachBase\n"
    "6                    MachAxis  C\n"
    "[END]\n";

std::string refusal(const std::string& from, const std::string& to) {
  std::string text = kText;
  text.replace(text.find(from), from.size(), to);
  try {
    parse_heidenhain_kinematics(text, "K.TAB", kNumbered, 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

void expect_equal(const std::vector<KinematicsRow>& read, const std::vector<KinematicsRow>& rows) {
  ASSERT_EQ(read.size(), rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(read[k].key, rows[k].key);
    EXPECT_EQ(read[k].axis, rows[k].axis);
    EXPECT_EQ(read[k].doc, rows[k].doc);
    EXPECT_EQ(read[k].column, rows[k].column);
    EXPECT_NEAR(read[k].coord.value_or(-1), rows[k].coord.value_or(-1), 1e-9);
    EXPECT_NEAR(read[k].constant.value_or(-1), rows[k].constant.value_or(-1), 1e-9);
  }
}

TEST(HeidenhainKinematics, IsATableWithColumnsThatIsReadBack) {
  EXPECT_EQ(heidenhain_kinematics_text(some_rows(), "KINEMATICS.TAB", kNumbered, 1), kText);
  expect_equal(parse_heidenhain_kinematics(kText, "K.TAB", kNumbered, 1), some_rows());
  const KinematicsCount count = kinematics_count(some_rows());
  EXPECT_EQ(count.coord, 2U);
  EXPECT_EQ(count.axes, 2U);
  EXPECT_EQ(count.comptab, 3U);
}

TEST(HeidenhainKinematics, TheSignTurnsNumbersOfComptabAndNoGeometry) {
  const std::string turned = heidenhain_kinematics_text(some_rows(), "KINEMATICS.TAB", kNumbered, -1);
  EXPECT_THAT(turned, HasSubstr("COORD               COMPTAB\n0    Z of C          Trans     Z     250.051000\n"));
  EXPECT_THAT(turned, HasSubstr("0.0000000           -0.0015000\n"));
  expect_equal(parse_heidenhain_kinematics(turned, "K.TAB", kNumbered, -1), some_rows());
}

TEST(HeidenhainKinematics, WhatWouldChangeTheChainOrIsNotUnderstoodIsRefusedWithItsLine) {
  EXPECT_THAT(refusal("MachBase", "CMO"), HasSubstr("K.TAB:8: KEY: 'CMO' is not read; expected Trans, MachAxis"));
  EXPECT_THAT(refusal("COMPTAB", "TEMPCOMP"), HasSubstr("K.TAB:2: columns: not understood"));
  EXPECT_THAT(refusal("A1C2", "A2C2"), HasSubstr("K.TAB:4: COMPTAB: unknown axis in 'A2C2'"));
  EXPECT_THAT(refusal("A1C2", "A1C5"), HasSubstr("C1 to C3 (mm) for a shift"));
  EXPECT_THAT(refusal("A1C4", "A1C3"), HasSubstr("C4 to C6 (degrees) for a turn"));
  EXPECT_THAT(refusal("A1C2", "A1"), HasSubstr("'A1' is not understood; expected a number, or a column as A1C2"));
  EXPECT_THAT(refusal("A1C2", "    "), HasSubstr("Trans without a value"));
  EXPECT_THAT(refusal("250.051000", "two"), HasSubstr("K.TAB:3: COORD"));
  EXPECT_THAT(refusal("MachAxis  X", "MachAxis  C"), HasSubstr("MachAxis C a second time"));
  EXPECT_THAT(refusal("MachAxis  X", "MachAxis  Q"), HasSubstr("AXIS: 'Q'; expected one of X Y Z"));
  EXPECT_THAT(refusal("MachAxis  X", "MachAxis  X     1"), HasSubstr("MachAxis with values"));
  EXPECT_THAT(refusal("\n3 ", "\n4 "), HasSubstr("NR: is not the next number"));
  EXPECT_THAT(refusal("[END]", ""), HasSubstr("no [END]"));
  EXPECT_THAT(refusal(" MM\n", "\n"), HasSubstr("no table of a control"));
}

// Page 686: 100 entries of COMPTAB and MachAxis, 50 of COORD and MachAxis.
TEST(HeidenhainKinematics, HasRoomForSoManyRowsAndNoMore) {
  const auto rows_of = [](std::size_t comptab, std::size_t coord) {
    std::vector<KinematicsRow> rows = {{.key = Key::mach_axis, .axis = 'X'}, {.key = Key::mach_axis, .axis = 'C'}};
    rows.insert(rows.begin(), comptab, {.axis = 'B', .constant = 1e-5});
    rows.insert(rows.begin(), coord, {.axis = 'Z', .coord = 12.5});
    return rows;
  };
  const auto read = [](const std::vector<KinematicsRow>& rows) {
    return parse_heidenhain_kinematics(heidenhain_kinematics_text(rows, "K.TAB", kNumbered, 1), "K.TAB", kNumbered, 1);
  };
  EXPECT_EQ(read(rows_of(98, 48)).size(), 148U);
  EXPECT_FALSE(kinematics_fits(kinematics_count(rows_of(99, 0))));
  EXPECT_FALSE(kinematics_fits(kinematics_count(rows_of(0, 49))));
  EXPECT_THROW(read(rows_of(99, 0)), InputError);
  EXPECT_THROW(read(rows_of(0, 49)), InputError);
  EXPECT_EQ(kinematics_room(kinematics_count(rows_of(99, 3))),
            "99 of 98 entries in COMPTAB, 5 of 50 rows with COORD or MachAxis");
}

ComponentTable some_component() {
  ComponentTable table;
  table.axis = 0;
  const std::vector<double> positions = {0, 90 * kDegree, 360 * kDegree};
  table.own = AxisTable{0, 0, positions, {-1e-3 * kDegree, 0, -1e-3 * kDegree}, {-1e-3 * kDegree, 0, -1e-3 * kDegree}};
  table.columns[0] = AxisTable{0, 0, positions, {0.001, -0.002, 0.001}, {0.001, -0.002, 0.001}};
  table.columns[4] = AxisTable{0, 0, positions, {0, 2e-4 * kDegree, 0}, {0, 2e-4 * kDegree, 0}};
  return table;
}

constexpr const char* kComponentText =
    "BEGIN C.COM MM\n"
    "NR AXISPOS 4 C1 C5\n"
    "0 0.0000000 0.0010000 0.001000 0.0000000\n"
    "1 90.0000000 0.0000000 -0.002000 0.0002000\n"
    "2 360.0000000 0.0010000 0.001000 0.0000000\n"
    "[END]\n";

TEST(HeidenhainComponents, AreColumnsOfATableThatIsReadBack) {
  EXPECT_EQ(heidenhain_component_text(some_component(), "C.COM", kNumbered, -1, 1), kComponentText);
  const ComponentTable read = parse_heidenhain_component(kComponentText, "C.COM", 0, kNumbered, -1, 1);
  ASSERT_TRUE(read.own && read.columns[0] && read.columns[4]);
  EXPECT_FALSE(read.columns[1] || read.columns[2] || read.columns[3] || read.columns[5]);
  EXPECT_NEAR(read.own->at(0), -1e-3 * kDegree, 1e-15);
  EXPECT_NEAR(read.columns[0]->at(45 * kDegree), -0.0005, 1e-15);
  EXPECT_NEAR(read.columns[4]->at(90 * kDegree), 2e-4 * kDegree, 1e-15);
  const ComponentTable turned = parse_heidenhain_component(kComponentText, "C.COM", 0, kNumbered, 1, -1);
  EXPECT_NEAR(turned.own->at(0), 1e-3 * kDegree, 1e-15);
  EXPECT_NEAR(turned.columns[0]->at(0), -0.001, 1e-15);
}

TEST(HeidenhainComponents, ThatAreNotUnderstoodAreRefused) {
  const auto refused = [](const std::string& from, const std::string& to) -> std::string {
    std::string text = kComponentText;
    text.replace(text.find(from), from.size(), to);
    try {
      parse_heidenhain_component(text, "C.COM", 0, kNumbered, -1, 1);
    } catch (const InputError& error) {
      return error.what();
    }
    return "not refused";
  };
  EXPECT_THAT(refused("C5", "C7"), HasSubstr("C.COM:2: columns: unknown column 'C7'; expected 4 (the axis itself)"));
  EXPECT_THAT(refused("C5", "1"), HasSubstr("unknown column '1'"));
  EXPECT_THAT(refused("C5", "C1"), HasSubstr("C1 is there twice"));
  EXPECT_THAT(refused("1 90", "1 400"), HasSubstr("C.COM:5: AXISPOS: is not above the one before"));
  EXPECT_THAT(refused("-0.002000 ", ""), HasSubstr("4 fields; expected 5 fields"));
  EXPECT_THAT(refused("[END]", ""), HasSubstr("no [END]"));
}

}  // namespace
}  // namespace abbe
