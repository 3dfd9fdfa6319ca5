#include "abbe/formats/import/foreign_number.h"

#include <gtest/gtest.h>

#include <random>

#include "abbe/formats/import/exact_decimal.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

std::string plain_of(std::string_view field, DecimalMark decimal, ThousandsMark thousands) {
  std::string buffer;
  return std::string(plain_number(field, {decimal, thousands}, buffer));
}

TEST(ForeignNumber, MarksTellWhatTheyCan) {
  struct Case {
    const char* field;
    MarkEvidence evidence;
    ThousandsMark thousands = ThousandsMark::none;
  };
  using E = MarkEvidence;
  for (const Case& one : {
           Case{"12", E::none},
           Case{"-7e3", E::none},
           Case{"12.5", E::point},
           Case{"12,5", E::comma},
           Case{"1234.567", E::point},
           Case{"0,123", E::comma},
           Case{"-0.123", E::point},
           Case{",5", E::comma},
           Case{"1.234e3", E::point},
           Case{"1.234", E::point_or_thousands},
           Case{"-123,456", E::comma_or_thousands},
           Case{"1,234.5", E::point, ThousandsMark::comma},
           Case{"1.234,5", E::comma, ThousandsMark::point},
           Case{"1,234,567", E::point, ThousandsMark::comma},
           Case{"1.234.567", E::comma, ThousandsMark::point},
           Case{"1'234", E::none, ThousandsMark::apostrophe},
           Case{"1 234,5", E::comma, ThousandsMark::blank},
           Case{"1\xC2\xA0"
                "234",
                E::none, ThousandsMark::blank},
           Case{"\xE2\x88\x92"
                "1,5",
                E::comma},
           Case{"12.05.2024", E::not_a_number},
           Case{"1,23,456", E::not_a_number},
           Case{"12,34.5", E::not_a_number},
           Case{"", E::not_a_number},
           Case{"-", E::not_a_number},
           Case{".", E::not_a_number},
           Case{"1e", E::not_a_number},
           Case{"P1", E::not_a_number},
           Case{"1-2", E::not_a_number},
           Case{"nan", E::not_a_number},
           Case{"1 2", E::not_a_number},
       }) {
    const NumberMarks found = marks_of_number(one.field);
    EXPECT_EQ(found.evidence, one.evidence) << one.field;
    EXPECT_EQ(found.thousands, one.thousands) << one.field;
  }
}

TEST(ForeignNumber, KeepsItsDigits) {
  using D = DecimalMark;
  using T = ThousandsMark;
  EXPECT_EQ(plain_of("12.50", D::point, T::none), "12.50");
  EXPECT_EQ(plain_of("12,50", D::comma, T::none), "12.50");
  EXPECT_EQ(plain_of("-1.234,50", D::comma, T::point), "-1234.50");
  EXPECT_EQ(plain_of("+1,234,567.5", D::point, T::comma), "1234567.5");
  EXPECT_EQ(plain_of("1\xE2\x80\xAF"
                     "234",
                     D::point, T::blank),
            "1234");
  EXPECT_EQ(plain_of("1'234'567,8", D::comma, T::apostrophe), "1234567.8");
  EXPECT_EQ(plain_of("\xE2\x88\x92"
                     "3,5",
                     D::comma, T::none),
            "-3.5");
  EXPECT_EQ(plain_of("2.6415D+03", D::point, T::none), "2.6415e+03");
  EXPECT_EQ(plain_of("3,5E-2", D::comma, T::none), "3.5e-2");
  EXPECT_EQ(plain_of("0.1234567890123456789012345", D::point, T::none), "0.1234567890123456789012345");
  for (const char* const wrong : {"", "-", ".", "12,5", "1,234.5", "1e", "1.2.3", "12 ", "1 234", "--1", "1-", "0x1"}) {
    EXPECT_EQ(plain_of(wrong, D::point, T::none), "") << wrong;
  }
  for (const char* const wrong : {"1,23", "12,34,567", "1,2345", ",123", "1234,567", "1,234.5,6"}) {
    EXPECT_EQ(plain_of(wrong, D::point, T::comma), "") << wrong;
  }
}

TEST(ForeignNumber, AnglesInDegreesMinutesAndSecondsAreExact) {
  const auto seconds = [](std::string_view field, DecimalMark decimal = DecimalMark::point) {
    std::string buffer;
    return std::string(sexagesimal_arcseconds(field, decimal, buffer));
  };
  EXPECT_EQ(seconds("12°34'56.7\""), "45296.7");
  EXPECT_EQ(seconds("-0° 00′ 01.25″"), "-1.25");
  EXPECT_EQ(seconds("359:59:59,999", DecimalMark::comma), "1295999.999");
  EXPECT_EQ(seconds("12°34.5'"), "45270.0");
  EXPECT_EQ(seconds("90°00'"), "324000");
  for (const char* const wrong :
       {"12", "12.5", "12°", "12°60'00\"", "12°34'60\"", "12:34", "12:34:5x", "°'\"", "1.5°20'10\"", "12'34\"", ""}) {
    EXPECT_EQ(seconds(wrong), "") << wrong;
  }
}

TEST(ExactDecimalNumber, ConvertsWithoutRounding) {
  const auto times = [](const char* text, std::uint32_t factor, int shift) {
    ExactDecimal number = *ExactDecimal::of(text);
    number.multiply(factor);
    number.shift(shift);
    return number.text();
  };
  EXPECT_EQ(times("1.2345", 254, -1), "31.35630");
  EXPECT_EQ(times("-0.00001", 254, -1), "-0.000254");
  EXPECT_EQ(times("99999999999999999999999999", 4294967295U, 0), "429496729499999999999999995705032705");
  EXPECT_EQ(times("1e-3", 1, 1), "0.01");
  EXPECT_EQ(times("25e2", 1, 0), "2500");
  EXPECT_EQ(times("-0.00", 9, -1), "0.000");
  EXPECT_EQ(times("007.50", 1, 0), "7.50");
  for (const char* const wrong : {"", "-", ".", "1e", "1e99", "1,5", "x"})
    EXPECT_FALSE(ExactDecimal::of(wrong)) << wrong;
}

TEST(ExactDecimalNumber, AddsAsDoublesDo) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> digits(-99999999, 99999999), places(0, 9);
  for (int i = 0; i < 2000; ++i) {
    const std::string a = shortest_text(digits(random), -places(random)),
                      b = shortest_text(digits(random), -places(random));
    ExactDecimal sum = *ExactDecimal::of(a);
    sum.add(*ExactDecimal::of(b));
    double x = 0, y = 0, found = 0;
    ASSERT_EQ(parse_number(a, 0, x), NumberProblem::none);
    ASSERT_EQ(parse_number(b, 0, y), NumberProblem::none);
    ASSERT_EQ(parse_number(sum.text(), 0, found), NumberProblem::none) << sum.text();
    EXPECT_NEAR(found, x + y, 1e-15 * (std::abs(x) + std::abs(y))) << a << " + " << b;
    // Back again: exactly nothing is left.
    ExactDecimal minus = *ExactDecimal::of(b);
    minus.negate();
    sum.add(minus);
    ExactDecimal first = *ExactDecimal::of(a);
    first.negate();
    sum.add(first);
    EXPECT_EQ(sum.text().find_first_not_of("0."), std::string::npos) << sum.text();
  }
}

}  // namespace
}  // namespace abbe
