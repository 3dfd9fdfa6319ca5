#include "bindings/evaluate/report.h"

#include <fmt/format.h>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/report/pages/evaluation_files.h"

namespace abbe::python {
namespace {

std::optional<double> in_unit(const EvaluationFigure& figure, const std::optional<double>& value) {
  if (!value) return std::nullopt;
  return figure_number(figure, *value);
}

std::string figure_words(const EvaluationFigure& figure) {
  return figure.value ? figure_text(figure, *figure.value) + " " + figure.unit : figure.missing;
}

}  // namespace

std::vector<std::string> tolerance_texts(const Tolerances& tolerances) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : tolerances) {
    if (!std::isfinite(value)) {
      throw InputError({.field = "tolerances"}, fmt::format("{} is {}", name, value), "a number above zero");
    }
    texts.push_back(name + "=" + shortest_text(value));
  }
  return texts;
}

ResultFiles report_files(const EvaluationReport& report, const ResultFiles& more) {
  ResultFiles files = evaluation_files(report);
  files.insert(files.end(), more.begin(), more.end());
  return files;
}

nb::dict files_by_name(const ResultFiles& files) {
  nb::dict result;
  for (const auto& [name, contents] : files) result[name.c_str()] = nb::bytes(contents.data(), contents.size());
  return result;
}

void write_results_folder(const std::filesystem::path& folder, const ResultFiles& files, bool overwrite) {
  refuse_existing(folder, overwrite);
  const nb::gil_scoped_release release;
  write_result_files(folder, files);
}

const EvaluationFigure& figure_named(const EvaluationReport& report, const std::string& symbol) {
  for (const EvaluationFigure& figure : report.figures) {
    if (figure.symbol == symbol) return figure;
  }
  throw nb::key_error(
      fmt::format("there is no figure '{}' in an evaluation of kind '{}'", symbol, report.kind).c_str());
}

std::string plot_of(const EvaluationReport& report, const std::string& name) {
  for (const EvaluationPlot& plot : report.plots) {
    if (plot.name == name) return plot.picture.wide;
  }
  throw nb::key_error(fmt::format("there is no plot '{}'", name).c_str());
}

void bind_evaluation_reports(nb::module_& module) {
  nb::class_<EvaluationFigure>(module, "EvaluationFigure",
                               "A figure of a report: a value with its uncertainty and tolerance, or why it has "
                               "none.\n\nNumbers are in `unit`: 'um', 'urad', 'arcsec', ...")
      .def_ro("symbol", &EvaluationFigure::symbol, "Such as 'A' or 'G_cw'; the names of tolerances start with it.")
      .def_ro("name", &EvaluationFigure::name)
      .def_ro("unit", &EvaluationFigure::unit,
              "Unit of value, expanded_uncertainty and tolerance; '' for a pure number.")
      .def_prop_ro(
          "value", [](const EvaluationFigure& f) { return in_unit(f, f.value); },
          "In unit; None if there is none: see missing.")
      .def_ro("missing", &EvaluationFigure::missing, "Why there is no value, in words; empty if there is one.")
      .def_prop_ro(
          "expanded_uncertainty", [](const EvaluationFigure& f) { return in_unit(f, f.uncertainty); },
          "Coverage factor k = 2; None if not stated.")
      .def_prop_ro(
          "tolerance", [](const EvaluationFigure& f) { return in_unit(f, f.tolerance); },
          "Largest permitted magnitude; None if none was given.")
      .def_prop_ro("verdict", &EvaluationFigure::verdict,
                   "'within' or 'exceeded', perhaps with ', not proven'; 'cannot be judged'; '' without a tolerance.")
      .def_prop_ro("exceeds_tolerance", &EvaluationFigure::exceeds_tolerance)
      .def("text", &figure_words, "Value and unit, with the digits of the report.")
      .def("__repr__", [](const EvaluationFigure& f) {
        return fmt::format("<abbe.EvaluationFigure {}: {}>", f.symbol, figure_words(f));
      });
}

}  // namespace abbe::python
