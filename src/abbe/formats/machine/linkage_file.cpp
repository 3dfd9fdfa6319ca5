#include "abbe/formats/machine/linkage_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/placed_table.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

enum LinkageColumn : std::size_t {
  kMark,
  kCommandX,
  kCommandY,
  kCommandZ,
  kFocusTurn,
  kMarkX,
  kMarkY,
  kHeight,
  kWidth,
  kLinkageColumns
};

const std::vector<CsvColumn>& linkage_columns() {
  using Range = CsvColumn::Range;
  static const std::vector<CsvColumn> all = {
      {"mark", Quantity::dimensionless, true, true},
      {"X", Quantity::length, false, false, Range::any, true},
      {"Y", Quantity::length, false, false, Range::any, true},
      {"Z", Quantity::length, false, false, Range::any, true},
      {"turn", Quantity::angle, false, false, Range::any, true},
      {"mark_x", Quantity::length, false, false, Range::any, true},
      {"mark_y", Quantity::length, false, false, Range::any, true},
      {"height", Quantity::length, false, false, Range::any, true},
      {"width", Quantity::length, false, false, Range::positive, true},
  };
  return all;
}

/// A kind of row: what it is called and which columns belong to it.
struct LinkageMark {
  const char* name;
  const char* words;
  bool repeats;
  std::vector<LinkageColumn> columns;
};

const std::vector<LinkageMark>& linkage_marks() {
  static const std::vector<LinkageMark> all = {
      {"exit", "step 2: the exit of the beam level with the table", false, {kCommandZ}},
      {"width", "step 2: a line while Z goes through the focus", true, {kCommandZ, kWidth}},
      {"l1", "step 3: the line at A = 90 degrees", false, {kHeight}},
      {"l2", "step 3: the line at A = -90 degrees", false, {kHeight}},
      {"l3", "step 4: the line along Y at C1 = 0", false, {kCommandX, kMarkX}},
      {"l4", "step 4: the line along X at C1 = 0", false, {kMarkY}},
      {"l5", "step 4: the line along Y at C1 = 180 degrees", false, {kCommandX, kMarkX}},
      {"l6", "step 4: the line along X at C1 = 180 degrees", false, {kMarkY}},
      {"circle",
       "step 5: a mark while the table turns",
       true,
       {kCommandX, kCommandY, kCommandZ, kFocusTurn, kMarkX, kMarkY}},
      {"point", "step 5: the circle brought to a point", false, {kCommandX, kCommandY, kCommandZ}},
  };
  return all;
}

std::string mark_names() {
  std::string names;
  for (const LinkageMark& mark : linkage_marks()) names += (names.empty() ? "" : ", ") + std::string(mark.name);
  return names;
}

class LinkageReader {
 public:
  explicit LinkageReader(PlacedTable table) : csv_(std::move(table)) {}

  LinkageReadings read() {
    for (std::size_t row = 0; row < csv_.rows; ++row) take(row);
    for (const LinkageMark& mark : linkage_marks()) {
      const std::string name = mark.name;
      if (seen_.count(name) != 0 || name == "circle" || name == "point") continue;
      throw InputError(csv_.place("mark"), fmt::format("there is no row '{}'", name), mark.words);
    }
    if (seen_.count("circle") == 0 && seen_.count("point") == 0) {
      throw InputError(csv_.place("mark"), "there is no row 'circle' or 'point'",
                       "step 5: marks of a circle while the table turns, or the commands that make it a point");
    }
    return std::move(readings_);
  }

 private:
  std::optional<double> value(std::size_t row, LinkageColumn column) const {
    const CsvValues& values = csv_.columns[column];
    if (!values.present || std::isnan(values.numbers[row])) return std::nullopt;
    return values.numbers[row];
  }

  [[noreturn]] void refuse(std::size_t row, const std::string& field, const std::string& problem,
                           const std::string& expected) const {
    throw InputError(csv_.place(row, field), problem, expected);
  }

  std::string header(LinkageColumn column) const {
    const CsvValues& values = csv_.columns[column];
    const CsvColumn& wanted = linkage_columns()[column];
    return values.present ? values.header : accepted_names(wanted.base, wanted.quantity);
  }

  void take(std::size_t row) {
    const CsvValues& marks = csv_.columns[kMark];
    const std::string& name = marks.names[marks.words[row]];
    const auto found = std::find_if(linkage_marks().begin(), linkage_marks().end(),
                                    [&](const LinkageMark& mark) { return name == mark.name; });
    if (found == linkage_marks().end()) {
      refuse(row, marks.header, fmt::format("'{}' is not a mark of the five steps", name.substr(0, 40)),
             "one of " + mark_names());
    }
    const auto [earlier, is_first] = seen_.emplace(name, row);
    if (!is_first && !found->repeats) {
      refuse(row, marks.header, fmt::format("'{}' is already in {}", name, csv_.row_words(earlier->second)),
             "one such row");
    }
    std::array<double, kLinkageColumns> numbers{};
    for (std::size_t column = kCommandX; column < kLinkageColumns; ++column) {
      const auto c = static_cast<LinkageColumn>(column);
      const bool belongs = std::find(found->columns.begin(), found->columns.end(), c) != found->columns.end();
      const std::optional<double> number = value(row, c);
      if (belongs && !number) {
        refuse(row, header(c), csv_.columns[c].present ? "is empty" : "there is no such column",
               fmt::format("a number in the row '{}' ({})", name, found->words));
      }
      if (!belongs && number) {
        refuse(row, header(c), fmt::format("a number that the row '{}' has no use for", name),
               fmt::format("an empty field ({})", found->words));
      }
      numbers[column] = number.value_or(0);
    }
    enter(row, name, numbers);
  }

  void enter(std::size_t row, const std::string& name, const std::array<double, kLinkageColumns>& n) {
    LinkageReadings& r = readings_;
    if (name == "exit") r.exit_z = n[kCommandZ];
    if (name == "width") {
      r.focus_z.push_back(n[kCommandZ]);
      r.focus_width.push_back(n[kWidth]);
    }
    if (name == "l1") r.height_first = n[kHeight];
    if (name == "l2") r.height_second = n[kHeight];
    if (name == "l3") r.x_first = n[kCommandX], r.line3_x = n[kMarkX];
    if (name == "l4") r.line4_y = n[kMarkY];
    if (name == "l5") r.x_second = n[kCommandX], r.line5_x = n[kMarkX];
    if (name == "l6") r.line6_y = n[kMarkY];
    if (name == "circle" || name == "point") enter_circle(row, name, n);
  }

  void enter_circle(std::size_t row, const std::string& name, const std::array<double, kLinkageColumns>& n) {
    LinkageReadings& r = readings_;
    const char* const other = name == "circle" ? "point" : "circle";
    if (seen_.count(other) != 0) {
      refuse(row, csv_.columns[kMark].header, fmt::format("is given together with '{}'", other),
             "either marks of a circle or the commands that make it a point");
    }
    const bool is_first = seen_.at(name) == row;
    const std::array<std::pair<LinkageColumn, double*>, 3> commands = {
        {{kCommandX, &r.circle_x}, {kCommandY, &r.circle_y}, {kCommandZ, &r.circle_z}}};
    for (const auto& [column, command] : commands) {
      if (!is_first && *command != n[column]) {
        refuse(row, header(column), "differs from the first row 'circle'",
               "one position of X, Y and Z for the whole circle: only the table turns");
      }
      *command = n[column];
    }
    if (name == "point") return;
    r.table_angle.push_back(n[kFocusTurn]);
    r.circle_marks.emplace_back(n[kMarkX], n[kMarkY]);
  }

  PlacedTable csv_;
  std::map<std::string, std::size_t> seen_;  ///< first row of each mark
  LinkageReadings readings_;
};

}  // namespace

LinkageReadings parse_linkage(std::string_view text, const std::string& file, const ColumnMapping& mapping) {
  return LinkageReader({text, file, linkage_columns(), mapping}).read();
}

LinkageReadings parse_linkage(const NamedColumns& columns) {
  return LinkageReader({columns, linkage_columns()}).read();
}

LinkageReadings read_linkage(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_readable_table(path, linkage_columns(), mapping,
                             [&](std::string_view text) { return parse_linkage(text, path.string(), mapping); });
}

std::string linkage_text(const LinkageReadings& r) {
  std::string text = "mark,X_mm,Y_mm,Z_mm,turn_deg,mark_x_mm,mark_y_mm,height_mm,width_um\n";
  const auto row = [&](const char* mark, const std::vector<std::pair<LinkageColumn, double>>& numbers) {
    text += mark;
    for (std::size_t column = kCommandX; column < kLinkageColumns; ++column) {
      text += ",";
      for (const auto& [at, value] : numbers) {
        if (at == column)
          text +=
              column == kFocusTurn ? shortest_text(value / kDegree) : shortest_text(value, column == kWidth ? 3 : 0);
      }
    }
    text += "\n";
  };
  row("exit", {{kCommandZ, r.exit_z}});
  for (std::size_t i = 0; i < r.focus_z.size(); ++i)
    row("width", {{kCommandZ, r.focus_z[i]}, {kWidth, r.focus_width[i]}});
  row("l1", {{kHeight, r.height_first}});
  row("l2", {{kHeight, r.height_second}});
  row("l3", {{kCommandX, r.x_first}, {kMarkX, r.line3_x}});
  row("l4", {{kMarkY, r.line4_y}});
  row("l5", {{kCommandX, r.x_second}, {kMarkX, r.line5_x}});
  row("l6", {{kMarkY, r.line6_y}});
  const std::pair<LinkageColumn, double> x{kCommandX, r.circle_x}, y{kCommandY, r.circle_y}, z{kCommandZ, r.circle_z};
  if (r.table_angle.empty()) row("point", {x, y, z});
  for (std::size_t i = 0; i < r.table_angle.size(); ++i) {
    row("circle",
        {x, y, z, {kFocusTurn, r.table_angle[i]}, {kMarkX, r.circle_marks[i].x()}, {kMarkY, r.circle_marks[i].y()}});
  }
  return text;
}

}  // namespace abbe
