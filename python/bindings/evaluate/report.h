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
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/text/json_text.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "bindings/files.h"
#include "bindings/tables.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// {"A_um": 10} -> "A_um=10", as --tolerance takes it.
std::vector<std::string> tolerance_texts(const std::map<std::string, double>& tolerances);

using Tolerances = std::map<std::string, double>;  ///< largest permitted values by figures with their units
using ResultFiles = std::vector<std::pair<std::string, std::string>>;  ///< names and contents

/// The files that `-o` writes. @param more  beside those of the report
ResultFiles report_files(const EvaluationReport& report, const ResultFiles& more);
/// {name: bytes}
nb::dict files_by_name(const ResultFiles& files);
/// Writes them as a results folder. @throws FileExistsError of Python
void write_results_folder(const std::filesystem::path& folder, const ResultFiles& files, bool overwrite);
const EvaluationFigure& figure_named(const EvaluationReport& report, const std::string& symbol);
/// The page, whatever its sections.
std::string report_page_of(const EvaluationReport& report);
std::string plot_of(const EvaluationReport& report, const std::string& name);

/// Adds the members that show the report. @param more  files beside those of the report
template <class Class, class Result>
void add_report(Class& bound, EvaluationReport Result::*report, ResultFiles (*more)(const Result&)) {
  bound
      .def_prop_ro(
          "kind", [=](const Result& r) { return (r.*report).kind; }, "What was evaluated, such as 'circular'.")
      .def_prop_ro("title", [=](const Result& r) { return (r.*report).title; })
      .def_prop_ro(
          "standard", [=](const Result& r) { return (r.*report).standard; }, "Such as 'ISO 230-2:2014'.")
      .def_prop_ro(
          "facts", [=](const Result& r) { return (r.*report).facts; }, "What was measured: (name, text).")
      .def_prop_ro(
          "notes", [=](const Result& r) { return (r.*report).notes; },
          "What a reader has to know to judge the figures.")
      .def_prop_ro(
          "figures",
          [=](const Result& r) {
            nb::dict figures;
            for (const EvaluationFigure& figure : (r.*report).figures)
              figures[figure.symbol.c_str()] = nb::cast(figure);
            return figures;
          },
          nb::sig("def figures(self) -> dict[str, EvaluationFigure]"), "All figures by their symbols, in order.")
      .def(
          "__getitem__", [=](const Result& r, const std::string& symbol) { return figure_named(r.*report, symbol); },
          nb::arg("symbol"), "The figure of that symbol. Raises KeyError.")
      .def_prop_ro(
          "exceeds_tolerance", [=](const Result& r) { return (r.*report).exceeds_tolerance(); },
          "Whether a figure exceeds its tolerance or could not be evaluated although it has one.")
      .def(
          "text", [=](const Result& r) { return evaluation_text(r.*report); }, "What the command prints.")
      .def(
          "json_text", [=](const Result& r) { return json_text(evaluation_json(r.*report)); },
          "What the command prints with --json.")
      .def(
          "to_dict", [=](const Result& r) { return python_value(evaluation_json(r.*report)); },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"), "The same as a dictionary.")
      .def(
          "page_html", [=](const Result& r) { return report_page_of(r.*report); }, "The page of the command, HTML.")
      .def(
          "write_page",
          [=](const Result& r, const std::filesystem::path& path, bool overwrite) {
            write_text(path, report_page_of(r.*report), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, "Writes the page (*.html), whole or not at all.")
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
          nb::arg("name") = "plot", "A plot of the page as SVG. Raises KeyError.")
      .def(
          "files", [=](const Result& r) { return files_by_name(report_files(r.*report, more(r))); },
          nb::sig("def files(self) -> dict[str, bytes]"), "The files of a results folder, contents by name.")
      .def(
          "write",
          [=](const Result& r, const std::filesystem::path& folder, bool overwrite) {
            write_results_folder(folder, report_files(r.*report, more(r)), overwrite);
          },
          nb::arg("folder"), nb::arg("overwrite") = false,
          "Writes the results folder that the command writes with -o, whole or not at all.");
  add_tables(bound, "figures_frame", "figures_html");
}

}  // namespace abbe::python
