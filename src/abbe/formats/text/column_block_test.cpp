#include "abbe/formats/text/column_block.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "abbe/formats/text/column_block_for_test.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

using test::ColumnBlockText;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const std::vector<CsvColumn> kWantedOfBlock = {
    {"X", Quantity::length},
    {"C", Quantity::angle, false, false},
    {"u", Quantity::length, false, false, CsvColumn::Range::positive},
    {"u_C", Quantity::angle, false, false, CsvColumn::Range::positive, true},
    {"item", Quantity::dimensionless, true, false},
    {"point", Quantity::dimensionless, true, false, CsvColumn::Range::any, false, true}};

/// What is wrong with a block; empty: nothing.
std::string message_of_bytes(const std::string& block) {
  try {
    read_csv(block, "r.parquet", kWantedOfBlock);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string message_of_block(const ColumnBlockText& block) { return message_of_bytes(block.text()); }

std::vector<double> random_numbers(std::size_t count, unsigned seed, double factor) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> numbers(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = factor * (uniform(generator) + 1e-9);
    numbers[i] = i % 3 == 0 ? std::round(value * 1e4) / 1e4 + 1e-4 : value;
  }
  return numbers;
}

TEST(ColumnBlock, HasTheValuesOfTheCsvFileBitForBit) {
  const std::size_t rows = 3000;
  const std::vector<double> x = random_numbers(rows, 1, 900), u = random_numbers(rows, 2, 3);
  std::vector<double> c = random_numbers(rows, 3, 360), u_c = random_numbers(rows, 4, 2);
  c[7] = -0.0;
  std::vector<bool> stated(rows, true);
  std::vector<std::string> items, points;
  std::string csv = "X_um,C_deg,remark,u_um,u_C_arcsec,item,point\n";
  for (std::size_t k = 0; k < rows; ++k) {
    stated[k] = k % 5 != 0;
    items.push_back(k % 7 == 0 ? "side, left" : "middle");
    points.push_back(k % 2 == 0 ? "" : "P\"" + std::to_string(k));
    csv += shortest_text(x[k]) + "," + shortest_text(c[k]) + ",no," + shortest_text(u[k]) + "," +
           (stated[k] ? shortest_text(u_c[k]) : "") + "," + csv_field(items[k]) + "," + csv_field(points[k]) + "\n";
    if (!stated[k]) u_c[k] = -1;  // what a missing value has in its place counts for nothing
  }
  ColumnBlockText block(rows, 7);
  block.add_numbers("X_um", "float", x);
  block.add_numbers("C_deg", "float", c);
  block.add_head("remark", "list<item: int64>", false);
  block.add_numbers("u_um", "float", u);
  block.add_numbers("u_C_arcsec", "float", u_c, stated);
  block.add_texts("item", items);
  block.add_texts("point", points);
  const ColumnMapping mapping{{}, {"remark"}, ""};
  const CsvTable from_csv = read_csv(csv, "r.csv", kWantedOfBlock, mapping);
  const CsvTable table = read_csv(block.text(), "r.parquet", kWantedOfBlock, mapping, 2);
  ASSERT_EQ(table.rows, rows);
  for (std::size_t i = 0; i < kWantedOfBlock.size(); ++i) {
    const CsvValues &ours = table.columns[i], &theirs = from_csv.columns[i];
    EXPECT_TRUE(ours.present);
    EXPECT_EQ(ours.header, theirs.header);
    ASSERT_EQ(ours.numbers.size(), theirs.numbers.size());
    for (std::size_t k = 0; k < ours.numbers.size(); ++k) {
      EXPECT_EQ(std::signbit(ours.numbers[k]), std::signbit(theirs.numbers[k]));
      if (!std::isnan(theirs.numbers[k])) {
        EXPECT_EQ(ours.numbers[k], theirs.numbers[k]) << i << ", " << k;
      } else {
        EXPECT_TRUE(std::isnan(ours.numbers[k]));
      }
    }
    EXPECT_EQ(ours.words, theirs.words);
    EXPECT_EQ(ours.names, theirs.names);
    EXPECT_EQ(ours.labels, theirs.labels);
  }
}

TEST(ColumnBlock, NamesTheFirstRowOfWhatIsWrong) {
  const auto with_x = [](const std::vector<double>& x, const std::vector<bool>& present = {}) {
    ColumnBlockText block(3, 2);
    block.add_numbers("X_mm", "float", x, present);
    block.add_numbers("u_um", "float", {1, 1, 1});
    return message_of_block(block);
  };
  EXPECT_EQ(with_x({1, 2, 3}), "");
  EXPECT_EQ(with_x({1, kNan, kNan}), "r.parquet:3: X_mm: 'nan' is not a finite number; expected a length in mm");
  EXPECT_EQ(with_x({1, 2, -INFINITY}), "r.parquet:4: X_mm: '-inf' is not a finite number; expected a length in mm");
  EXPECT_EQ(with_x({1, 2, 1e10}), "r.parquet:4: X_mm: '10000000000' is too large; expected a length in mm");
  EXPECT_EQ(with_x({1, 2, 3}, {false, true, false}), "r.parquet:2: X_mm: is empty; expected a length in mm");
  ColumnBlockText block(2, 3);
  block.add_texts("item", {"a", ""});
  block.add_numbers("X_mm", "float", {1, 2});
  block.add_numbers("u_um", "float", {0, 1});
  EXPECT_EQ(message_of_block(block), "r.parquet:2: u_um: is 0; expected a length in um above zero");
}

TEST(ColumnBlock, RefusesMissingUnknownAndRepeatedColumnsAndOtherTypes) {
  ColumnBlockText without(1, 1);
  without.add_numbers("C_deg", "float", {1});
  EXPECT_EQ(message_of_block(without), "r.parquet: X: missing column; expected X_mm, X_um or X_m");
  ColumnBlockText unknown(1, 2);
  unknown.add_numbers("X_mm", "float", {1});
  unknown.add_numbers("Y_mm", "float", {1});
  EXPECT_THAT(message_of_block(unknown), HasSubstr("r.parquet: Y_mm: unknown column"));
  ColumnBlockText text(1, 1);
  text.add_texts("X_mm", {"1"});
  EXPECT_EQ(message_of_block(text),
            "r.parquet: X_mm: the column holds values of type text; expected a length in mm as float64, float32 or "
            "integers");
  ColumnBlockText times(1, 1);
  times.add_head("X_mm", "timestamp[us]", false);
  EXPECT_THAT(message_of_block(times), HasSubstr("X_mm: the column holds values of type timestamp[us]"));
  ColumnBlockText numbers(1, 2);
  numbers.add_numbers("X_mm", "float", {1});
  numbers.add_numbers("item", "float", {1});
  EXPECT_EQ(message_of_block(numbers),
            "r.parquet: item: the column holds values of type float; expected text (string), or integers");
  ColumnBlockText none(0, 1);
  none.add_numbers("X_mm", "float", {});
  EXPECT_EQ(message_of_block(none), "r.parquet: there are no rows; expected at least one row");
}

TEST(ColumnBlock, TakesIntegersAsNames) {
  ColumnBlockText block(3, 2);
  block.add_numbers("X_mm", "integer", {1, 2, 3});
  block.add_numbers("item", "integer", {12, 7, 12});
  const CsvTable table = read_csv(block.text(), "r.parquet", kWantedOfBlock);
  EXPECT_EQ(table.columns[0].numbers, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(table.columns[4].names, (std::vector<std::string>{"12", "7"}));
  EXPECT_EQ(table.columns[4].words, (std::vector<std::uint32_t>{0, 1, 0}));
}

TEST(ColumnBlock, IsRefusedWhereverItIsCutOffAndWhereNumbersOfBytesAreWrong) {
  ColumnBlockText whole(2, 2);
  whole.add_numbers("X_mm", "float", {1, 2}, {true, true});
  whole.add_texts("item", {"a", "bc"});
  const std::string block = whole.text();
  ASSERT_EQ(message_of_block(whole), "");
  for (std::size_t size = 8; size < block.size(); ++size) {
    EXPECT_NE(message_of_bytes(block.substr(0, size)), "") << size;
  }
  // Whatever a byte says, reading stays within the block (under the sanitizers).
  for (std::size_t at = 8; at < block.size(); ++at) {
    for (const char byte : {'\0', '\x7f', '\xff'}) {
      std::string damaged = block;
      damaged[at] = byte;
      static_cast<void>(message_of_bytes(damaged));
    }
  }
}

TEST(ColumnBlock, HasItsRowsInPlaceOfLines) {
  ColumnBlockText block(3, 1);
  block.add_numbers("X_mm", "float", {1, 2, 3});
  EXPECT_EQ(csv_line(block.text(), 2), 4U);
  EXPECT_EQ(csv_lines(block.text()), (std::vector<std::size_t>{2, 3, 4}));
}

}  // namespace
}  // namespace abbe
