#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace abbe {

/// Expects what `abbe reproduce PAPER -o` writes for every paper: the same files, and the same keys in summary.json.
/// @param printed  what --json prints
inline void expect_common_layout(const std::filesystem::path& results, const nlohmann::json& printed) {
  namespace fs = std::filesystem;
  const auto names_in = [](const fs::path& folder) {
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
  };
  EXPECT_EQ(names_in(results),
            (std::set<std::string>{".abbe-results", "figures", "report.html", "study", "summary.json", "tables"}));
  std::ifstream file(results / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(file);
  EXPECT_EQ(summary, printed);
  std::vector<std::string> keys;
  for (const auto& [key, value] : summary.items()) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"agrees_with_reference", "citation", "conclusions", "details", "facts",
                                            "failures", "format", "paper", "published", "tables", "title",
                                            "wrong_in_print"}));
  EXPECT_EQ(summary["format"], "abbe-reproduction/1");
  EXPECT_TRUE(summary["agrees_with_reference"].is_boolean());
  EXPECT_FALSE(summary["facts"].empty());
  // The published numbers with their unit, and a file for every table.
  EXPECT_FALSE(summary["published"].empty());
  for (const nlohmann::json& row : summary["published"]) EXPECT_NE(row["note"], "") << row;
  for (const char* key : {"where", "unit", "paper", "here", "difference", "note"}) {
    for (const nlohmann::json& row : summary["published"]) EXPECT_TRUE(row.contains(key)) << key;
  }
  std::set<std::string> tables = {"published.csv"};
  for (const auto& [name, table] : summary["tables"].items()) {
    tables.insert(name + ".csv");
    EXPECT_TRUE(table.contains("title") && table["rows"].is_array()) << name;
  }
  EXPECT_EQ(names_in(results / "tables"), tables);
  for (const std::string& name : names_in(results / "figures")) EXPECT_TRUE(name.ends_with(".svg")) << name;
  EXPECT_FALSE(names_in(results / "figures").empty());
  EXPECT_FALSE(names_in(results / "study").empty());
}

}  // namespace abbe
