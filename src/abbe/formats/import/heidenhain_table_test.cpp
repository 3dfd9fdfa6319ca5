#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/import/instrument_for_test.h"
#include "abbe/formats/text/replaced_text_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::string kTable =
    "BEGIN PART 1.TAB MM Version: 'Update:110.24'\r\n"
    "NR  NAME  X       Y       Z     A\r\n"
    "0   PIN   +1.50   -2      3.    +0\r\n"
    "1         +100.25 +0      -7.5\r\n"
    "2   FREE  -       -       -     -\r\n"
    "4   BORE  4       5       6     90\r\n"
    "[END]\r\n";

std::string refusal(const std::string& from, const std::string& to) {
  return refusal_of("heidenhain-table", test::replaced(kTable, from, to));
}

InstrumentTable read_with(const std::string& from, const std::string& to, const ImportHints& hints = {}) {
  return read_as("heidenhain-table", test::replaced(kTable, from, to), hints);
}

TEST(HeidenhainTables, HavePointsWithTheNumbersOfTheirRows) {
  const InstrumentTable table = read_as("heidenhain-table", kTable);
  EXPECT_EQ(table.kind, ImportKind::points);
  EXPECT_EQ(table.rows, "0,1.50,-2,3.\n1,100.25,0,-7.5\n4,4,5,6\n");
  EXPECT_THAT(table.lines, ElementsAre(3, 4, 6));
  ASSERT_EQ(table.columns.size(), 4U);
  EXPECT_EQ(table.columns[0].name, "NR");
  EXPECT_EQ(table.columns[2].base, "y");
  EXPECT_EQ(table.columns[2].unit, "mm");
  EXPECT_TRUE(table.columns[2].unit_is_stated);
  EXPECT_EQ(table.columns[2].reason, "BEGIN says MM");
  EXPECT_THAT(table.doubts, IsEmpty());
  EXPECT_THAT(table.reasons, ElementsAre("3 points"));
  EXPECT_THAT(table.not_read, ElementsAre("columns NAME A", "1 row without numbers in X, Y and Z"));
  ASSERT_EQ(table.facts.size(), 2U);
  EXPECT_EQ(table.facts[0].value, "PART 1.TAB");
  EXPECT_EQ(table.facts[1].value, "'Update:110.24'");
}

TEST(HeidenhainTables, StateMillimetresOrInchesOrNone) {
  EXPECT_EQ(read_with(" MM ", " INCH ").columns[1].unit, "inch");
  const InstrumentTable none = read_with(" MM ", " ");
  EXPECT_FALSE(none.columns[1].unit_is_stated);
  EXPECT_THAT(none.columns[1].doubts, ElementsAre("states no unit; millimetres are assumed (--length-unit)"));
  ImportHints hints;
  hints.length_unit = "inch";
  const InstrumentTable given = read_with(" MM ", " ", hints);
  EXPECT_EQ(given.columns[3].unit, "inch");
  EXPECT_THAT(given.columns[3].doubts, IsEmpty());
}

TEST(HeidenhainTables, MayDescribeTheirColumns) {
  const std::string names = "NR  NAME";
  InstrumentTable table = read_with(names, "#STRUCTBEGIN\n NAME = X\n )\n#STRUCTEND\n" + names);
  EXPECT_THAT(table.not_read, testing::Contains("description of the columns, lines 2 to 5"));
  EXPECT_THAT(table.lines, ElementsAre(7, 8, 10));
  // As newer controls write it: brackets within have blanks before them.
  table = read_with(names, "TableDescription (\n  columns:= [\n    Cfg (\n    )\n  ]\n)\n" + names);
  EXPECT_THAT(table.not_read, testing::Contains("description of the columns, lines 2 to 7"));
  EXPECT_EQ(table.rows, read_as("heidenhain-table", kTable).rows);
  EXPECT_EQ(refusal(names, "#STRUCTBEGIN\n" + names),
            "t:2: the description of the columns has no end; expected #STRUCTEND");
  EXPECT_EQ(refusal(names, "TableDescription (\n  )\n" + names),
            "t:2: the description of the columns has no end; expected a line that begins with ')'");
}

TEST(HeidenhainTables, HaveColumnsOfCharactersAndNotOfBytes) {
  const InstrumentTable table = read_with("PIN ", "\xC3\xA4\xE2\x82\xAC\xC3\xB6 ");
  EXPECT_EQ(table.rows, "0,1.50,-2,3.\n1,100.25,0,-7.5\n4,4,5,6\n");
}

TEST(HeidenhainTables, MayHaveDecimalCommas) {
  std::string text = kTable;
  for (std::size_t at = text.find("1.50"); at < text.size(); ++at) {
    if (text[at] == '.') text[at] = ',';
  }
  EXPECT_EQ(read_as("heidenhain-table", text).rows, read_as("heidenhain-table", kTable).rows);
  EXPECT_EQ(refusal("1.50", "1,50"),
            "t:3: Z: '3.' has the decimal mark '.', and line 3 has ','; expected one decimal mark");
  EXPECT_EQ(refusal("+1.50  ", "+1.5,0 "), "t:3: X: '+1.5,0' has two decimal marks; expected a number in mm");
}

TEST(HeidenhainTables, HaveNumbersThatFillTheirColumns) {
  // Names and numbers may touch the next number only where its sign tells them apart.
  EXPECT_EQ(read_with("PIN   +1.50   -2", "PINPIN+123.500-2").rows, "0,123.500,-2,3.\n1,100.25,0,-7.5\n4,4,5,6\n");
  EXPECT_EQ(refusal("+100.25 +0 ", "+100.256701"),
            "t:4: Y: what is left of '701' runs into the column; expected a number in mm");
}

TEST(HeidenhainTables, MayEndEarlyOrLate) {
  EXPECT_THAT(read_with("[END]\r\n", "").doubts, ElementsAre("the file does not end in [END], so it may be cut short"));
  EXPECT_THAT(read_with("[END]\r\n", "[END]\n\n5   LATE  1       2       3\n").not_read,
              testing::Contains("what is behind [END], from line 9"));
  // Whatever is left of a file is read or refused.
  for (std::size_t length = 0; length < kTable.size(); ++length) {
    try {
      EXPECT_FALSE(read_as("heidenhain-table", kTable.substr(0, length)).lines.empty());
    } catch (const InputError&) {
    }
  }
}

TEST(HeidenhainTables, AreRefusedWhereTheyAreWrong) {
  EXPECT_EQ(refusal_of("heidenhain-table", ""), "t: no table of a Heidenhain control; expected 'BEGIN NAME.TAB MM'");
  EXPECT_EQ(refusal_of("heidenhain-table", "BEGIN PGM A MM\n"),
            "t:1: no table of a Heidenhain control; expected 'BEGIN NAME.TAB MM'");
  EXPECT_EQ(refusal_of("heidenhain-table", "BEGIN A.T MM\n"),
            "t:1: there are no columns; expected a line with the names of columns");
  const std::string columns = "; expected a first column such as NR, and columns X, Y and Z";
  EXPECT_EQ(refusal("Z     A", "L     A"), "t:2: columns: there is no Z" + columns);
  EXPECT_EQ(refusal("Z     A", "Z     X"), "t:2: columns: X is there twice" + columns);
  EXPECT_EQ(refusal("NR ", "X  "), "t:2: columns: X is the first column" + columns);
  EXPECT_EQ(refusal("-7.5", "1e99"), "t:4: Z: '1e99' is too large; expected a number in mm");
  EXPECT_EQ(refusal("-7.5", "abcd"), "t:4: Z: 'abcd' is not a number; expected a number in mm");
  EXPECT_EQ(refusal("-7.5", "nan "), "t:4: Z: 'nan' is not a finite number; expected a number in mm");
  EXPECT_EQ(refusal("-7.5", "+-7 "), "t:4: Z: '+-7' is not a number; expected a number in mm");
  EXPECT_EQ(refusal("-7.5", "    "), "t:4: Z: is empty; expected a number in mm, or none in X, Y and Z");
  EXPECT_EQ(refusal("1         +100.25", "          +100.25"),
            "t:4: NR: is empty; expected the number or the name of the row");
  EXPECT_EQ(refusal("1         +100.25", "1\t        +100.25"), "t:4: there is a tab; expected blanks between columns");
  EXPECT_EQ(refusal_of("heidenhain-table", "BEGIN A.TAB MM\nNR X Y Z\n0  - - -\n[END]\n"),
            "t: there are no points; expected rows with numbers in X, Y and Z, and [END]");
}

}  // namespace
}  // namespace abbe
