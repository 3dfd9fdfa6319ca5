#include "reproduce_output.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "reproduce_text.h"

namespace abbe {
namespace {

Reproduction sample_reproduction() {
  Reproduction made;
  made.paper = "sample";
  made.citation = "Author (2020), Journal 1, 2";
  made.title = "A study";
  made.agrees = true;
  made.published = {{"Table 1, average final error", "um", 112.57, 100.5, ""},
                    {"Table 1, maximum final error", "um", 186.06, {}, "the paper gives no readings"}};
  made.tables = {{"table-1",
                  "Table 1",
                  {{"case"}, {"average before", "um"}, {"left", "%", 1}, {"angle", "um/mrad", 3}, {"why"}},
                  {{"one, of two", 12.345678, 20.45, 1e-9,
                    "words that are longer than what is left of a line, so that "
                    "they need two of them at the end of the row"},
                   {"two", {}, 3, 1.0, ""}},
                  {"A note."}}};
  made.details = {{"rank", 72}};
  return made;
}

TEST(ReproduceOutput, UnitsStandInTheHeaderOfATable) {
  EXPECT_EQ(column_key({"average before", "um"}), "average_before_um");
  EXPECT_EQ(column_key({"left", "%"}), "left_percent");
  EXPECT_EQ(column_key({"angle", "um/mrad"}), "angle_um_per_mrad");
  std::istringstream csv(reproduction_csv(sample_reproduction().tables[0]));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "case,average_before_um,left_percent,angle_um_per_mrad,why");
  std::getline(csv, line);
  EXPECT_TRUE(line.starts_with("\"one, of two\",12.345678,20.45,1e-9,\"words")) << line;
  std::getline(csv, line);
  EXPECT_EQ(line, "two,,3,1,");
}

TEST(ReproduceOutput, PublishedNumbersHaveTheirDifferenceOrTheReasonWhyThereIsNone) {
  const nlohmann::ordered_json json = reproduction_json(sample_reproduction());
  EXPECT_NEAR(json["published"][0]["difference"].get<double>(), -12.07, 1e-9);
  EXPECT_TRUE(json["published"][1]["here"].is_null());
  EXPECT_EQ(json["published"][1]["note"], "the paper gives no readings");
  EXPECT_EQ(json["details"]["rank"], 72);
  EXPECT_EQ(json["tables"]["table-1"]["rows"][0]["left_percent"], 20.45);
}

TEST(ReproduceOutput, WhatOnlyRoundingLeavesIsNoDifference) {
  Reproduction made;
  made.published = {{"sum", "mm", 0.3, 0.1 + 0.2}, {"large", "um", 1e6, 1e6 + 1e-7}, {"zero", "um", 0.0, -2e-12}};
  ASSERT_NE(0.1 + 0.2, 0.3);
  const nlohmann::ordered_json rows = reproduction_json(made)["published"];
  EXPECT_EQ(rows[0]["difference"].get<double>(), 0);
  EXPECT_EQ(rows[1]["difference"].get<double>(), 0);
  EXPECT_EQ(rows[2]["difference"].get<double>(), -2e-12);
}

TEST(ReproduceOutput, ANumberThatIsNotFiniteIsAMissingOneEverywhere) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  Reproduction made;
  made.tables = {{"gaps",
                  "Gaps",
                  {{"case"}, {"found", "um"}, {"words"}},
                  {{"a", nan, ""}, {"b", {}, nan}, {"c", -infinity, "d"}}}};
  for (const auto& row : made.tables[0].rows) EXPECT_FALSE(row[1].has_value());
  const nlohmann::ordered_json json = reproduction_json(made);
  for (const auto& row : json["tables"]["gaps"]["rows"]) EXPECT_TRUE(row["found_um"].is_null());
  EXPECT_EQ(reproduction_csv(made.tables[0]), "case,found_um,words\na,,\nb,,\nc,,d\n");
  EXPECT_NE(reproduction_page(made).find(R"("rows":[["a",null,""],["b",null,null],["c",null,"d"]])"),
            std::string::npos);
  EXPECT_EQ(table_text(made.tables[0]), "Gaps\n  case  words\n  a\n  b\n  c     d\n");
  made.tables[0].rows[0][1] = 2.5;
  EXPECT_EQ(table_text(made.tables[0]),
            "Gaps\n  case  found  words\n           um\n  a      2.50\n  b         -\n  c         -  d\n");
}

TEST(ReproduceOutput, WhatAPaperDoesNotHaveIsEmptyOrNullInJson) {
  const nlohmann::ordered_json all = reproduction_json(sample_reproduction()), none = reproduction_json({});
  std::vector<std::string> keys, empty_keys;
  for (const auto& [key, value] : all.items()) keys.push_back(key);
  for (const auto& [key, value] : none.items()) empty_keys.push_back(key);
  EXPECT_EQ(keys, empty_keys);
  EXPECT_TRUE(none["agrees_with_reference"].is_null());
  EXPECT_TRUE(none["details"].is_null());
  EXPECT_EQ(none["facts"], nlohmann::ordered_json::object());
  EXPECT_EQ(none["tables"], nlohmann::ordered_json::object());
}

TEST(ReproduceOutput, TextIsAlignedAndWrapped) {
  std::istringstream text(reproduction_text(sample_reproduction()));
  std::size_t lines = 0;
  for (std::string line; std::getline(text, line); ++lines) {
    EXPECT_LE(line.size(), 118U) << line;
    EXPECT_TRUE(line.empty() || line.back() != ' ') << line;
  }
  EXPECT_GT(lines, 12U);
  EXPECT_EQ(cell_text(1e-9, {"angle", "um", 3}), "1e-09");
  EXPECT_EQ(cell_text(0.0, {"angle", "um", 3}), "0.000");
}

TEST(ReproduceOutput, WhatFailedOrDoesNotAgreeIsNoSuccess) {
  Reproduction made = sample_reproduction();
  EXPECT_TRUE(made.successful());
  made.failures = {"the edge of section 3"};
  EXPECT_FALSE(made.successful());
  EXPECT_NE(reproduction_text(made).find("Not found"), std::string::npos);
  made.failures.clear();
  made.agrees = false;
  EXPECT_FALSE(made.successful());
}

TEST(ReproduceOutput, ThePageHoldsFiguresAndTables) {
  Reproduction made = sample_reproduction();
  made.figures = {{"figure-6", "Histogram", {"<svg id=\"here\"></svg>", ""}}};
  const std::string page = reproduction_page(made);
  for (const char* words : {"average before / ", "the paper gives no readings", "A note.", "Histogram"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

TEST(ReproduceOutput, ThePageWritesUnitsAsPeopleDoAndLeavesMissingNumbersEmpty) {
  const std::string page = reproduction_page(sample_reproduction());
  EXPECT_NE(page.find("\"Table 1, maximum final error\",\"\xC2\xB5m\",\"186.06\",null,null,"), std::string::npos);
}

TEST(ReproduceOutput, ThePageNamesTheFileOfALongTable) {
  Reproduction made = sample_reproduction();
  made.tables = {{"places", "Many places", {{"place", "", 3}}, {}, {}}};
  for (int i = 0; i < 200; ++i) made.tables[0].rows.push_back({i + 0.125});
  EXPECT_EQ(reproduction_page(made).find("tables/places.csv"), std::string::npos);
  EXPECT_NE(reproduction_page(made).find("199.125"), std::string::npos);
  made.tables[0].rows.push_back({200.125});
  EXPECT_NE(reproduction_page(made).find(R"("rows":[["201","tables/places.csv"]])"), std::string::npos);
  EXPECT_EQ(reproduction_page(made).find("199.125"), std::string::npos);
}

}  // namespace
}  // namespace abbe
