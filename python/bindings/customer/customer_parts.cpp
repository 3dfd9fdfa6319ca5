#include "bindings/customer/customer_parts.h"

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <utility>

namespace abbe::python {
namespace {

/// For programs, as in a digital calibration certificate.
const char* conformity_word(Conformity conformity) {
  switch (conformity) {
    case Conformity::proven:
      return "pass";
    case Conformity::nonconformity_proven:
      return "fail";
    case Conformity::not_proven:
      return "noPass";
    case Conformity::not_judged:
      break;
  }
  return "";
}

/// One figure in all states of the machine.
struct JudgedFigure {
  CustomerFigure figure;
  std::vector<std::string> verdicts;  ///< [states]
};

/// One state of the machine.
struct JudgedState {
  CustomerState state;
  std::vector<std::string> sentences;
};

std::vector<JudgedFigure> judged_figures(const CustomerDocument& document) {
  const CustomerReport& report = document.report;
  std::vector<JudgedFigure> result;
  for (std::size_t f = 0; f < report.figures.size(); ++f) {
    JudgedFigure& judged = result.emplace_back(JudgedFigure{report.figures[f], {}});
    for (std::size_t s = 0; s < report.states.size(); ++s) {
      judged.verdicts.emplace_back(conformity_word(customer_conformity(report, f, s)));
    }
  }
  return result;
}

std::vector<JudgedState> judged_states(const CustomerDocument& document) {
  std::vector<JudgedState> result;
  for (std::size_t s = 0; s < document.report.states.size(); ++s) {
    JudgedState& judged = result.emplace_back(JudgedState{document.report.states[s], {}});
    for (auto& [conformity, sentence] : customer_verdict(document.report, s)) {
      judged.sentences.push_back(std::move(sentence));
    }
  }
  return result;
}

/// [states] of each value of a figure.
std::vector<std::optional<double>> numbers_of_states(const JudgedFigure& judged,
                                                     std::optional<double> CustomerValue::*number) {
  std::vector<std::optional<double>> result;
  for (const CustomerValue& value : judged.figure.states) result.push_back(value.*number);
  return result;
}

}  // namespace

void bind_customer_parts(nb::module_& module) {
  nb::class_<JudgedFigure>(module, "CustomerFigure",
                           "A figure of a customer report, in every state of the machine; numbers are in `unit`.")
      .def_prop_ro("symbol", [](const JudgedFigure& f) { return f.figure.symbol; })
      .def_prop_ro(
          "name", [](const JudgedFigure& f) { return f.figure.name; }, "In the language of the report.")
      .def_prop_ro(
          "unit", [](const JudgedFigure& f) { return f.figure.unit; }, "As shown: 'µm'.")
      .def_prop_ro(
          "values", [](const JudgedFigure& f) { return numbers_of_states(f, &CustomerValue::value); },
          "One for each state; None: not evaluated.")
      .def_prop_ro(
          "expanded_uncertainties",
          [](const JudgedFigure& f) { return numbers_of_states(f, &CustomerValue::expanded_uncertainty); },
          "One for each state, k = 2; None: not known.")
      .def_prop_ro(
          "tolerance", [](const JudgedFigure& f) { return f.figure.tolerance; },
          "Largest permitted magnitude; None: none is stated.")
      .def_ro("verdicts", &JudgedFigure::verdicts,
              "One for each state, by ISO 14253-1: 'pass', 'fail', 'noPass' (neither is proven), '' without a verdict.")
      .def("__repr__", [](const JudgedFigure& f) {
        return fmt::format("<abbe.CustomerFigure {} in {}: {} states>", f.figure.symbol, f.figure.unit,
                           f.verdicts.size());
      });
  nb::class_<JudgedState>(module, "CustomerState",
                          "A state of the machine in a customer report: before or after a correction.")
      .def_prop_ro(
          "name", [](const JudgedState& s) { return s.state.name; }, "In the language of the report.")
      .def_prop_ro(
          "no_verdict", [](const JudgedState& s) { return s.state.no_verdict; },
          "Why no verdict is given on any figure of it; empty: verdicts are given.")
      .def_ro("sentences", &JudgedState::sentences, "The verdict in the language of the report.")
      .def("__repr__", [](const JudgedState& s) { return fmt::format("<abbe.CustomerState '{}'>", s.state.name); });
}

void add_customer_parts(nb::class_<CustomerDocument>& bound) {
  bound.def_prop_ro("figures", &judged_figures, "Each a CustomerFigure, in the order of the report.")
      .def_prop_ro("states", &judged_states, "Each a CustomerState.")
      .def_prop_ro(
          "exceeded", [](const CustomerDocument& d) { return exceeded_tolerances(d.report); },
          "Symbols of the figures that exceed their tolerance in the last state with verdicts, 'A, R'; empty: none.")
      .def_prop_ro(
          "simulated", [](const CustomerDocument& d) { return d.report.is_simulated; },
          "Whether the readings are simulated, on which there is no verdict.")
      .def_prop_ro(
          "refusals", [](const CustomerDocument& d) { return d.report.refusals; },
          "Why the result must not be used as it is; on the first sheet.")
      .def_prop_ro(
          "language", [](const CustomerDocument& d) { return std::string(language_code(d.report.facts.language)); },
          "'en', 'de', 'zh' or 'ja'.");
}

}  // namespace abbe::python
