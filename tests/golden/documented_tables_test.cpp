// The figures of docs/controller-tables.md, "What each format reaches", made again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/controls/kinematic_values.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"

namespace abbe {
namespace {

const std::string kSource = ABBE_SOURCE_DIR;

/// A machine of the examples with its errors.
struct ExampleMachine {
  Machine machine;
  ErrorsFile errors;

  ExampleMachine(const std::string& name, const std::string& errors_name)
      : machine(read_machine(kSource + "/examples/machines/" + name + ".machine.toml")),
        errors(read_errors(kSource + "/examples/compensate/" + errors_name + ".errors.toml", machine)) {}
};

std::string figures(const PoseDeviations& deviations) {
  const SampleStatistics& position = deviations.position_statistics;
  return fmt::format("{:.1f} / {:.1f}", 1e3 * position.rms, 1e3 * position.maximum);
}

ControlTables tables_of(const std::string& format, const ExampleMachine& of, const ErrorSet& errors) {
  ControlTableRequest request;
  request.format = format;
  request.machine = of.machine;
  request.errors = errors;
  request.least_reduction = 0;
  return make_control_tables(request);
}

/// Without the location errors that the kinematic values of a format carry.
ErrorSet without_carried(const ExampleMachine& of, const std::string& format) {
  std::vector<std::string> carried = {"EX0C", "EY0C", "EY0A", "EZ0A"};
  if (format == "siemens" || format == "heidenhain") carried.insert(carried.end(), {"EA0C", "EB0C", "EB0A", "EC0A"});
  ErrorSet errors = of.errors.errors;
  std::erase_if(errors.locations, [&](const LocationError& location) {
    const std::string name = location_error_name(of.machine, location.axis, location.component);
    return std::find(carried.begin(), carried.end(), name) != carried.end();
  });
  return errors;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// The rows of the table, cell by cell.
std::vector<std::vector<std::string>> documented_rows(std::string& words_before) {
  std::ifstream page(kSource + "/docs/controller-tables.md");
  std::vector<std::vector<std::string>> rows;
  bool there = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) there = line == "## What each format reaches";
    if (!there) continue;
    if (!line.starts_with("|")) {
      if (rows.empty()) words_before += line + " ";
      continue;
    }
    if (line.starts_with("| control") || line.starts_with("|-")) continue;
    std::vector<std::string> cells;
    for (std::size_t at = 1; at < line.size();) {
      const std::size_t end = line.find('|', at);
      if (end == std::string::npos) break;
      cells.push_back(trimmed(line.substr(at, end - at)));
      at = end + 1;
    }
    rows.push_back(std::move(cells));
  }
  return rows;
}

/// The formats that a row names: of tables, and of values.
void named_formats(const std::string& cell, std::vector<std::string>& tables, std::string& values) {
  for (std::size_t at = cell.find('`'); at != std::string::npos;) {
    const std::size_t end = cell.find('`', at + 1);
    const std::string name = cell.substr(at + 1, end - at - 1);
    const std::string before = "values ";
    if (at >= before.size() && cell.compare(at - before.size(), before.size(), before) == 0) {
      values = name;
    } else {
      tables.push_back(name);
    }
    at = cell.find('`', end + 1);
  }
  if (values.empty() && tables.front() == "linuxcnc") values = "linuxcnc";
}

TEST(DocumentedTables, EachFormatReachesWhatThePageSays) {
  const ExampleMachine mill("three-axis-mill", "mill"), trunnion("trunnion-mill", "trunnion");
  std::string before;
  const std::vector<std::vector<std::string>> rows = documented_rows(before);
  ASSERT_GE(rows.size(), 10U);
  std::size_t cells = 0;
  const auto expect = [&](const std::string& cell, const std::string& made, const std::string& what) {
    EXPECT_EQ(cell, made) << what;
    ++cells;
  };
  for (const std::vector<std::string>& row : rows) {
    ASSERT_EQ(row.size(), 5U) << row.front();
    std::vector<std::string> formats;
    std::string values;
    named_formats(row[0], formats, values);
    for (const std::string& format : formats) {
      const ControlTables three = tables_of(format, mill, mill.errors.errors);
      expect(row[1], figures(three.after), format);
      const ControlTables five = tables_of(format, trunnion, trunnion.errors.errors);
      expect(row[2], figures(five.after), format);
      if (format == "linuxcnc") {
        EXPECT_NE(before.find(fmt::format("{} poses of `three-axis-mill`", three.poses.count())), std::string::npos);
        EXPECT_NE(before.find(figures(three.before) + " without correction"), std::string::npos);
        EXPECT_NE(before.find(fmt::format("{} poses of `trunnion-mill`", five.poses.count())), std::string::npos);
        EXPECT_NE(before.find(figures(five.before) + " without;"), std::string::npos);
      }
    }
    if (values.empty()) {
      EXPECT_EQ(row[3] + row[4], "") << row[0];
      continue;
    }
    KinematicValuesRequest request;
    request.format = values;
    request.machine = trunnion.machine;
    request.errors = trunnion.errors.errors;
    request.least_reduction = 0;
    expect(row[3], figures(make_kinematic_values(request).after), values);
    expect(row[4], figures(tables_of(formats.front(), trunnion, without_carried(trunnion, values)).after),
           formats.front() + " with values");
  }
  EXPECT_GE(cells, 32U);
}

}  // namespace
}  // namespace abbe
