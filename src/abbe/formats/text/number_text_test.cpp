#include "abbe/formats/text/number_text.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>

#include "abbe/formats/text/appended_number.h"
#include "abbe/formats/text/decimal_text.h"
#include "abbe/formats/text/unit.h"

namespace abbe {
namespace {

double random_double(std::mt19937_64& generator) {
  for (;;) {
    const double value = std::bit_cast<double>(generator());
    if (std::isfinite(value) && std::abs(value) < 1e300 && std::abs(value) > 1e-290) return value;
  }
}

TEST(NumberText, ShortestTextReadsBackToTheSameBitsInEveryUnit) {
  std::mt19937_64 generator(3);
  for (int i = 0; i < 20000; ++i) {
    const double value = random_double(generator);
    for (const int shift : {0, 3, 6, -3}) {
      double back = 0;
      ASSERT_EQ(parse_number(shortest_text(value, shift), -shift, back), NumberProblem::none);
      ASSERT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value)) << shortest_text(value, shift);
    }
  }
}

TEST(NumberText, IsShortAndPlain) {
  EXPECT_EQ(shortest_text(0.1), "0.1");
  EXPECT_EQ(shortest_text(0.0025, 3), "2.5");
  EXPECT_EQ(shortest_text(1.4e-5, 6), "14");
  EXPECT_EQ(shortest_text(-1400), "-1400");
  EXPECT_EQ(shortest_text(-0.0), "-0");
  EXPECT_EQ(shortest_text(1e300), "1e300");
  EXPECT_EQ(shortest_text(1.5e-9), "1.5e-9");
  EXPECT_EQ(shortest_text(123456.789), "123456.789");
}

TEST(NumberText, HasTheShortestDigitsOfEveryMagnitude) {
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> power(-7, 19);
  std::uniform_int_distribution<int> places(0, 16);
  for (int i = 0; i < 50000; ++i) {
    double value = std::pow(10.0, power(generator));
    if (i % 3 == 0) value = std::round(value * 1e3) / 1e3 + (i % 2 == 0 ? 0 : std::pow(10.0, -places(generator)));
    if (value == 0) continue;
    std::array<char, 32> buffer;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific);
    const std::string_view expected(buffer.data(), static_cast<std::size_t>(end.ptr - buffer.data()));
    // Without the point, the zeros in front and those behind: the digits alone.
    const auto digits_of = [](std::string_view text) {
      std::string digits;
      for (const char c : text.substr(0, text.find('e'))) {
        if (c != '.' && (c != '0' || !digits.empty())) digits += c;
      }
      digits.erase(digits.find_last_not_of('0') + 1);
      return digits;
    };
    std::string text = "before,";
    append_shortest_text(-value, 0, text);
    ASSERT_EQ(text, "before,-" + shortest_text(value));
    ASSERT_EQ(digits_of(shortest_text(value)), digits_of(expected)) << shortest_text(value);
    ASSERT_EQ(shortest_text(value).find('e') != std::string::npos, value < 1e-5 || value >= 1e17) << value;
  }
}

TEST(NumberText, ParsesAsTheStandardLibraryDoes) {
  std::mt19937_64 generator(4);
  std::uniform_int_distribution<int> digit('0', '9'), length(0, 24), exponent(-30, 30);
  int compared = 0;
  for (int i = 0; i < 50000; ++i) {
    std::string text = i % 3 == 0 ? "-" : "";
    for (int k = length(generator); k >= 0; --k) text += static_cast<char>(digit(generator));
    if (i % 2 == 0) text += '.';
    for (int k = length(generator); k > 0 && i % 2 == 0; --k) text += static_cast<char>(digit(generator));
    if (i % 5 == 0) text += "e" + std::to_string(exponent(generator));
    double expected = 0, found = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), expected);
    ASSERT_EQ(result.ec, std::errc());
    ASSERT_EQ(parse_number(text, 0, found), NumberProblem::none) << text;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(found), std::bit_cast<std::uint64_t>(expected)) << text;
    ++compared;
  }
  EXPECT_EQ(compared, 50000);
}

TEST(NumberText, TheShortWayGivesTheBitsOfTheLongOneOrLeavesTheNumberToIt) {
  std::mt19937_64 random(12);
  int taken = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string text = random() % 3 == 0 ? "-" : "";
    const std::uint64_t before = random() % 12, behind = random() % 12;
    for (std::uint64_t k = 0; k < before; ++k) text += static_cast<char>('0' + random() % 10);
    if (random() % 4 != 0) text += '.';
    for (std::uint64_t k = 0; k < behind; ++k) text += static_cast<char>('0' + random() % 10);
    if (random() % 2 == 0) {
      text += random() % 2 == 0 ? 'e' : 'E';
      text += std::array<const char*, 3>{"", "-", "+"}[random() % 3];
      const std::uint64_t exponent = random() % 4;
      for (std::uint64_t k = 0; k < exponent; ++k) text += static_cast<char>('0' + random() % (k == 0 ? 3 : 10));
    }
    double quick = 0, known = 0;
    const int shift = static_cast<int>(random() % 13) - 6;
    const char* const behind_it = read_short_decimal(text.data(), text.data() + text.size(), shift, quick);
    if (behind_it != text.data() + text.size()) continue;
    ++taken;
    ASSERT_EQ(parse_number(text, shift, known), NumberProblem::none) << text;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(quick), std::bit_cast<std::uint64_t>(known)) << text;
  }
  EXPECT_GT(taken, 80000);
  double value = 0;
  const std::string_view usual = "-1.234567e+01 ";
  EXPECT_EQ(read_short_decimal(usual.data(), usual.data() + usual.size(), 0, value), usual.data() + 13);
  EXPECT_EQ(value, -12.34567);
}

TEST(NumberText, RefusesWhatIsNoDecimalNumber) {
  double value = 0;
  for (const char* text :
       {"", "-", ".", "1,5", "1.5mm", " 1", "1 ", "0x10", "1e", "1e+", "--1", "1.2.3", "e5", "1_000"}) {
    EXPECT_EQ(parse_number(text, 0, value), NumberProblem::not_a_number) << text;
  }
  for (const char* text : {"nan", "NaN", "-inf", "INF", "+Infinity"}) {
    EXPECT_EQ(parse_number(text, 0, value), NumberProblem::not_finite) << text;
  }
  EXPECT_EQ(parse_number("1e400", 0, value), NumberProblem::too_large);
  // Of its digits alone, however the exponent is written.
  EXPECT_EQ(parse_number(std::string(400, '7'), 0, value), NumberProblem::too_large);
  EXPECT_EQ(parse_number(std::string(800, '7') + "e-400", 0, value), NumberProblem::too_large);
  EXPECT_EQ(parse_number("0." + std::string(700, '0') + "1e400", 0, value), NumberProblem::none);
  EXPECT_EQ(parse_number("1e-400", 0, value), NumberProblem::none);
  EXPECT_EQ(value, 0);
  EXPECT_EQ(parse_number("+.5", 0, value), NumberProblem::none);
  EXPECT_EQ(value, 0.5);
}

TEST(NumberText, NeverWritesNanAsANumber) {
  EXPECT_THROW(shortest_text(std::numeric_limits<double>::quiet_NaN()), std::logic_error);
  EXPECT_THROW(shortest_text(-std::numeric_limits<double>::infinity()), std::logic_error);
}

TEST(Unit, ConvertsToMillimetreAndRadian) {
  double value = 0;
  EXPECT_EQ(parse_quantity("2.5", unit_named(Quantity::length, "um"), value), NumberProblem::none);
  EXPECT_EQ(value, 0.0025);
  EXPECT_EQ(parse_quantity("180", unit_named(Quantity::angle, "deg"), value), NumberProblem::none);
  EXPECT_DOUBLE_EQ(value, 3.14159265358979323846);
  EXPECT_EQ(parse_quantity("648000", unit_named(Quantity::angle, "arcsec"), value), NumberProblem::none);
  EXPECT_DOUBLE_EQ(value, 3.14159265358979323846);
  EXPECT_EQ(parse_quantity("5", unit_named(Quantity::length_per_length, "um_per_m"), value), NumberProblem::none);
  EXPECT_EQ(value, 5e-6);
  EXPECT_EQ(parse_quantity("1e308", unit_named(Quantity::length, "mm"), value), NumberProblem::too_large);
}

TEST(Unit, NamesAreTakenApartExactly) {
  EXPECT_NE(unit_of_name("range_um", "range", Quantity::length), nullptr);
  EXPECT_EQ(unit_of_name("range_um_per_m", "range", Quantity::length), nullptr);
  EXPECT_NE(unit_of_name("range_um_per_m", "range", Quantity::length_per_length), nullptr);
  EXPECT_EQ(unit_of_name("range", "range", Quantity::length), nullptr);
  EXPECT_EQ(accepted_names("travel", Quantity::length), "travel_mm, travel_um or travel_m");
}

}  // namespace
}  // namespace abbe
