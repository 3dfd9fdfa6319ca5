#include "abbe/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace abbe {
namespace {

using nlohmann::json;

json smallest() { return {{"format", "abbe-report/1"}, {"title", "A machine"}}; }

/// The text between the tags of the data element, as a browser reads it: up to the first "</script".
std::string data_element(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"abbe-data\">";
  const std::size_t from = page.find(open) + open.size();
  return page.substr(from, page.find("</script", from) - from);
}

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(Report, PageHoldsTheDataInPlaceOfThePlaceholder) {
  const std::string page = report_page(smallest());
  EXPECT_EQ(page.find("@@ABBE_DATA@@"), std::string::npos);
  EXPECT_EQ(json::parse(data_element(page)), smallest());
}

TEST(Report, TextInTheDataCannotEndTheElementThatHoldsIt) {
  json data = smallest();
  data["machine"]["name"] = "</script><script>alert(1)</script><!-- &amp; \" \\ \xc3\xa4";
  data["assumptions"] = {"</SCRIPT >", "<!--<script>"};
  const std::string page = report_page(data);
  EXPECT_EQ(json::parse(data_element(page)), data);
  EXPECT_EQ(data_element(page).find('<'), std::string::npos);
  EXPECT_EQ(occurrences(page, "<script"), occurrences(report_page(smallest()), "<script"));
}

TEST(Report, PlaceholderInsideTheDataStaysText) {
  json data = smallest();
  data["subtitle"] = "@@ABBE_DATA@@";
  EXPECT_EQ(json::parse(data_element(report_page(data))), data);
}

TEST(Report, PageIsOneFileWithoutAddressesToLoad) {
  const std::string page = report_page(smallest());
  EXPECT_THAT(page, testing::StartsWith("<!doctype html>"));
  EXPECT_EQ(page.find("<link rel=\"stylesheet\""), std::string::npos);
  EXPECT_EQ(page.find("<script src"), std::string::npos);
  EXPECT_EQ(page.find("url(http"), std::string::npos);
}

TEST(Report, PageForbidsEverythingButItsOwnScript) {
  const std::string page = report_page(smallest());
  const std::size_t policy = page.find("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; ");
  ASSERT_NE(policy, std::string::npos);
  EXPECT_LT(policy, page.find("<style")) << "it binds only what comes behind it";
  const std::string words = page.substr(policy, page.find('>', policy) - policy);
  EXPECT_THAT(words, testing::HasSubstr("script-src 'sha256-"));
  EXPECT_THAT(words, testing::HasSubstr("img-src data: blob:;"));
  EXPECT_EQ(words.find("http:"), std::string::npos);
}

TEST(Report, EmptyPageLeavesRoomForDataUnderTheSizeLimit) {
  EXPECT_LT(report_page(smallest()).size(), kReportSizeLimit / 3);
}

TEST(Report, RefusesDataOfAnotherFormat) {
  EXPECT_THROW(report_page(json::array()), std::invalid_argument);
  EXPECT_THROW(report_page(json{{"title", "no format"}}), std::invalid_argument);
  EXPECT_THROW(report_page(json{{"format", "abbe-report/2"}, {"title", "x"}}), std::invalid_argument);
  EXPECT_THROW(report_page(json{{"format", "abbe-report/1"}}), std::invalid_argument);
}

TEST(Report, RefusesNumbersThatAreNotFiniteAndNamesThem) {
  json data = smallest();
  data["map"]["before_um"]["x"] = {1.0, std::numeric_limits<double>::quiet_NaN()};
  try {
    report_page(data);
    FAIL() << "NaN accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("map.before_um.x[1]"));
  }
}

TEST(Report, InvalidUtf8IsReplacedInsteadOfLosingTheReport) {
  json data = smallest();
  data["subtitle"] = std::string("caf\xe9");
  EXPECT_EQ(json::parse(data_element(report_page(data)))["subtitle"], "caf\xef\xbf\xbd");
}

}  // namespace
}  // namespace abbe
