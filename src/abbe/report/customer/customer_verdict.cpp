#include <cmath>

#include "abbe/report/customer/customer_report.h"
#include "abbe/report/customer/customer_words.h"

namespace abbe {
namespace {

using Word = CustomerWord;

/// Figures with a tolerance by what is to be said of them.
struct Sorted {
  std::string proven, nonconformity_proven, not_proven, without_value, without_uncertainty, incomplete;
  bool has_tolerance = false;
};

void add_symbol(std::string& list, const CustomerFigure& figure) { list += (list.empty() ? "" : ", ") + figure.symbol; }

Sorted sorted_figures(const CustomerReport& report, std::size_t state) {
  Sorted sorted;
  for (std::size_t i = 0; i < report.figures.size(); ++i) {
    const CustomerFigure& figure = report.figures[i];
    if (!figure.tolerance) continue;
    sorted.has_tolerance = true;
    const CustomerValue& value = figure.states[state];
    switch (customer_conformity(report, i, state)) {
      case Conformity::proven:
        add_symbol(sorted.proven, figure);
        break;
      case Conformity::nonconformity_proven:
        add_symbol(sorted.nonconformity_proven, figure);
        break;
      case Conformity::not_proven:
        add_symbol(sorted.not_proven, figure);
        break;
      case Conformity::not_judged:
        add_symbol(!value.value                  ? sorted.without_value
                   : !value.expanded_uncertainty ? sorted.without_uncertainty
                                                 : sorted.incomplete,
                   figure);
        break;
    }
  }
  return sorted;
}

}  // namespace

Conformity customer_conformity(const CustomerReport& report, std::size_t figure, std::size_t state) {
  const CustomerFigure& judged = report.figures[figure];
  const CustomerValue& value = judged.states[state];
  if (!report.states[state].no_verdict.empty() || !judged.tolerance || !value.value || !value.expanded_uncertainty ||
      value.is_incomplete) {
    return Conformity::not_judged;
  }
  return conformity(*value.value, 0.5 * *value.expanded_uncertainty, *judged.tolerance);
}

std::vector<std::pair<Conformity, std::string>> customer_verdict(const CustomerReport& report, std::size_t state) {
  const ReportLanguage language = report.facts.language;
  std::vector<std::pair<Conformity, std::string>> sentences;
  const auto no_verdict = [&](const std::string& reason) {
    sentences.emplace_back(Conformity::not_judged, customer_text(Word::no_verdict, language, reason));
  };
  const Sorted sorted = sorted_figures(report, state);
  if (!report.states[state].no_verdict.empty()) {
    no_verdict(report.states[state].no_verdict);
    return sentences;
  }
  if (!sorted.has_tolerance) {
    no_verdict(std::string(customer_word(Word::without_tolerance, language)));
    return sentences;
  }
  const auto add = [&](const std::string& symbols, Conformity what, Word word) {
    if (!symbols.empty()) sentences.emplace_back(what, customer_text(word, language, symbols));
  };
  add(sorted.nonconformity_proven, Conformity::nonconformity_proven, Word::nonconformity_proven);
  add(sorted.not_proven, Conformity::not_proven, Word::not_proven);
  add(sorted.proven, Conformity::proven, Word::conformity_proven);
  const auto add_reason = [&](const std::string& symbols, Word word) {
    if (!symbols.empty()) no_verdict(customer_text(word, language, symbols));
  };
  add_reason(sorted.without_value, Word::without_value);
  add_reason(sorted.without_uncertainty, Word::without_uncertainty);
  add_reason(sorted.incomplete, Word::only_identified);
  return sentences;
}

std::string exceeded_tolerances(const CustomerReport& report) {
  std::string symbols;
  for (const CustomerFigure& figure : report.figures) {
    if (!figure.tolerance) continue;
    // The last state that is judged is how the machine is now.
    const CustomerValue* now = nullptr;
    for (std::size_t state = 0; state < report.states.size(); ++state) {
      if (report.states[state].no_verdict.empty()) now = &figure.states[state];
    }
    if (now != nullptr && (!now->value || std::abs(*now->value) > *figure.tolerance)) add_symbol(symbols, figure);
  }
  return symbols;
}

}  // namespace abbe
