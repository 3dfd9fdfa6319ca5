#pragma once

// A customer report: two to four sheets for the customer of a machine, on whatever evaluation it is about.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/study/report_facts.h"
#include "abbe/verify/evaluations/conformity.h"

namespace abbe {

/// A figure in one state of the machine; in the unit of its figure.
struct CustomerValue {
  std::optional<double> value;                 ///< absent: not evaluated
  std::optional<double> expanded_uncertainty;  ///< k = 2; absent: not known
  bool is_incomplete = false;                  ///< the uncertainty does not cover all that the figure is made of
};

/// A figure in every state, with its tolerance.
struct CustomerFigure {
  std::string symbol;  ///< "A↑", "EXX"
  std::string name;    ///< in the language of the report
  std::string unit;    ///< as shown: "µm"
  int decimals = 2;
  std::vector<CustomerValue> states;  ///< as many as CustomerReport::states
  std::optional<double> tolerance;    ///< largest permitted magnitude
};

/// A state of the machine that figures are given for: before or after a correction.
struct CustomerState {
  std::string name;        ///< in the language of the report
  std::string no_verdict;  ///< why no verdict is given on any figure of it; empty: verdicts are given
};

/// Texts under headers, ready to be shown. The first column names the row.
struct CustomerTable {
  std::string caption;
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the headers
};

struct CustomerDrawing {
  std::string caption;
  std::string svg;  ///< one <svg> element
};

/// All that a customer report shows.
struct CustomerReport {
  ReportFacts facts;
  std::string subject;   ///< what was tested, in the language of the report
  std::string standard;  ///< of the evaluation, shown where the facts name none
  std::vector<CustomerState> states;
  std::vector<CustomerFigure> figures;
  std::vector<CustomerDrawing> drawings;
  std::vector<CustomerTable> tables;
  std::vector<std::string> explanations;  ///< below the figures, in the language of the report
  bool is_simulated = false;
  /// Why the result must not be used as it is, on the first sheet; in English, shown as customer_note() has it.
  std::vector<std::string> refusals;
  std::vector<std::string> conditions;  ///< of the evaluation, in the language of the report
  std::vector<std::string> notes;       ///< of the evaluation in English, shown as customer_note() has them
  std::vector<std::string> files;       ///< names of what was evaluated
};

/// Verdict on one figure in one state.
/// @returns not_judged where its value, its whole uncertainty or its tolerance is missing, or the state has no verdict
Conformity customer_conformity(const CustomerReport& report, std::size_t figure, std::size_t state);

/// Verdict on one state in sentences, in the language of the report: what is proven, what is not, on what there is no
/// verdict and why. At least one sentence.
std::vector<std::pair<Conformity, std::string>> customer_verdict(const CustomerReport& report, std::size_t state);

/// Symbols of the figures that exceed their tolerance, or have none to compare with it, in the last state that verdicts
/// are given on: "A, R". As evaluations do it, the values themselves are compared. Empty: none.
std::string exceeded_tolerances(const CustomerReport& report);

/// The report as one page for paper of size A4, without scripts and without any address to load. Text in the report is
/// shown as text, whatever it contains.
std::string customer_page(const CustomerReport& report);

}  // namespace abbe
