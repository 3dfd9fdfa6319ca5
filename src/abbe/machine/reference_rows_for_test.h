#pragma once

// Tables of reference numbers (tests/golden), as text by column name: these tests do not depend on the CSV reader they
// stand before.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace abbe::test {

using ReferenceRow = std::map<std::string, std::string>;

/// Rows of a CSV file without quotes; empty lines and comments (#) are passed over, line ends may be CRLF.
inline std::vector<ReferenceRow> reference_rows(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> columns;
  std::vector<ReferenceRow> rows;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::vector<std::string> values;
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(cell);
    if (columns.empty()) {
      columns = values;
      continue;
    }
    ReferenceRow row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i]] = values.at(i);
    rows.push_back(row);
  }
  EXPECT_FALSE(rows.empty()) << path;
  return rows;
}

}  // namespace abbe::test
