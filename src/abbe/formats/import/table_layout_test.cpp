#include "abbe/formats/import/table_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string message_of_layout(const std::string& text, const LayoutHints& hints = {}) {
  return message_of([&] { find_layout(text, "t.txt", hints); });
}

TEST(TableLayoutOfText, FindsSeparatorHeaderUnitsAndRows) {
  const FoundLayout german = find_layout("Messung 7\r\n\r\nPunkt;X;Y\r\n;mm;mm\r\nA;1,5;2\r\nB;3;4,25\r\n", "t.txt");
  EXPECT_EQ(german.layout.separator, FieldSeparator::semicolon);
  EXPECT_EQ(german.layout.decimal, DecimalMark::comma);
  EXPECT_EQ(german.layout.header_line, 3U);
  EXPECT_EQ(german.layout.unit_line, 4U);
  EXPECT_EQ(german.layout.first_line, 5U);
  EXPECT_THAT(german.names, ElementsAre("Punkt", "X", "Y"));
  EXPECT_THAT(german.units, ElementsAre("", "mm", "mm"));
  EXPECT_THAT(german.reasons, Contains("decimal comma: '1,5' in line 5"));
  EXPECT_THAT(german.doubts, IsEmpty());

  const FoundLayout tabs = find_layout("Point 1\t1.5\t2\nPoint 2\t3\t4\n", "t.txt");
  EXPECT_EQ(tabs.layout.separator, FieldSeparator::tab);
  EXPECT_EQ(tabs.layout.header_line, 0U);
  EXPECT_EQ(tabs.layout.first_line, 1U);

  const FoundLayout blanks = find_layout("  x   y\n 1.5  2\n3\t-4\n", "t.txt");
  EXPECT_EQ(blanks.layout.separator, FieldSeparator::blanks);
  EXPECT_THAT(blanks.names, ElementsAre("x", "y"));

  // A carriage return within a line is a blank.
  EXPECT_THAT(find_layout("x y\r z\n1.5 2 \r3\n", "t.txt").names, ElementsAre("x", "y", "z"));

  const FoundLayout numpy = find_layout("# made by a script\n# x,y,z\n1.5,2,3\n", "t.txt");
  EXPECT_EQ(numpy.layout.comment, "#");
  EXPECT_EQ(numpy.layout.header_line, 2U);
  EXPECT_THAT(numpy.names, ElementsAre("x", "y", "z"));
}

TEST(TableLayoutOfText, CommasAreSeparatorsOrDecimals) {
  EXPECT_EQ(find_layout("x,y,z\n1,2,3\n", "t").layout.separator, FieldSeparator::comma);
  EXPECT_EQ(find_layout("x y z\n1,5 2,5 3,5\n", "t").layout.separator, FieldSeparator::blanks);
  EXPECT_EQ(find_layout("x y z\n1,5 2,5 3,5\n", "t").layout.decimal, DecimalMark::comma);
  EXPECT_EQ(find_layout("x;y\n1,5;2,5\n", "t").layout.separator, FieldSeparator::semicolon);
  EXPECT_EQ(find_layout("x, y, z\n1.5, 2.5, 3.5\n", "t").layout.separator, FieldSeparator::comma);
  const FoundLayout quoted = find_layout("name,x,y\n\"a, b\",\"1,234.5\",2\n", "t");
  EXPECT_EQ(quoted.layout.separator, FieldSeparator::comma);
  EXPECT_EQ(quoted.layout.decimal, DecimalMark::point);
  EXPECT_EQ(quoted.layout.thousands, ThousandsMark::comma);
}

TEST(TableLayoutOfText, AllRowsDecideAboutTheDecimalMark) {
  const auto marks = [](const std::string& rows, const LayoutHints& hints = {}) {
    const TableLayout layout = find_layout("x;y\n" + rows, "t", hints).layout;
    return std::string(decimal_name(layout.decimal)) + " " + std::string(thousands_name(layout.thousands));
  };
  EXPECT_EQ(marks("1,234;5\n2,5;6\n"), "comma none");
  EXPECT_EQ(marks("1,234;5\n2.5;6\n"), "point comma");
  EXPECT_EQ(marks("1.234;5\n2,5;6\n"), "comma point");
  EXPECT_EQ(marks("1.234;0.123\n"), "point none");
  EXPECT_EQ(marks("1'234.5;2\n"), "point apostrophe");
  EXPECT_EQ(marks("1 234,5;2\n"), "comma blank");
  EXPECT_EQ(marks("1;2\n"), "point none");
  // A column of texts tells nothing: a version is no number of the table.
  EXPECT_EQ(marks("1,5;v1\n2,5;3.7\n"), "comma none");
  EXPECT_EQ(marks("1,234;5\n", {.separator = {}, .decimal = DecimalMark::comma}), "comma none");
  EXPECT_EQ(marks("1,234;5\n", {.separator = {}, .decimal = DecimalMark::point}), "point comma");
}

TEST(TableLayoutOfText, WhatNothingDecidesIsAskedFor) {
  EXPECT_EQ(message_of_layout("x;y\n1;2\n3;1,234\n"),
            "t.txt:3:3: '1,234' in line 3 may have decimals or thousands, and the table does not show which; expected "
            "--decimal point or --decimal comma");
  EXPECT_THAT(message_of_layout("x;y\n1.234;2\n"), HasSubstr("'1.234' in line 2 may have decimals or thousands"));
  EXPECT_THAT(message_of_layout("x;y\n1.234;1,234\n"), HasSubstr("one of '1.234' in line 2 and '1,234' in line 2 has"));
  EXPECT_THAT(message_of_layout("x;y\n1.5;2\n3;4,5\n"),
              HasSubstr("t.txt:3:3: has another decimal mark than an earlier number: '1.5' in line 2 and '4,5' in "
                        "line 3"));
  EXPECT_THAT(message_of_layout("x;y\n1'234.5;2\n3;1,234.5\n"), HasSubstr("another mark of thousands"));
  // Between commas a point is the decimal mark.
  EXPECT_EQ(find_layout("x,y\n1.234,2.345\n", "t").layout.decimal, DecimalMark::point);
}

TEST(TableLayoutOfText, CommentsAreNoRowsAndPointsCalledWithTheirMarkAreNoComments) {
  const FoundLayout one = find_layout("% a\n% b\n% c\n% d\n1;2\n", "t");
  EXPECT_EQ(one.layout.comment, "%");
  EXPECT_EQ(one.layout.first_line, 5U);
  const FoundLayout named = find_layout("Name;x;y\n#1;1;2\n#2;3;4\n#3;5;6\n#4;7;8\n", "t");
  EXPECT_EQ(named.layout.comment, "");
  EXPECT_EQ(named.layout.first_line, 2U);
  const FoundLayout hidden = find_layout("# test\nx;y\n1;2\n#3;4\n5;6\n", "t");
  EXPECT_THAT(hidden.doubts, ElementsAre("line 4 begins with # and looks like a row; it is skipped"));
}

TEST(TableLayoutOfText, ABrokenFirstRowIsARow) {
  // Otherwise it would be taken for a line above the table and not be missed.
  EXPECT_EQ(find_layout("a;b;c;d\n1;n/a;3;4\n5;6;7;8\n9;8;7;6\n", "t").layout.first_line, 2U);
}

TEST(TableLayoutOfText, OneRowIsATableAndTextIsNone) {
  const FoundLayout one = find_layout("Temperature;20,5\nx;y;z\n1,5;2;3\n", "t");
  EXPECT_EQ(one.layout.header_line, 2U);
  EXPECT_EQ(one.layout.first_line, 3U);
  EXPECT_THAT(message_of_layout("Dear Sir,\nthe table follows\n"), HasSubstr("no table was found; expected a table"));
  EXPECT_THAT(message_of_layout("x;y\n"), HasSubstr("no table was found"));
  EXPECT_THAT(message_of_layout("1\n2\n3\n"), HasSubstr("no table was found"));
}

TEST(TableLayoutOfText, GivenIsReadAsItIs) {
  TableLayout layout;
  layout.separator = FieldSeparator::semicolon;
  layout.header_line = 2;
  layout.first_line = 3;
  const FoundLayout found = layout_as_given("remark\nx;y\n1;2\n", "t.txt", layout);
  EXPECT_THAT(found.names, ElementsAre("x", "y"));
  EXPECT_THAT(message_of([&] { layout_as_given("x;y\n1;2\n", "t.txt", layout); }),
              HasSubstr("there are no rows from line 3 on"));
  EXPECT_THAT(message_of([&] { layout_as_given("a\nb\n1;2\n", "t.txt", layout); }),
              HasSubstr("t.txt:2: is not a header of the 2 columns of the rows"));
  layout.unit_line = 1;
  EXPECT_THAT(message_of([&] { layout_as_given("a;b\nx;y\n1;2\n", "t.txt", layout); }),
              HasSubstr("t.txt:1: is not a row of units"));
}

}  // namespace
}  // namespace abbe
