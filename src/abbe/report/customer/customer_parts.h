#pragma once

// Internal to report: what customer reports on evaluations have in common.
#include <cstddef>
#include <functional>
#include <string>

#include "abbe/report/customer/customer_report.h"
#include "abbe/report/customer/customer_words.h"
#include "abbe/report/evaluations/evaluation_report.h"

namespace abbe {

/// In place of a value that is not there.
inline constexpr const char* kNothingShown = "\xE2\x80\x93";

/// Most rows of the table of an evaluation, and of each of two such tables.
inline constexpr std::size_t kMostTableRows = 60, kMostRowsOfTwoTables = 30;

std::string local_word(CustomerWord word, ReportLanguage language);
/// "Target / mm".
std::string local_word_with_unit(CustomerWord word, const std::string& unit, ReportLanguage language);

/// Name and unit of a figure as a customer report shows them.
struct ShownFigure {
  std::string symbol, name, unit;
};

/// A report with its states and figures; those before are found by their symbols.
/// @param before  null: one state only
/// @param shown   of each figure
CustomerReport begun_customer_report(const ReportFacts& facts, const EvaluationReport& now,
                                     const EvaluationReport* before, CustomerWord subject,
                                     const std::function<ShownFigure(const EvaluationFigure& figure)>& shown);

/// The same of a test whose figures have names by test_figure_name(), with the notes of the evaluation and the reasons
/// of missing figures.
CustomerReport begun_test_report(const ReportFacts& facts, const EvaluationReport& now, const EvaluationReport* before,
                                 CustomerWord subject);

/// A fact of the evaluation; empty: it has none of this name.
std::string fact_of(const EvaluationReport& report, const std::string& name);
/// A fact of the evaluation as a condition, if it is there.
void add_fact(const EvaluationReport& from, const std::string& name, CustomerWord word, CustomerReport& report);

/// Keeps evenly chosen rows, the first and the last among them, if there are more than `most`; the caption then says
/// how many of how many are shown.
void thin_table_rows(std::size_t most, CustomerTable& table);

}  // namespace abbe
