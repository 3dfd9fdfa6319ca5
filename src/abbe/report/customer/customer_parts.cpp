#include "abbe/report/customer/customer_parts.h"

#include <algorithm>
#include <utility>

#include "abbe/report/customer/customer_notes.h"
#include "abbe/report/customer/customer_tests.h"

namespace abbe {
namespace {

using Word = CustomerWord;

CustomerValue customer_value(const EvaluationFigure& figure) {
  CustomerValue value;
  if (!figure.value) return value;
  value.value = figure_number(figure, *figure.value);
  if (figure.uncertainty) value.expanded_uncertainty = figure_number(figure, *figure.uncertainty);
  return value;
}

}  // namespace

std::string local_word(CustomerWord word, ReportLanguage language) {
  return std::string(customer_word(word, language));
}

std::string local_word_with_unit(CustomerWord word, const std::string& unit, ReportLanguage language) {
  return local_word(word, language) + " / " + unit;
}

CustomerReport begun_customer_report(const ReportFacts& facts, const EvaluationReport& now,
                                     const EvaluationReport* before, CustomerWord subject,
                                     const std::function<ShownFigure(const EvaluationFigure& figure)>& shown) {
  CustomerReport report;
  report.facts = facts;
  report.subject = local_word(subject, facts.language);
  report.standard = now.standard;
  if (before == nullptr) {
    report.states = {{local_word(Word::measured, facts.language), ""}};
  } else {
    report.states = {{local_word(Word::before, facts.language), ""}, {local_word(Word::after, facts.language), ""}};
  }
  for (const EvaluationFigure& figure : now.figures) {
    const ShownFigure as = shown(figure);
    CustomerFigure added;
    added.symbol = as.symbol;
    added.name = as.name;
    added.unit = as.unit;
    added.decimals = figure.decimals;
    if (before != nullptr) {
      const auto same = std::find_if(before->figures.begin(), before->figures.end(),
                                     [&](const EvaluationFigure& other) { return other.symbol == figure.symbol; });
      added.states.push_back(same == before->figures.end() ? CustomerValue() : customer_value(*same));
    }
    added.states.push_back(customer_value(figure));
    if (figure.tolerance) added.tolerance = figure_number(figure, *figure.tolerance);
    report.figures.push_back(std::move(added));
  }
  return report;
}

CustomerReport begun_test_report(const ReportFacts& facts, const EvaluationReport& now, const EvaluationReport* before,
                                 Word subject) {
  CustomerReport report = begun_customer_report(facts, now, before, subject, [&](const EvaluationFigure& figure) {
    return ShownFigure{figure.symbol, test_figure_name(now.kind, figure, facts.language), unit_symbol(figure.unit)};
  });
  report.notes = now.notes;
  const auto note_missing = [&](const EvaluationReport& of, const char* prefix) {
    for (const EvaluationFigure& figure : of.figures) {
      if (!figure.value) report.notes.push_back(prefix + figure.symbol + ": " + figure.missing + ".");
    }
  };
  if (before != nullptr) note_missing(*before, "before: ");
  note_missing(now, before != nullptr ? "after: " : "");
  return report;
}

std::string fact_of(const EvaluationReport& report, const std::string& name) {
  for (const auto& [fact, text] : report.facts) {
    if (fact == name) return text;
  }
  return "";
}

void add_fact(const EvaluationReport& from, const std::string& name, Word word, CustomerReport& report) {
  const std::string text = fact_of(from, name);
  if (!text.empty()) {
    const ReportLanguage language = report.facts.language;
    report.conditions.push_back(customer_text(word, language, customer_note_argument(text, language)));
  }
}

void thin_table_rows(std::size_t most, CustomerTable& table) {
  const std::size_t all = table.rows.size();
  if (all <= most) return;
  std::vector<std::vector<std::string>> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(std::move(table.rows[i * (all - 1) / (most - 1)]));
  table.rows = std::move(kept);
  table.caption += " (" + std::to_string(most) + " / " + std::to_string(all) + ")";
}

}  // namespace abbe
