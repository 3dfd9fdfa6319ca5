#include "evaluate/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/number_text.h"
#include "abbe/formats/results_folder.h"
#include "abbe/report/evaluation_data.h"
#include "abbe/report/report.h"
#include "exit_code.h"
#include "options.h"

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

/// Columns on the screen: letters, not bytes.
std::size_t letters(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(width - std::min(width, letters(text)), ' ');
}

void print_report(const EvaluationReport& report) {
  fmt::print("{}\n{}\n", report.title, report.standard);
  for (const auto& [name, text] : report.facts) fmt::print("  {}: {}\n", name, text);
  fmt::print("\n");
  std::size_t symbol_width = 0, name_width = 0;
  for (const EvaluationFigure& figure : report.figures) {
    symbol_width = std::max(symbol_width, letters(figure.symbol));
    name_width = std::max(name_width, letters(figure.name));
  }
  for (const EvaluationFigure& figure : report.figures) {
    fmt::print("  {}  {}", padded(figure.symbol, symbol_width), padded(figure.name, name_width));
    if (figure.value) {
      fmt::print("  {:>9}", figure_text(figure, *figure.value));
      if (figure.uncertainty) fmt::print(" \xC2\xB1 {}", figure_text(figure, *figure.uncertainty));
      fmt::print(" {}", unit_symbol(figure.unit));
    } else {
      fmt::print("          -  {}", figure.missing);
    }
    if (figure.tolerance) {
      const std::string limit = fmt::format("{} {}", figure_text(figure, *figure.tolerance), unit_symbol(figure.unit));
      const char* const words = !figure.value                ? "cannot be judged, tolerance"
                                : figure.exceeds_tolerance() ? "EXCEEDS the tolerance"
                                                             : "within the tolerance";
      fmt::print("   {} {}", words, limit);
      if (figure.is_undecided()) fmt::print(", not proven: closer to it than the uncertainty");
    }
    fmt::print("\n");
  }
  if (std::any_of(report.figures.begin(), report.figures.end(),
                  [](const EvaluationFigure& figure) { return figure.uncertainty.has_value(); })) {
    fmt::print("\n  \xC2\xB1: expanded measurement uncertainty, k = 2\n");
  }
  if (!report.notes.empty()) fmt::print("\n");
  for (const std::string& note : report.notes) fmt::print("note: {}\n", note);
}

void write_report(const EvaluationReport& report, const nlohmann::ordered_json& json,
                  const EvaluationOptions& options) {
  ResultsFolder folder(options.output);
  folder.write("evaluation.json", json_text(json));
  for (const EvaluationPlot& plot : report.plots) folder.write(plot.name + ".svg", plot.svg);
  folder.write("report.html", report.page.is_object() ? report_page(evaluation_data(report)) : evaluation_page(report));
  for (const auto& [name, contents] : options.files) folder.write(name, contents);
  folder.commit();
}

}  // namespace

Subcommand* add_evaluation(Subcommand& evaluate, const std::string& kind, const std::string& description,
                           const std::string& columns, const std::string& example, EvaluationOptions& options) {
  Subcommand* command = evaluate.add_subcommand(kind, description);
  command->footer("Columns of the file:\n" + columns + "\n\nExample:\n" + example);
  command->add_option("file", options.file, "Readings (*.csv)")->required();
  command->add_output_folder("-o,--output", options.output,
                             "Results folder to write: evaluation.json, plot.svg, report.html; default: print only");
  command
      ->add_option("--tolerance", options.tolerances,
                   "Largest permitted value of a figure, such as A_um=10; repeatable. Exit code 1 if exceeded")
      ->allow_extra_args(false);
  command->add_flag("--json", options.json, "Print JSON for programs");
  return command;
}

void apply_tolerances(const std::vector<std::string>& tolerances, EvaluationReport& report) {
  for (const std::string& text : tolerances) {
    const InputError::Place place{.field = "--tolerance " + text};
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
}

int finish_evaluation(EvaluationReport& report, const EvaluationOptions& options) {
  apply_tolerances(options.tolerances, report);
  const nlohmann::ordered_json json = evaluation_json(report);
  if (!options.output.empty()) write_report(report, json, options);
  if (options.json) {
    fmt::print("{}", json_text(json));
  } else {
    print_report(report);
    if (!options.output.empty()) fmt::print("\nresults in {}\n", options.output);
  }
  return report.exceeds_tolerance() ? kNegative : kDone;
}

}  // namespace abbe
