#include "abbe/report/customer/local_numbers.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

constexpr ReportLanguage kEnglish = ReportLanguage::english, kGerman = ReportLanguage::german,
                         kChinese = ReportLanguage::chinese, kJapanese = ReportLanguage::japanese;

TEST(LocalNumber, GermanHasADecimalCommaAndTheOthersAPoint) {
  EXPECT_EQ(local_number(1234.567, 2, kGerman), "1234,57");
  for (const ReportLanguage language : {kEnglish, kChinese, kJapanese}) {
    EXPECT_EQ(local_number(1234.567, 2, language), "1234.57");
  }
}

TEST(LocalNumber, MinusIsASignAndZeroHasNone) {
  EXPECT_EQ(local_number(-0.25, 2, kEnglish), "−0.25");
  EXPECT_EQ(local_number(-0.25, 2, kGerman), "−0,25");
  EXPECT_EQ(local_number(-0.001, 2, kEnglish), "0.00");
  EXPECT_EQ(local_number(-0.4, 0, kEnglish), "0");
}

TEST(LocalNumber, ShortNumbersHaveTheDecimalsTheyNeed) {
  EXPECT_EQ(local_short_number(12.5, kGerman), "12,5");
  EXPECT_EQ(local_short_number(-460, kJapanese), "−460");
  EXPECT_EQ(local_short_number(0, kEnglish), "0");
}

TEST(LocalDate, FollowsTheLanguage) {
  const CalendarDate date = std::chrono::year{2026} / 3 / 5;
  EXPECT_EQ(local_date(date, kEnglish), "2026-03-05");
  EXPECT_EQ(local_date(date, kGerman), "05.03.2026");
  EXPECT_EQ(local_date(date, kChinese), "2026年3月5日");
  EXPECT_EQ(local_date(date, kJapanese), "2026年3月5日");
}

TEST(LocalDrawing, OnlyNumbersChangeTheirSign) {
  const std::string svg =
      "<svg viewBox=\"0 0 1.5 2\"><text x=\"3.5\">−0.25</text><text>0.5</text><text>E 1.5</text>"
      "<style>a{b:1.5}</style></svg>";
  EXPECT_EQ(local_drawing(svg, kEnglish), svg);
  EXPECT_EQ(local_drawing(svg, kGerman),
            "<svg viewBox=\"0 0 1.5 2\"><text x=\"3.5\">−0,25</text><text>0,5</text><text>E 1.5</text>"
            "<style>a{b:1.5}</style></svg>");
  EXPECT_EQ(local_drawing("", kGerman), "");
  EXPECT_EQ(local_drawing("<a>1.", kGerman), "<a>1.") << "no end";
}

TEST(DecimalsFor, ShowTwoDigitsOfTheUncertainty) {
  EXPECT_EQ(decimals_for(0.45), 2);
  EXPECT_EQ(decimals_for(4.5), 1);
  EXPECT_EQ(decimals_for(45), 0);
  EXPECT_EQ(decimals_for(4500), 0);
  EXPECT_EQ(decimals_for(1e-9), 3);
  EXPECT_EQ(decimals_for(0), 2) << "not known";
}

}  // namespace
}  // namespace abbe
