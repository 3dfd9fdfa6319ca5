#pragma once

// What all results with a report of figures have in common: evaluations, fits, deviations.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/tables.h"

namespace abbe::python {

using Tolerances = std::map<std::string, double>;  ///< largest permitted values by figure and unit: {"A_um": 10}

/// {"A_um": 10} -> "A_um=10", as --tolerance takes it.
std::vector<std::string> tolerance_texts(const Tolerances& tolerances);

/// The files that `-o` writes. @param more  further files
ResultFiles report_files(const EvaluationReport& report, const ResultFiles& more);
const EvaluationFigure& figure_named(const EvaluationReport& report, const std::string& symbol);
std::string plot_of(const EvaluationReport& report, const std::string& name);

/// Adds the members that show the report, all but its results folder.
template <class Class, class Result>
void add_report_of_one_page(Class& bound, EvaluationReport Result::*report) {
  bound
      .def_prop_ro(
          "kind", [=](const Result& r) { return (r.*report).kind; }, "What was evaluated, such as 'circular'.")
      .def_prop_ro("title", [=](const Result& r) { return (r.*report).title; })
      .def_prop_ro(
          "standard", [=](const Result& r) { return (r.*report).standard; }, "Such as 'ISO 230-2:2014'.")
      .def_prop_ro(
          "facts", [=](const Result& r) { return (r.*report).facts; }, "What was measured, as (name, text).")
      .def_prop_ro(
          "notes", [=](const Result& r) { return (r.*report).notes; }, "What a reader must know to judge the figures.")
      .def_prop_ro(
          "figures",
          [=](const Result& r) {
            nb::dict figures;
            for (const EvaluationFigure& figure : (r.*report).figures)
              figures[figure.symbol.c_str()] = nb::cast(figure);
            return figures;
          },
          nb::sig("def figures(self) -> dict[str, EvaluationFigure]"),
          "All figures by symbol, in the order of the report.")
      .def(
          "__getitem__", [=](const Result& r, const std::string& symbol) { return figure_named(r.*report, symbol); },
          nb::arg("symbol"), "The figure of that symbol. Raises KeyError.")
      .def_prop_ro(
          "exceeds_tolerance", [=](const Result& r) { return (r.*report).exceeds_tolerance(); },
          "Whether a figure exceeds its tolerance, or has one and could not be evaluated.")
      .def(
          "text", [=](const Result& r) { return evaluation_text(r.*report); }, "What the command prints.")
      .def_prop_ro(
          "plot_names",
          [=](const Result& r) {
            std::vector<std::string> names;
            for (const EvaluationPlot& plot : (r.*report).plots) names.push_back(plot.name);
            return names;
          },
          "Names that plot_svg() takes.")
      .def(
          "plot_svg", [=](const Result& r, const std::string& name) { return plot_of(r.*report, name); },
          nb::arg("name") = "plot", "A plot of the page as SVG. Raises KeyError.");
  add_json(bound, [=](const Result& r) { return evaluation_json(r.*report); });
  add_page(bound, [=](const Result& r) { return evaluation_page(r.*report); });
  add_tables(bound, "figures_frame", "figures_html");
}

/// Adds the members that show the report. @param more  files beyond those of the report
template <class Class, class Result>
void add_report(Class& bound, EvaluationReport Result::*report, ResultFiles (*more)(const Result&)) {
  add_report_of_one_page(bound, report);
  add_files(
      bound, [=](const Result& r) { return report_files(r.*report, more(r)); },
      "Writes the results folder that the command writes with -o, whole or not at all.");
}

}  // namespace abbe::python
