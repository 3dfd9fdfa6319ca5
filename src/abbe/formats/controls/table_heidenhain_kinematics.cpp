#include "abbe/formats/controls/table_heidenhain_kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "abbe/formats/controls/heidenhain_lines.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

constexpr std::array<std::string_view, 6> kKinematicsColumns = {"NR", "DOC", "KEY", "AXIS", "COORD", "COMPTAB"};
constexpr std::string_view kKinematicsLetters = "XYZABCUVW";
/// More rows than any table of the control can have.
constexpr std::size_t kKinematicsRows = 1000;

bool turns(char letter) { return kinematics_coordinate(letter) >= 3; }

std::string_view key_text(KinematicsRow::Key key) {
  switch (key) {
    case KinematicsRow::Key::trans:
      return "Trans";
    case KinematicsRow::Key::mach_axis:
      return "MachAxis";
    case KinematicsRow::Key::mach_base:
      break;
  }
  return "MachBase";
}

std::string comptab_text(const KinematicsRow& row, const std::vector<TableAxisName>& axes, double sign) {
  if (row.column) return fmt::format("A{}C{}", table_axis(axes, row.column->axis).name, row.column->column + 1);
  return row.constant ? heidenhain_number(sign * *row.constant, turns(row.axis)) : "";
}

/// Fields below the places of the names in the second line.
class KinematicsFields {
 public:
  KinematicsFields(const TableLines& lines, std::string_view heading) {
    if (words_of(heading).size() != kKinematicsColumns.size()) fail(lines);
    std::size_t at = 0;
    for (const std::string_view name : kKinematicsColumns) {
      const std::size_t found = heading.find_first_not_of(' ', at);
      if (found == std::string_view::npos || !heading.substr(found).starts_with(name)) fail(lines);
      begin_.at(begin_count_++) = found;
      at = found + name.size();
    }
  }
  std::string_view field(std::string_view line, std::size_t column) const {
    const std::size_t begin = column == 0 ? 0 : begin_.at(column);
    if (begin >= line.size()) return {};
    const std::size_t end = column + 1 < begin_.size() ? begin_.at(column + 1) : line.size();
    return without_blanks(line.substr(begin, end - begin));
  }

 private:
  [[noreturn]] static void fail(const TableLines& lines) {
    lines.fail("columns", "not understood", "NR DOC KEY AXIS COORD COMPTAB");
  }

  std::array<std::size_t, kKinematicsColumns.size()> begin_{};
  std::size_t begin_count_ = 0;
};

/// "A1C2".
ComptabColumn column_of(const TableLines& lines, std::string_view text, bool rotary,
                        const std::vector<TableAxisName>& axes) {
  const std::size_t c = text.rfind('C');
  if (text.front() != 'A' || c == std::string_view::npos || c + 2 != text.size()) {
    lines.fail("COMPTAB", fmt::format("'{}' is not understood", shown_word(text)), "a number, or a column as A1C2");
  }
  const TableAxisName* const axis = find_table_axis(axes, text.substr(1, c - 1));
  if (axis == nullptr) {
    lines.fail("COMPTAB", fmt::format("unknown axis in '{}'", shown_word(text)), table_axis_words(axes));
  }
  const char digit = text.back();
  const bool fits = rotary ? digit >= '4' && digit <= '6' : digit >= '1' && digit <= '3';
  if (!fits) {
    lines.fail("COMPTAB", fmt::format("column of '{}'", shown_word(text)),
               rotary ? "C4 to C6 (degrees) for a turn" : "C1 to C3 (mm) for a shift");
  }
  return {axis->axis, static_cast<std::size_t>(digit - '1')};
}

KinematicsRow row_of(const TableLines& lines, const KinematicsFields& fields, const std::vector<TableAxisName>& axes,
                     double sign) {
  const std::string_view line = lines.line();
  const std::string_view key = fields.field(line, 2), axis = fields.field(line, 3);
  const std::string_view coord = fields.field(line, 4), comptab = fields.field(line, 5);
  KinematicsRow row;
  row.doc = fields.field(line, 1).substr(0, kKinematicsDoc);
  if (key == "MachBase") {
    row.key = KinematicsRow::Key::mach_base;
    if (!axis.empty() || !coord.empty() || !comptab.empty()) lines.fail("KEY", "MachBase with values", "none");
    return row;
  }
  if (key != "Trans" && key != "MachAxis") {
    lines.fail("KEY", fmt::format("'{}' is not read", shown_word(key)), "Trans, MachAxis or MachBase");
  }
  row.key = key == "Trans" ? KinematicsRow::Key::trans : KinematicsRow::Key::mach_axis;
  if (axis.size() != 1 || kinematics_coordinate(axis.front()) == 6) {
    lines.fail("AXIS", fmt::format("'{}'", shown_word(axis)), "one of X Y Z A B C U V W");
  }
  row.axis = axis.front();
  if (row.key == KinematicsRow::Key::mach_axis) {
    if (!coord.empty() || !comptab.empty()) lines.fail("COORD, COMPTAB", "MachAxis with values", "none");
    return row;
  }
  const bool rotary = turns(row.axis);
  const char* const unit = rotary ? "degrees" : "mm";
  if (!coord.empty()) row.coord = inside_position(lines.value(coord, "COORD", unit), rotary);
  if (comptab.empty()) {
    if (!row.coord) lines.fail("COORD, COMPTAB", "Trans without a value", "a number or a column");
  } else if (comptab.front() == 'A') {
    row.column = column_of(lines, comptab, rotary, axes);
  } else {
    row.constant = sign * inside_position(lines.value(comptab, "COMPTAB", unit), rotary);
  }
  return row;
}

}  // namespace

std::size_t kinematics_coordinate(char letter) {
  const std::size_t at = kKinematicsLetters.find(letter);
  return at == std::string_view::npos ? 6 : at % 6;
}

KinematicsCount kinematics_count(const std::vector<KinematicsRow>& rows) {
  KinematicsCount count;
  for (const KinematicsRow& row : rows) {
    count.axes += row.key == KinematicsRow::Key::mach_axis ? 1U : 0U;
    count.coord += row.coord ? 1U : 0U;
    count.comptab += row.constant || row.column ? 1U : 0U;
  }
  return count;
}

std::string kinematics_room(const KinematicsCount& count) {
  return fmt::format("{} of {} entries in COMPTAB, {} of {} rows with COORD or MachAxis", count.comptab,
                     kKinematicsComptabRows - std::min(count.axes, kKinematicsComptabRows), count.coord + count.axes,
                     kKinematicsCoordRows);
}

bool kinematics_fits(const KinematicsCount& count) {
  return count.comptab + count.axes <= kKinematicsComptabRows && count.coord + count.axes <= kKinematicsCoordRows;
}

std::string heidenhain_kinematics_text(const std::vector<KinematicsRow>& rows, const std::string& file,
                                       const std::vector<TableAxisName>& axes, double sign) {
  constexpr const char* const kRow = "{:<5}{:<16}{:<10}{:<6}{:<20}{}";
  const auto line = [](std::string text) { return text.erase(text.find_last_not_of(' ') + 1) + "\n"; };
  std::string text = fmt::format("BEGIN {} MM\n", file);
  text += line(fmt::format(kRow, "NR", "DOC", "KEY", "AXIS", "COORD", "COMPTAB"));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const KinematicsRow& row = rows[k];
    text += line(fmt::format(kRow, k, row.doc.substr(0, kKinematicsDoc), key_text(row.key), row.axis,
                             row.coord ? heidenhain_number(*row.coord, turns(row.axis)) : "",
                             comptab_text(row, axes, sign)));
  }
  return text + "[END]\n";
}

std::vector<KinematicsRow> parse_heidenhain_kinematics(std::string_view text, const std::string& file,
                                                       const std::vector<TableAxisName>& axes, double sign) {
  HeidenhainLines all(text, file, "BEGIN name MM", "NR DOC KEY AXIS COORD COMPTAB");
  const TableLines& lines = all.lines();
  const KinematicsFields fields(lines, lines.line());
  std::vector<KinematicsRow> rows;
  while (all.next()) {
    all.check_number(fields.field(all.line(), 0), rows.size(), kKinematicsRows);
    rows.push_back(row_of(lines, fields, axes, sign));
    const bool again = rows.back().key == KinematicsRow::Key::mach_axis &&
                       std::any_of(rows.begin(), rows.end() - 1, [&](const KinematicsRow& row) {
                         return row.key == KinematicsRow::Key::mach_axis && row.axis == rows.back().axis;
                       });
    if (again) lines.fail("AXIS", fmt::format("MachAxis {} a second time", rows.back().axis), "every axis once");
  }
  const KinematicsCount count = kinematics_count(rows);
  if (!kinematics_fits(count))
    throw InputError({.file = file}, "more rows than the control has room for", kinematics_room(count));
  all.check_end(rows.size());
  return rows;
}

}  // namespace abbe
