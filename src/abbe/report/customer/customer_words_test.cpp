#include "abbe/report/customer/customer_words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace abbe {
namespace {

constexpr ReportLanguage kLanguages[] = {ReportLanguage::english, ReportLanguage::german, ReportLanguage::chinese,
                                         ReportLanguage::japanese};

std::ptrdiff_t places_in(std::string_view text) { return std::count(text.begin(), text.end(), '{'); }

bool has_east_asian_letter(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) >= 0xE3; });
}

TEST(CustomerWords, EveryLanguageHasEveryWordWithTheSamePlaces) {
  for (int i = 0; i < static_cast<int>(CustomerWord::count_); ++i) {
    const CustomerWord word = static_cast<CustomerWord>(i);
    const std::ptrdiff_t places = places_in(customer_word(word, ReportLanguage::english));
    for (const ReportLanguage language : kLanguages) {
      const std::string_view text = customer_word(word, language);
      EXPECT_FALSE(text.empty()) << i << language_code(language);
      EXPECT_EQ(places_in(text), places) << text;
      EXPECT_EQ(text.find("\n"), std::string_view::npos) << text;
    }
  }
}

TEST(CustomerWords, NoWordIsLeftInEnglish) {
  for (int i = 0; i < static_cast<int>(CustomerWord::count_); ++i) {
    const CustomerWord word = static_cast<CustomerWord>(i);
    // Symbols are the same everywhere; Name and Position are German words, too.
    if (word == CustomerWord::scatter_positive || word == CustomerWord::scatter_negative ||
        word == CustomerWord::there || word == CustomerWord::back) {
      continue;
    }
    const std::string_view english = customer_word(word, ReportLanguage::english);
    if (word != CustomerWord::name && word != CustomerWord::position) {
      EXPECT_NE(customer_word(word, ReportLanguage::german), english);
    }
    for (const ReportLanguage language : {ReportLanguage::chinese, ReportLanguage::japanese}) {
      EXPECT_TRUE(has_east_asian_letter(customer_word(word, language))) << english;
    }
  }
}

TEST(CustomerWords, FiguresOfPositioningHaveNamesInEveryLanguage) {
  for (const char* symbol :
       {"A", "A+", "A-", "E", "E+", "E-", "M", "R", "R+", "R-", "B", "B_mean", "E_d", "B_d", "R_d", "A_d"}) {
    for (const ReportLanguage language : kLanguages) {
      EXPECT_FALSE(positioning_figure_name(symbol, language).empty()) << symbol;
    }
  }
  EXPECT_TRUE(positioning_figure_name("G", ReportLanguage::english).empty());
}

TEST(CustomerWords, TextsAreFilledInTheirPlaces) {
  EXPECT_EQ(
      customer_text(CustomerWord::temperature_range, ReportLanguage::german, std::vector<std::string>{"19,8", "20,9"}),
      "19,8 bis 20,9 °C");
  EXPECT_EQ(customer_text(CustomerWord::axis_errors, ReportLanguage::japanese, "X"), "X 軸の各位置における誤差");
}

}  // namespace
}  // namespace abbe
