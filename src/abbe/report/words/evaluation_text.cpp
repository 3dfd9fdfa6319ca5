#include "abbe/report/words/evaluation_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

std::string joined_symbols(const EvaluationReport& report) {
  std::string text;
  for (const EvaluationFigure& figure : report.figures) {
    if (!text.empty()) text += ", ";
    text += figure.symbol + (figure.unit.empty() ? "" : "_" + figure.unit);
  }
  return text;
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(width - std::min(width, characters_in(text)), ' ');
}

constexpr std::string_view kBeginNumbers = "-<0123456789";

/// Whether the cells of a column are numbers, perhaps with a unit or an uncertainty; or there are none.
bool holds_numbers(const EvaluationTable& table, std::size_t column) {
  return std::all_of(table.rows.begin(), table.rows.end(), [&](const std::vector<std::string>& row) {
    const std::string& cell = row[column];
    return cell.empty() || cell == "\xE2\x80\x93" || kBeginNumbers.find(cell.front()) != std::string_view::npos;
  });
}

/// Columns of numbers end in line, others begin in line.
std::string table_text(const EvaluationTable& table) {
  std::vector<std::size_t> widths;
  std::vector<bool> to_the_right;
  for (std::size_t c = 0; c < table.headers.size(); ++c) {
    std::size_t width = characters_in(table.headers[c]);
    for (const std::vector<std::string>& row : table.rows) width = std::max(width, characters_in(row[c]));
    widths.push_back(width);
    to_the_right.push_back(holds_numbers(table, c));
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string space(widths[c] - characters_in(cells[c]), ' ');
      text += "  " + (to_the_right[c] ? space + cells[c] : cells[c] + space);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = table.caption + "\n" + line(table.headers);
  for (const std::vector<std::string>& row : table.rows) text += line(row);
  return text + "\n";
}

}  // namespace

std::string evaluation_text(const EvaluationReport& report) {
  std::string text;
  text += fmt::format("{}\n{}\n", report.title, report.standard);
  for (const auto& [name, fact] : report.facts) text += fmt::format("  {}: {}\n", name, fact);
  text += "\n";
  for (const EvaluationTable& table : report.tables) {
    if (table.in_text) text += table_text(table);
  }
  std::size_t symbol_width = 0, name_width = 0;
  for (const EvaluationFigure& figure : report.figures) {
    symbol_width = std::max(symbol_width, characters_in(figure.symbol));
    name_width = std::max(name_width, characters_in(figure.name));
  }
  for (const EvaluationFigure& figure : report.figures) {
    text += fmt::format("  {}  {}", padded(figure.symbol, symbol_width), padded(figure.name, name_width));
    if (figure.value) {
      text += fmt::format("  {:>9}", figure_text(figure, *figure.value));
      if (figure.uncertainty) text += fmt::format(" \xC2\xB1 {}", figure_text(figure, *figure.uncertainty));
      text += fmt::format(" {}", unit_symbol(figure.unit));
    } else {
      text += fmt::format("          -  {}", figure.missing);
    }
    if (figure.tolerance) {
      const std::string limit = fmt::format("{} {}", figure_text(figure, *figure.tolerance), unit_symbol(figure.unit));
      const char* const words = !figure.value                ? "cannot be judged, tolerance"
                                : figure.exceeds_tolerance() ? "EXCEEDS the tolerance"
                                                             : "within the tolerance";
      text += fmt::format("   {} {}", words, limit);
      if (figure.is_undecided()) text += ", not proven: closer to it than 1.65 u";
    }
    text += "\n";
  }
  if (std::any_of(report.figures.begin(), report.figures.end(),
                  [](const EvaluationFigure& figure) { return figure.uncertainty.has_value(); })) {
    text += "\n  \xC2\xB1: expanded measurement uncertainty, k = 2\n";
  }
  if (!report.notes.empty()) text += "\n";
  for (const std::string& note : report.notes) text += fmt::format("note: {}\n", note);
  return text;
}

namespace {

/// @param place  where the tolerance is stated
void apply_tolerance(const std::string& text, const InputError::Place& place, EvaluationReport& report) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    throw InputError(place, "there is no '='", "FIGURE_unit=value, with one of " + joined_symbols(report));
  }
  const std::string name = text.substr(0, equals);
  EvaluationFigure* found = nullptr;
  const Unit* unit = nullptr;
  for (EvaluationFigure& figure : report.figures) {
    unit = unit_of_name(name, figure.symbol, figure.quantity);
    if (unit == nullptr && name == figure.symbol) {
      throw InputError(place, "the unit is missing", accepted_names(figure.symbol, figure.quantity));
    }
    if (unit == nullptr && name.starts_with(figure.symbol + "_") && without_unit(name) == figure.symbol) {
      throw InputError(place,
                       fmt::format("'{}' is not a unit of {}", name.substr(figure.symbol.size() + 1),
                                   quantity_words(figure.quantity)),
                       accepted_names(figure.symbol, figure.quantity));
    }
    if (unit == nullptr) continue;
    found = &figure;
    break;
  }
  if (found == nullptr) throw InputError(place, "there is no such figure", "one of " + joined_symbols(report));
  double value = 0;
  if (parse_quantity(std::string_view(text).substr(equals + 1), *unit, value) != NumberProblem::none || value <= 0) {
    throw InputError(place, fmt::format("'{}' is not a number above zero", text.substr(equals + 1)),
                     name + "=10, with a decimal point");
  }
  if (found->tolerance) throw InputError(place, "this figure has two tolerances", "one");
  found->tolerance = value;
}

}  // namespace

void apply_tolerances(const std::vector<std::string>& tolerances, EvaluationReport& report) {
  for (const std::string& text : tolerances) apply_tolerance(text, {.field = "--tolerance " + text}, report);
}

void apply_report_tolerances(const std::vector<ReportTolerance>& tolerances, EvaluationReport& report) {
  for (const ReportTolerance& tolerance : tolerances) {
    apply_tolerance(fmt::format("{}={}", tolerance.name, tolerance.value), tolerance.place, report);
  }
}

}  // namespace abbe
