#pragma once

// Positioning of an axis after ISO 230-2, as text and as a page:
//
//   #include <abbe/report/evaluations/evaluation_report.h>
//   #include <abbe/report/evaluations/positioning_report.h>
//   #include <abbe/report/report.h>
//   #include <abbe/report/words/evaluation_text.h>
//
//   #include <cstdio>
//
//   int main() {
//     std::vector<abbe::PositioningReading> readings;  // mm: lost motion of 3 um, a scale error of 10 um/m, two runs
//     for (const double target : {0.0, 100.0, 200.0, 300.0, 400.0})
//       for (const double noise : {-0.5e-3, 0.5e-3}) {
//         readings.push_back({target, 1e-5 * target + 1.5e-3 + noise, abbe::ApproachDirection::positive});
//         readings.push_back({target, 1e-5 * target - 1.5e-3 + noise, abbe::ApproachDirection::negative});
//       }
//     const abbe::PositioningEvaluation evaluation = abbe::evaluate_positioning(readings);
//     abbe::EvaluationReport report = abbe::positioning_report(evaluation, false, "X axis", nullptr);
//     abbe::apply_tolerances({"A_um=10", "B_um=2.5"}, report);
//     for (const abbe::EvaluationFigure& figure : report.figures) {
//       if (!figure.value || figure.symbol.size() > 1) continue;
//       std::printf("%s %s: %s %s%s\n", figure.symbol.c_str(), figure.name.c_str(),
//                   abbe::figure_text(figure, *figure.value).c_str(), figure.unit.c_str(),
//                   figure.exceeds_tolerance() ? ", out of tolerance" : "");
//     }
//     return abbe::evaluation_page(report).size() < abbe::kReportSizeLimit ? 0 : 1;
//   }
//
// It prints:
//
//   A bidirectional accuracy: 9.83 um
//   E bidirectional systematic deviation: 7.00 um
//   M range of the mean bidirectional deviation: 4.00 um
//   R bidirectional repeatability: 5.83 um
//   B reversal, largest: 3.00 um, out of tolerance
//
// report holds results as people and programs read them; it computes nothing:
//   report.h                            the page of a study, from its data
//   evaluations/                        evaluations by a standard: positioning_report.h, circular_report.h and others
//   words/evaluation_text.h             texts: a file for each kind of result
//   pages/path_page.h                   pages of tool paths, contours, scans
//   drawings/svg_plot.h                 plots and maps as SVG, the same bytes on every machine

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/text/unit.h"
#include "abbe/report/drawings/svg_drawing.h"
#include "abbe/verify/evaluations/conformity.h"

namespace abbe {

/// One figure of an evaluation: a value with its uncertainty and tolerance, or the reason why there is none.
struct EvaluationFigure {
  std::string symbol;  ///< "A", "A+", "B_mean"; also what --tolerance calls it
  std::string name;    ///< "bidirectional accuracy of positioning"
  Quantity quantity = Quantity::length;
  std::string unit = "um";            ///< in which it is shown; a unit of the quantity
  int decimals = 2;                   ///< of the text, in that unit
  std::optional<double> value;        ///< mm, rad, ...
  std::string missing;                ///< without a value: why, in words
  std::optional<double> uncertainty;  ///< expanded, k = 2; like the value
  std::optional<double> tolerance;    ///< largest permitted magnitude; like the value
  std::vector<std::string> about{};   ///< axes or lines that the name speaks of, for names in other languages

  /// The magnitude is larger than the tolerance; a figure that is not known does not satisfy any.
  bool exceeds_tolerance() const { return tolerance && (!value || std::abs(*value) > *tolerance); }
  /// What the value proves by ISO 14253-1; not judged without a tolerance, a value or an uncertainty.
  Conformity conformity() const;
  /// Too close to its tolerance for its uncertainty: neither conformity nor nonconformity is proven.
  bool is_undecided() const;
  /// "within" or "exceeded", with ", not proven" if undecided; "cannot be judged" without a value; empty without a
  /// tolerance.
  std::string verdict() const;
};

/// A value in the unit in which the figure is shown, rounded to 1e-9 so that the conversion adds no spurious digits.
double figure_number(const EvaluationFigure& figure, double value);
/// Text of a value in the unit in which the figure is shown, with its decimals: "12.34".
std::string figure_text(const EvaluationFigure& figure, double value);
/// The unit as written for people: "µm", "arcsec".
std::string unit_symbol(const std::string& unit);

/// The course of one value over time, which a page draws in a cell of a table.
struct Sparkline {
  std::vector<double> days;                      ///< ascending
  std::vector<double> value, expanded;           ///< [days] and its expanded uncertainty; in the unit of the row
  std::vector<std::optional<double>> low, high;  ///< [days] control limits; none where nothing predicts the value
};

/// Rows of texts under headers.
struct EvaluationTable {
  std::string caption;
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> rows;
  bool with_figures = false;            ///< a page shows it with the figures, not among the details
  bool in_text = false;                 ///< evaluation_text() shows it before the figures
  std::vector<Sparkline> sparklines{};  ///< [rows] or none; a page shows them in the second column
  std::string note{};                   ///< a page shows it below the table
};

struct EvaluationPlot {
  std::string name;     ///< of its file, without ".svg": "plot"
  std::string caption;  ///< may be empty
  SvgPicture picture;
  bool in_page = false;  ///< the interactive page draws it itself, from `page`
  bool beside = false;   ///< one of many: the page shows the narrow layout, two in a row
};

/// Everything that an evaluation reports, for any standard.
struct EvaluationReport {
  std::string kind;                                        ///< "positioning": the subcommand
  std::string title;                                       ///< "Positioning of x.csv"
  std::string standard;                                    ///< "ISO 230-2:2014"
  std::vector<std::pair<std::string, std::string>> facts;  ///< what was measured: name, text
  std::vector<EvaluationFigure> figures;
  std::vector<EvaluationTable> tables;
  std::vector<EvaluationPlot> plots;
  std::vector<std::string> notes;  ///< what a reader must know to judge the figures
  nlohmann::ordered_json details;  ///< for programs, beside the figures; units in the keys; an object or null
  nlohmann::json page;             ///< more sections of the page (docs/report-data.md), or null

  bool exceeds_tolerance() const;
};

/// Contents of evaluation.json: kind, standard, facts, figures by symbol with units in the keys, notes, details.
nlohmann::ordered_json evaluation_json(const EvaluationReport& report);

/// The page of all reports with figures, plots, tables and notes; one file, no address to load. Text in the report is
/// shown as text, whatever it contains.
std::string evaluation_page(const EvaluationReport& report);

}  // namespace abbe
