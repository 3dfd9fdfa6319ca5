// What was found about campaigns, for a terminal.
#include <fmt/format.h>

#include <algorithm>

#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/compared_report.h"

namespace abbe {
namespace {

/// Columns on the screen: letters, not bytes.
std::size_t screen_width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

bool is_aligned_right(const std::string& header) {
  return header != "error" && header != "what it is" && header != "unit" && header != "verdict" && header != "why";
}

std::string table_lines(const EvaluationTable& table) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < table.headers.size(); ++c) {
    std::size_t width = screen_width(table.headers[c]);
    for (const std::vector<std::string>& row : table.rows) width = std::max(width, screen_width(row[c]));
    widths.push_back(width);
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text = " ";
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string space(widths[c] - screen_width(cells[c]), ' ');
      text += is_aligned_right(table.headers[c]) ? " " + space + cells[c] : " " + cells[c] + space;
      text += " ";
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = table.caption + "\n" + line(table.headers);
  for (const std::vector<std::string>& row : table.rows) text += line(row);
  return text + "\n";
}

}  // namespace

std::string comparison_text(const ComparedCampaigns& result) {
  std::string tables;
  for (const EvaluationTable& table : result.report.tables) {
    const bool is_rest = !table.headers.empty() && table.headers.back() == "why";
    if (table.with_figures || is_rest) tables += table_lines(table);
  }
  // Facts, tables, figures.
  const std::string text = evaluation_text(result.report);
  const std::size_t figures = text.find("\n\n") + 2;
  return text.substr(0, figures) + tables + text.substr(figures);
}

}  // namespace abbe
