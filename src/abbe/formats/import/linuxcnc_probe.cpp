// Probe logs of LinuxCNC, (PROBEOPEN FILE): nine coordinates in each line; docs/import.md has the sources.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {
namespace {

constexpr std::array<std::string_view, 9> kLoggedAxes = {"X", "Y", "Z", "A", "B", "C", "U", "V", "W"};

/// "-12.500000": LinuxCNC prints all numbers with %f.
bool is_logged_number(std::string_view word) {
  constexpr std::size_t kDecimals = 6;
  if (word.starts_with('-')) word.remove_prefix(1);
  const std::size_t point = word.find('.');
  if (point == 0 || point == std::string_view::npos || word.size() != point + 1 + kDecimals) return false;
  word = word.substr(0, point);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return std::all_of(word.begin(), word.end(), is_digit);
}

bool is_logged_line(const std::vector<std::string_view>& words) {
  return words.size() == kLoggedAxes.size() && std::all_of(words.begin(), words.end(), is_logged_number);
}

/// What the log has of an axis.
struct LoggedAxis {
  double first = 0, least = 0, most = 0;
};

class ProbeLogReader {
 public:
  ProbeLogReader(std::string_view text, const std::string& file, const ImportHints& hints)
      : lines_(text), file_(file), hints_(hints) {}

  InstrumentTable read() {
    while (lines_.next()) take_line();
    table_.kind = ImportKind::points;
    table_.reasons.push_back(counted(table_.lines.size(), "probed point", "probed points") +
                             ", in the work coordinate system of the program, without the tool offset");
    write_columns();
    look_at_other_axes();
    return std::move(table_);
  }

 private:
  void take_line() {
    const std::vector<std::string_view> words = instrument_words(lines_.text());
    if (words.size() != kLoggedAxes.size()) {
      throw InputError({.file = file_, .line = lines_.number()},
                       "the line has " + counted(words.size(), "field", "fields"), "9 numbers: X Y Z A B C U V W");
    }
    for (std::size_t k = 0; k < words.size(); ++k) {
      const std::string field(kLoggedAxes[k]), expected = "a number with six decimals";
      const double value = instrument_number(words[k], file_, lines_.number(), field, expected);
      if (!is_logged_number(words[k])) {
        throw InputError({.file = file_, .line = lines_.number(), .field = field},
                         fmt::format("'{}' is not as LinuxCNC writes numbers", shown_text(words[k])), expected);
      }
      LoggedAxis& axis = axes_[k];
      if (table_.lines.empty()) axis = {value, value, value};
      axis.least = std::min(axis.least, value);
      axis.most = std::max(axis.most, value);
    }
    table_.rows += fmt::format("{},{},{}\n", words[0], words[1], words[2]);
    table_.lines.push_back(lines_.number());
  }

  void write_columns() {
    const std::string& given = hints_.length_unit;
    for (std::size_t k = 0; k < 3; ++k) {
      InstrumentColumn column{std::string(kLoggedAxes[k]), std::string(1, static_cast<char>('x' + k)),
                              given.empty() ? "mm" : given, !given.empty()};
      column.reason = given.empty() ? "by its place" : fmt::format("by its place; {} as given", given);
      if (given.empty()) {
        column.doubts.push_back(
            fmt::format("a log is in the units of its program and states none; millimetres are assumed (G21; range "
                        "{:.6g} to {:.6g}; --length-unit inch for G20)",
                        axes_[k].least, axes_[k].most));
      }
      table_.columns.push_back(std::move(column));
    }
  }

  /// Points that were probed with these axes elsewhere are in another frame of the workpiece.
  void look_at_other_axes() {
    std::vector<std::string> moved;
    for (std::size_t k = 3; k < kLoggedAxes.size(); ++k) {
      const LoggedAxis& axis = axes_[k];
      const bool stays = axis.least == axis.most;
      table_.not_read.push_back(stays ? fmt::format("{} ({:.9g} in every line)", kLoggedAxes[k], axis.first)
                                      : fmt::format("{} ({:.9g} to {:.9g})", kLoggedAxes[k], axis.least, axis.most));
      if (!stays) moved.emplace_back(kLoggedAxes[k]);
    }
    if (moved.empty()) return;
    table_.doubts.push_back(fmt::format(
        "{} moved between the points, which may then not be in one frame of the workpiece", fmt::join(moved, ", ")));
  }

  InstrumentLines lines_;
  const std::string& file_;
  const ImportHints& hints_;
  InstrumentTable table_;
  std::array<LoggedAxis, kLoggedAxes.size()> axes_{};
};

}  // namespace

std::optional<Recognition> recognise_linuxcnc_probe(std::string_view text) {
  constexpr int kLooked = 20;
  InstrumentLines lines(text);
  int seen = 0;
  for (; seen < kLooked && lines.next(); ++seen) {
    if (is_logged_line(instrument_words(lines.text()))) continue;
    // The last line of a log that was cut short is told where it is read.
    if (seen == 0 || lines.next()) return std::nullopt;
  }
  if (seen == 0) return std::nullopt;
  return Recognition{"nine numbers with six decimals in each line", false};
}

InstrumentTable read_linuxcnc_probe(std::string_view text, const std::string& file, const ImportHints& hints) {
  return ProbeLogReader(text, file, hints).read();
}

}  // namespace abbe
