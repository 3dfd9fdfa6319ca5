#include "reproduce_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace abbe {
namespace {

constexpr std::size_t kTextWidth = 118, kNarrowestWords = 30;

/// Characters of UTF-8 text.
std::size_t character_count(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padded_cell(const std::string& text, std::size_t width, bool flush_right) {
  const std::size_t used = character_count(text);
  const std::string space(width > used ? width - used : 0, ' ');
  return flush_right ? space + text : text + space;
}

/// Lines of at most so many characters, broken between words.
std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    if (!lines.back().empty() && character_count(lines.back()) + 1 + character_count(word) > width) {
      lines.emplace_back();
    }
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

/// A paragraph; its first line begins with `first`, the others are indented as far.
std::string paragraph(const std::string& text, const std::string& first) {
  std::string result;
  for (const std::string& line : wrapped(text, kTextWidth - first.size())) {
    result += (result.empty() ? first : std::string(first.size(), ' ')) + line + '\n';
  }
  return result;
}

bool has_numbers(const ReproducedTable& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [&](const std::vector<ReproducedCell>& row) { return row[column].number() != nullptr; });
}

bool is_empty_column(const ReproducedTable& table, std::size_t column) {
  return std::all_of(table.rows.begin(), table.rows.end(), [&](const std::vector<ReproducedCell>& row) {
    const std::string* text = row[column].text();
    return !row[column].has_value() || (text != nullptr && text->empty());
  });
}

std::string bullet_list(const std::string& heading, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string text = "\n" + heading + "\n";
  for (const std::string& line : lines) text += paragraph(line, "  - ");
  return text;
}

}  // namespace

std::string cell_text(const ReproducedCell& cell, const ReproducedColumn& column) {
  if (!cell.has_value()) return "-";
  if (const std::string* text = cell.text()) return *text;
  const double* number = cell.number();
  const int decimals = cell.decimals.value_or(column.decimals);
  if (*number != 0 && std::abs(*number) < 0.5 * std::pow(10.0, -decimals)) return fmt::format("{:.0e}", *number);
  return fmt::format("{:.{}f}", *number, decimals);
}

std::string table_text(const ReproducedTable& table) {
  constexpr std::size_t kGap = 2;
  std::vector<std::size_t> shown, widths;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (!is_empty_column(table, i)) shown.push_back(i);
  }
  const bool units =
      std::any_of(shown.begin(), shown.end(), [&](std::size_t i) { return !table.columns[i].unit.empty(); });
  std::size_t used = 2;
  for (const std::size_t i : shown) {
    const ReproducedColumn& column = table.columns[i];
    std::size_t width = std::max(character_count(column.name), character_count(column.unit));
    for (const auto& row : table.rows) width = std::max(width, character_count(cell_text(row[i], column)));
    widths.push_back(width);
    used += width + kGap;
  }
  // Words at the end of a row take what is left of the line.
  const bool wraps = !shown.empty() && !has_numbers(table, shown.back());
  if (wraps && used > kTextWidth) {
    const std::size_t before = used - widths.back() - kGap;
    widths.back() = before + kNarrowestWords < kTextWidth ? kTextWidth - before : kNarrowestWords;
  }

  std::string text = paragraph(table.title, "");
  const auto add_line = [&](const std::function<std::string(std::size_t column)>& cell) {
    std::vector<std::string> last;
    std::string line = "  ";
    std::size_t indent = 0;
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const std::string content = cell(shown[k]);
      if (k + 1 == shown.size() && wraps) {
        indent = character_count(line);
        last = wrapped(content, widths[k]);
        line += last.front();
      } else {
        line += padded_cell(content, widths[k], has_numbers(table, shown[k])) + std::string(kGap, ' ');
      }
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
    for (std::size_t k = 1; k < last.size(); ++k) text += std::string(indent, ' ') + last[k] + '\n';
  };
  add_line([&](std::size_t i) { return table.columns[i].name; });
  if (units) add_line([&](std::size_t i) { return table.columns[i].unit; });
  for (const auto& row : table.rows) {
    add_line([&](std::size_t i) {
      return row[i].has_value() || has_numbers(table, i) ? cell_text(row[i], table.columns[i]) : std::string();
    });
  }
  for (const std::string& note : table.notes) text += paragraph(note, "  ");
  return text;
}

std::string reproduction_text(const Reproduction& made) {
  std::string text = made.citation + "\n" + paragraph(made.title, "");
  for (const auto& [name, words] : made.facts) text += paragraph(words, name + ": ");
  for (const ReproducedTable& table : made.tables) {
    if (table.in_text) text += "\n" + table_text(table);
  }
  if (!made.published.empty()) text += "\n" + table_text(published_table(made));
  text += bullet_list("Conclusions", made.conclusions);
  text += bullet_list("Wrong in print, and corrected here", made.corrections);
  text += bullet_list("Not found", made.failures);
  if (made.agrees) {
    text += *made.agrees ? "\nagrees with the reference\n" : "\nDOES NOT agree with the reference\n";
  }
  return text;
}

}  // namespace abbe
