#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/report/customer/customer_report.h"
#include "abbe/report/customer/customer_style.h"
#include "abbe/report/report.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

CustomerReport small_customer_report(ReportLanguage language) {
  CustomerReport report;
  report.facts.language = language;
  report.subject = "X axis";
  report.states = {{"measured", ""}};
  CustomerFigure figure;
  figure.symbol = "A";
  figure.name = "accuracy";
  figure.unit = "µm";
  figure.states = {{9.25, 0.5}};
  figure.tolerance = 12;
  report.figures = {figure};
  return report;
}

TEST(CustomerPage, ShowsEveryFactThatIsStated) {
  CustomerReport report = small_customer_report(ReportLanguage::english);
  report.facts.customer = "Werk <Nord>";
  report.facts.maker = "Maker";
  report.facts.model = "M1";
  report.facts.serial_number = "4711";
  report.facts.operator_name = "An Operator";
  report.facts.date = std::chrono::year{2026} / 11 / 28;
  report.facts.temperature = 20.31;
  report.facts.temperature_range = {19.8, 20.9};
  report.facts.instruments = {{"laser", "L1", "C-9", std::chrono::year{2027} / 1 / 31}};
  const std::string page = customer_page(report);
  for (const char* text : {"Werk &lt;Nord&gt;", "Maker M1", "4711", "An Operator", "2026-11-28",
                           "mean 20.3 °C, 19.8 to 20.9 °C", "C-9", "2027-01-31", "9.25 ± 0.50", "<td>12</td>",
                           "conformity proven", "Conformity with the specification is proven: A."}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  EXPECT_THAT(page, Not(HasSubstr("class=\"warning\"")));
  EXPECT_LT(page.size(), kReportSizeLimit);
}

TEST(CustomerPage, WhatIsNotStatedIsShownAsNotStated) {
  const std::string page = customer_page(small_customer_report(ReportLanguage::german));
  EXPECT_THAT(page, HasSubstr("<dt>Kunde</dt><dd><i>nicht angegeben</i></dd>"));
  EXPECT_THAT(page, HasSubstr("9,25 ± 0,50"));
  EXPECT_THAT(page, HasSubstr("<html lang=\"de\">"));
}

TEST(CustomerPage, WarnsOnItsFirstSheet) {
  CustomerReport report = small_customer_report(ReportLanguage::english);
  report.facts.date = std::chrono::year{2026} / 11 / 28;
  report.facts.instruments = {{"laser", "L1", "C-9", std::chrono::year{2026} / 11 / 27},
                              {"level", "", "", std::nullopt}};
  report.is_simulated = true;
  report.refusals = {"misfit <5>"};
  report.figures[0].tolerance = 5;
  const std::string page = customer_page(report);
  const std::size_t begin = page.find("class=\"warning\""), figures = page.find("class=\"figures");
  ASSERT_LT(begin, figures);
  const std::string warnings = page.substr(begin, page.find("</section>", begin) - begin);
  EXPECT_THAT(warnings, HasSubstr("Simulated"));
  EXPECT_THAT(warnings, HasSubstr("must not be used as it is"));
  EXPECT_THAT(warnings, HasSubstr("misfit &lt;5&gt;"));
  EXPECT_THAT(warnings, HasSubstr("Beyond the tolerance, or not evaluated: A."));
  EXPECT_THAT(warnings, HasSubstr("The certificate of laser was not valid"));
  EXPECT_THAT(warnings, Not(HasSubstr("level")));
}

TEST(CustomerPage, ACertificateIsValidOnItsLastDay) {
  CustomerReport report = small_customer_report(ReportLanguage::english);
  report.facts.date = std::chrono::year{2026} / 11 / 28;
  report.facts.instruments = {{"laser", "L1", "C-9", std::chrono::year{2026} / 11 / 28}};
  EXPECT_THAT(customer_page(report), Not(HasSubstr("class=\"warning\"")));
}

TEST(CustomerPage, RunsNothingAndLoadsNothing) {
  const std::string page = customer_page(small_customer_report(ReportLanguage::english));
  EXPECT_THAT(page, HasSubstr("content=\"default-src 'none'; style-src 'unsafe-inline'\""));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("http:")));
  EXPECT_THAT(page, Not(HasSubstr("https:")));
}

TEST(CustomerPage, AReportWithoutFiguresHasNoTableOfThem) {
  CustomerReport report = small_customer_report(ReportLanguage::english);
  report.figures.clear();
  EXPECT_THAT(customer_page(report), Not(HasSubstr("class=\"figures")));
}

TEST(StyleString, HoldsAnyText) {
  EXPECT_EQ(style_string("Report 7"), "\"Report 7\"");
  EXPECT_EQ(style_string("\"</style>\\"), "\"\\22 \\3c \\2f style\\3e \\5c \"");
  EXPECT_EQ(style_string("度"), "\"\\5ea6 \"");
  EXPECT_EQ(style_string("a\xFF"), "\"a\\fffd \"") << "no UTF-8";
}

}  // namespace
}  // namespace abbe
