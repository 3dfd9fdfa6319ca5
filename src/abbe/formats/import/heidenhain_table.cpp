// Tables of Heidenhain controls that have columns X, Y and Z; docs/import.md has the sources.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_points.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {
namespace {

constexpr std::string_view kEnd = "[END]";

/// "BEGIN PALLET.TAB MM Version: 'Update:110.24'"
struct TableBegin {
  std::string_view name, unit, version;
};

bool is_letter_or_digit(char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/// "PALLET.TAB"; programs, "BEGIN PGM ...", have no suffix.
bool is_table_name(std::string_view name) {
  constexpr std::size_t kLongestSuffix = 4;
  const std::size_t point = name.rfind('.');
  if (point == std::string_view::npos || point == 0 || name.starts_with("PGM ")) return false;
  const std::string_view stem = name.substr(0, point), suffix = name.substr(point + 1);
  return !suffix.empty() && suffix.size() <= kLongestSuffix &&
         std::all_of(suffix.begin(), suffix.end(), is_letter_or_digit) &&
         std::all_of(stem.begin(), stem.end(),
                     [](char c) { return is_letter_or_digit(c) || c == '_' || c == '-' || c == ' '; });
}

std::optional<TableBegin> table_begin(std::string_view line) {
  constexpr std::string_view kBegin = "BEGIN ";
  if (!line.starts_with(kBegin)) return std::nullopt;
  TableBegin begin{csv_trimmed(line.substr(kBegin.size())), "", ""};
  for (const std::string_view key : {" Version:", " VERSION:"}) {
    const std::size_t at = begin.name.find(key);
    if (at == std::string_view::npos) continue;
    begin.version = csv_trimmed(begin.name.substr(at + key.size()));
    begin.name = csv_trimmed(begin.name.substr(0, at));
  }
  for (const std::string_view unit : {"MM", "INCH"}) {
    const std::size_t behind = begin.name.size() - std::min(unit.size(), begin.name.size());
    if (behind == 0 || begin.name[behind - 1] != ' ' || !begin.name.ends_with(unit)) continue;
    begin.unit = unit;
    begin.name = csv_trimmed(begin.name.substr(0, behind));
    break;
  }
  if (!is_table_name(begin.name)) return std::nullopt;
  return begin;
}

/// Where a column is, in characters of each line.
struct TableColumn {
  std::string_view name;
  std::size_t begin = 0, end = 0;
};

bool goes_on_a_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// The byte at which the given character begins; the end of the line if it has fewer.
std::size_t byte_of(std::string_view line, std::size_t character) {
  std::size_t at = 0;
  for (; at < line.size(); ++at) {
    if (!goes_on_a_character(line[at]) && character-- == 0) break;
  }
  return at;
}

/// Each column reaches from its name to the next name, the last one to the end of the line.
std::vector<TableColumn> table_columns(std::string_view line) {
  std::vector<TableColumn> columns;
  std::size_t character = 0;
  char before = ' ';
  for (std::size_t at = 0; at < line.size(); before = line[at++]) {
    if (goes_on_a_character(line[at])) continue;
    if (line[at] != ' ' && before == ' ') {
      if (!columns.empty()) columns.back().end = character;
      columns.push_back({line.substr(at, line.find(' ', at) - at), character, std::string_view::npos});
    }
    ++character;
  }
  return columns;
}

class HeidenhainTableReader {
 public:
  HeidenhainTableReader(std::string_view text, const std::string& file, const ImportHints& hints)
      : lines_(text), file_(file), hints_(hints) {}

  InstrumentTable read() {
    std::optional<TableBegin> begin;
    if (lines_.next()) begin = table_begin(lines_.text());
    if (!begin) refuse("", "no table of a Heidenhain control", "'BEGIN NAME.TAB MM'");
    table_.facts.push_back({"BEGIN", std::string(begin->name)});
    if (!begin->version.empty()) table_.facts.push_back({"Version", std::string(begin->version)});
    take_unit(*begin);
    if (!pass_over_description()) refuse("", "there are no columns", "a line with the names of columns");
    take_columns();
    while (!has_end_ && lines_.next()) take_row();
    if (lines_.next()) table_.not_read.push_back(fmt::format("what is behind [END], from line {}", lines_.number()));
    write();
    return std::move(table_);
  }

 private:
  [[noreturn]] void refuse(const std::string& field, const std::string& problem, const std::string& expected) const {
    throw InputError({.file = file_, .line = lines_.number(), .field = field}, problem, expected);
  }

  void take_unit(const TableBegin& begin) {
    if (!begin.unit.empty()) {
      unit_ = {begin.unit == "MM" ? "mm" : "inch", true, fmt::format("BEGIN says {}", begin.unit), ""};
    } else if (!hints_.length_unit.empty()) {
      unit_ = {hints_.length_unit, true, hints_.length_unit + " as given", ""};
    } else {
      unit_ = {"mm", false, "BEGIN has no unit", "states no unit; millimetres are assumed (--length-unit)"};
    }
  }

  /// Goes to the line with the names of the columns. @returns false if there is none
  bool pass_over_description() {
    if (!lines_.next()) return false;
    const bool is_structure = lines_.text().starts_with("#STRUCTBEGIN");
    if (!is_structure && !lines_.text().starts_with("TableDescription")) return true;
    const std::size_t first = lines_.number();
    do {
      if (!lines_.next()) {
        throw InputError({.file = file_, .line = first}, "the description of the columns has no end",
                         is_structure ? "#STRUCTEND" : "a line that begins with ')'");
      }
    } while (is_structure ? !lines_.text().starts_with("#STRUCTEND") : !lines_.whole().starts_with(')'));
    table_.not_read.push_back(fmt::format("description of the columns, lines {} to {}", first, lines_.number()));
    return lines_.next();
  }

  void take_columns() {
    constexpr std::array<std::string_view, 3> kCoordinates = {"X", "Y", "Z"};
    const std::string expected = "a first column such as NR, and columns X, Y and Z";
    const std::string_view line = lines_.whole();
    refuse_tabs();
    const std::vector<TableColumn> columns = table_columns(line);
    std::vector<std::string> others;
    for (const TableColumn& column : columns) {
      const auto found = std::find(kCoordinates.begin(), kCoordinates.end(), column.name);
      if (found == kCoordinates.end()) {
        if (&column != &columns.front()) others.push_back(shown_text(column.name));
        continue;
      }
      if (&column == &columns.front()) refuse("columns", fmt::format("{} is the first column", column.name), expected);
      TableColumn& place = coordinates_[static_cast<std::size_t>(found - kCoordinates.begin())];
      if (!place.name.empty()) refuse("columns", fmt::format("{} is there twice", column.name), expected);
      place = column;
    }
    for (std::size_t k = 0; k < kCoordinates.size(); ++k) {
      if (coordinates_[k].name.empty()) refuse("columns", fmt::format("there is no {}", kCoordinates[k]), expected);
    }
    label_ = columns.front();
    if (!others.empty()) table_.not_read.push_back("columns " + first_few(others, " "));
  }

  /// Columns are places in a line, which a tab does not keep.
  void refuse_tabs() const {
    if (lines_.whole().find('\t') != std::string_view::npos) refuse("", "there is a tab", "blanks between columns");
  }

  void take_row() {
    if (lines_.text().starts_with(kEnd)) {
      has_end_ = true;
      return;
    }
    refuse_tabs();
    const std::string_view label = cell(label_);
    if (label.empty()) refuse(shown_text(label_.name), "is empty", "the number or the name of the row");
    std::array<std::string, 3> numbers;
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = number_in(coordinates_[k]);
    const auto empties = std::count(numbers.begin(), numbers.end(), "");
    if (empties == static_cast<std::ptrdiff_t>(numbers.size())) {
      ++rows_without_;
      return;
    }
    if (empties != 0) {
      const auto empty = std::find(numbers.begin(), numbers.end(), "");
      refuse(std::string(coordinates_[static_cast<std::size_t>(empty - numbers.begin())].name), "is empty",
             fmt::format("a number in {}, or none in X, Y and Z", unit_.name));
    }
    points_.add(label, {numbers[0], numbers[1], numbers[2]}, lines_.number());
  }

  std::string_view cell(const TableColumn& column) const {
    const std::string_view line = lines_.whole();
    const std::size_t begin = byte_of(line, column.begin);
    return csv_trimmed(line.substr(begin, byte_of(line, column.end) - begin));
  }

  /// Its digits as Abbe reads them; empty if the control has no value there.
  std::string number_in(const TableColumn& column) {
    const std::string_view line = lines_.whole(), written = cell(column);
    const std::string field(column.name), expected = fmt::format("a number in {}", unit_.name);
    const std::size_t begin = byte_of(line, column.begin);
    const bool touches = begin < line.size() && line[begin] != ' ' && line[begin - 1] != ' ';
    if (touches && written.front() != '+' && written.front() != '-') {
      refuse(field, fmt::format("what is left of '{}' runs into the column", shown_text(written)), expected);
    }
    if (written.empty() || written == "-") return "";
    std::string number(written);
    if (const std::size_t mark = number.find_first_of(",."); mark != std::string::npos) {
      if (mark_ == 0) {
        mark_ = number[mark];
        mark_line_ = lines_.number();
      }
      if (number[mark] != mark_) {
        refuse(field,
               fmt::format("'{}' has the decimal mark '{}', and line {} has '{}'", shown_text(written), number[mark],
                           mark_line_, mark_),
               "one decimal mark");
      }
      if (number.find_first_of(",.", mark + 1) != std::string::npos) {
        refuse(field, fmt::format("'{}' has two decimal marks", shown_text(written)), expected);
      }
      number[mark] = '.';
    }
    if (number.size() > 1 && number.front() == '+' && number[1] != '-' && number[1] != '+') number.erase(0, 1);
    instrument_number(number, file_, lines_.number(), field, expected);
    return number;
  }

  void write() {
    if (points_.empty()) {
      throw InputError({.file = file_}, "there are no points", "rows with numbers in X, Y and Z, and [END]");
    }
    points_.write(unit_, {shown_text(label_.name), "X", "Y", "Z"}, table_);
    table_.reasons.push_back(counted(points_.count(), "point", "points"));
    if (rows_without_ != 0) {
      table_.not_read.push_back(counted(rows_without_, "row", "rows") + " without numbers in X, Y and Z");
    }
    if (!has_end_) table_.doubts.emplace_back("the file does not end in [END], so it may be cut short");
  }

  InstrumentLines lines_;
  const std::string& file_;
  const ImportHints& hints_;
  InstrumentTable table_;
  InstrumentPoints points_;
  PointUnit unit_;
  TableColumn label_;
  std::array<TableColumn, 3> coordinates_;
  std::size_t rows_without_ = 0, mark_line_ = 0;
  char mark_ = 0;
  bool has_end_ = false;
};

}  // namespace

std::optional<Recognition> recognise_heidenhain_table(std::string_view text) {
  InstrumentLines lines(text);
  if (!lines.next()) return std::nullopt;
  const std::optional<TableBegin> begin = table_begin(lines.text());
  if (!begin) return std::nullopt;
  return Recognition{fmt::format("BEGIN {} {} in line {}", shown_text(begin->name),
                                 begin->unit.empty() ? "without a unit" : begin->unit, lines.number()),
                     !begin->unit.empty()};
}

InstrumentTable read_heidenhain_table(std::string_view text, const std::string& file, const ImportHints& hints) {
  return HeidenhainTableReader(text, file, hints).read();
}

}  // namespace abbe
