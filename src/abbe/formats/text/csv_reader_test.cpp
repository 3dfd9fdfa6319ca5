#include "abbe/formats/text/csv_reader.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

const std::vector<CsvColumn> kWanted = {{"X", Quantity::length},
                                        {"C", Quantity::angle},
                                        {"station", Quantity::dimensionless, true, false},
                                        {"u", Quantity::length, false, false, CsvColumn::Range::positive}};

std::string message_of_csv(const std::string& text, const ColumnMapping& mapping = {}) {
  return message_of([&] { read_csv(text, "m.csv", kWanted, mapping); });
}

TEST(CsvReader, ReadsColumnsInAnyOrderWithCommentsQuotesAndCarriageReturns) {
  const CsvTable table = read_csv(
      "\xEF\xBB\xBF# written by hand\r\n\r\nstation, \"C_deg\" ,X_um\r\n\"a \"\"b\"\"\", 180 ,\"1500\"\r\n# between\r\n"
      "c,-90,+2.5e3\r\n \t\r\n\"a \"\"b\"\"\",0,.5",
      "m.csv", kWanted);
  ASSERT_EQ(table.rows, 3U);
  EXPECT_EQ(table.columns[0].numbers, (std::vector<double>{1.5, 2.5, 0.0005}));
  EXPECT_DOUBLE_EQ(table.columns[1].numbers[0], 3.14159265358979323846);
  EXPECT_EQ(table.columns[2].names, (std::vector<std::string>{"a \"b\"", "c"}));
  EXPECT_EQ(table.columns[2].words, (std::vector<std::uint32_t>{0, 1, 0}));
  EXPECT_FALSE(table.columns[3].present);
}

TEST(CsvReader, ReadsForeignColumnsByMappingAndLeavesIgnoredOnesUnread) {
  const ColumnMapping mapping{{{"X_mm", "x"}, {"C_deg", "angle"}}, {"remark"}, ""};
  const CsvTable table = read_csv("remark,x,angle\n\"no, number\",1,2\n", "m.csv", kWanted, mapping);
  EXPECT_EQ(table.columns[0].numbers, (std::vector<double>{1}));
  EXPECT_EQ(message_of_csv("x_mm,angle\n1,2\n", {{{"X_mm", "y"}}, {}, "`ignore`"}),
            "m.csv:1:1: x_mm: unknown column (did you mean X_mm?); expected one of X, C, station, u; or its name under "
            "`ignore`");
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n1,2\n", {{{"station", "s"}}, {}, ""}),
            "m.csv:1: s: there is no such column to be read as station");
}

TEST(CsvReader, KeepsTheOrderOfManyRowsWhateverTheNumberOfThreads) {
  std::string text = "X_mm,station,C_rad\n";
  std::mt19937_64 generator(5);
  std::vector<double> expected;
  for (int i = 0; i < 150000; ++i) {
    const double value = static_cast<double>(generator() % 2000000001) * 1e-7 - 100;
    expected.push_back(value);
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "%.17g,s%d,%d.%d%s", value, (i / 7000) % 9 + i / 80000, i % 6, i,
                  i % 1000 == 0 ? "\r\n#\n" : "\n");
    text += buffer;
  }
  const CsvTable one = read_csv(text, "m.csv", kWanted, {}, 1);
  const CsvTable two = read_csv(text, "m.csv", kWanted, {}, 3);
  ASSERT_GT(text.size(), std::size_t{3} << 20);  // several blocks
  ASSERT_EQ(one.rows, expected.size());
  EXPECT_EQ(one.columns[0].numbers, expected);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(one.columns[i].numbers, two.columns[i].numbers);
    EXPECT_EQ(one.columns[i].words, two.columns[i].words);
    EXPECT_EQ(one.columns[i].names, two.columns[i].names);
  }
  EXPECT_EQ(one.columns[2].names[one.columns[2].words[7001]], "s1");
  EXPECT_EQ(one.columns[2].names[one.columns[2].words[149999]], "s4");
}

TEST(CsvReader, ReportsTheFirstWrongRowOfAManyBlockFile) {
  std::string text = "X_mm,C_deg\n";
  for (int i = 0; i < 400000; ++i) text += i == 300000 || i == 390000 ? "1,x\n" : "1.25,2\n";
  EXPECT_EQ(message_of_csv(text), "m.csv:300002:3: C_deg: 'x' is not a number; expected an angle in deg");
}

TEST(CsvReader, RefusesWrongUnitsAndColumns) {
  EXPECT_EQ(message_of_csv("X_deg,C_deg\n1,2\n"),
            "m.csv:1:1: X_deg: 'deg' is not a unit of a length; expected X_mm, X_um or X_m");
  EXPECT_EQ(message_of_csv("X_mm,C\n1,2\n"),
            "m.csv:1:6: C: the unit is missing from the name of this column; expected C_rad, C_mrad, C_urad, C_deg or "
            "C_arcsec");
  EXPECT_EQ(message_of_csv("# c\nX_mm\n1\n"),
            "m.csv:2: C: missing column; expected C_rad, C_mrad, C_urad, C_deg or C_arcsec");
  EXPECT_EQ(message_of_csv("X_mm,C_deg,X_mm\n1,2,3\n"), "m.csv:1:12: X_mm: this column is given twice");
  EXPECT_EQ(message_of_csv("X_mm,C_deg,X_um\n1,2,3\n"), "m.csv:1:12: X_um: says the same as column X_mm");
  EXPECT_EQ(message_of_csv("X_mm,C_deg,stadion\n1,2,3\n"),
            "m.csv:1:12: stadion: unknown column (did you mean station?); expected one of X, C, station, u");
  EXPECT_EQ(message_of_csv("X_mm;C_deg\n1,5;2\n"),
            "m.csv:1:1: X_mm;C_deg: the columns are not separated by commas; expected commas between columns and a "
            "decimal point (abbe import converts other tables)");
  EXPECT_EQ(message_of_csv("X_mm,,C_deg\n1,2,3\n"), "m.csv:1:6: column 2 has no name");
}

TEST(CsvReader, RefusesFieldsThatAreNoNumbersOfTheUnit) {
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n1,nan\n"),
            "m.csv:2:3: C_deg: 'nan' is not a finite number; expected an angle in deg");
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n1e308,2\n"), "m.csv:2:1: X_mm: '1e308' is too large; expected a length in mm");
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n99999999999,2\n"),
            "m.csv:2:1: X_mm: '99999999999' is too large; expected a length in mm");
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n,2\n"), "m.csv:2:1: X_mm: is empty; expected a length in mm");
  EXPECT_EQ(message_of_csv("X_um,C_deg\n1.5mm,2\n"),
            "m.csv:2:1: X_um: '1.5mm' is not a number; expected a length in um");
  EXPECT_EQ(message_of_csv("X_mm,C_deg,u_um\n1,2,0\n"), "m.csv:2:5: u_um: is 0; expected a length in um above zero");
  EXPECT_EQ(message_of_csv("X_mm,C_deg,u_um\n1,2,-1\n"), "m.csv:2:5: u_um: is -1; expected a length in um above zero");
  EXPECT_EQ(message_of_csv("X_mm,C_deg,station\n1,2,\n"), "m.csv:2:5: station: is empty; expected a name");
}

TEST(CsvReader, RefusesRowsOfTheWrongLengthAndOpenQuotes) {
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n1\n"), "m.csv:2:1: the row has 1 field; expected 2 as in the header");
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n1,5,2,5\n"), "m.csv:2:1: the row has 4 fields; expected 2 as in the header");
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n1,2,\n"), "m.csv:2:1: the row has 3 fields; expected 2 as in the header");
  EXPECT_EQ(message_of_csv("X_mm,C_deg,station\n1,2,\"a\n\"\n"),
            "m.csv:2:5: station: the quote is not closed before the comma or the end of the line");
  EXPECT_EQ(message_of_csv(""), "m.csv: the file is empty; expected a header line with column names");
  EXPECT_EQ(message_of_csv("# only\n"), "m.csv: the file is empty; expected a header line with column names");
  EXPECT_EQ(message_of_csv("X_mm,C_deg\n# no data\n"),
            "m.csv: there are no rows below the header; expected at least one row");
}

TEST(CsvReader, FindsTheLineOfARow) {
  const char* text = "\xEF\xBB\xBF# c\nX_mm\n1\n\n# d\n2\n";
  EXPECT_EQ(csv_line(text, 0), 3U);
  EXPECT_EQ(csv_line(text, 1), 6U);
  EXPECT_EQ(csv_lines(text), (std::vector<std::size_t>{3, 6}));
}

}  // namespace
}  // namespace abbe
