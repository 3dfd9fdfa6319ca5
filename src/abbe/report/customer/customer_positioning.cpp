#include "abbe/report/customer/customer_positioning.h"

#include <algorithm>
#include <utility>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/customer/customer_parts.h"
#include "abbe/report/customer/customer_words.h"
#include "abbe/report/customer/local_numbers.h"
#include "abbe/report/drawings/positioning_plot.h"
#include "abbe/report/evaluations/positioning_report.h"

namespace abbe {
namespace {

using Word = CustomerWord;

/// Names and units of one report, in its language.
struct Language {
  ReportLanguage language;
  bool rotary;

  std::string word(Word word) const { return local_word(word, language); }
  const char* position_unit() const { return rotary ? "°" : "mm"; }
  const char* deviation_unit() const { return rotary ? "″" : "µm"; }
  std::string position(double value) const { return local_short_number(value * (rotary ? 1 / kDegree : 1), language); }
  std::string deviation(double value) const { return local_number(value * (rotary ? 1 / kArcsec : 1e3), 2, language); }
  /// Before a sentence on one of several things.
  static std::string prefix(const std::string& of) { return of.empty() ? "" : of + ": "; }
  std::string with_unit(Word word, const char* unit) const { return local_word_with_unit(word, unit, language); }
};

/// The standard marks directions with arrows: "A↑" of "A+".
std::string standard_symbol(std::string symbol) {
  if (symbol.ends_with('+')) return symbol.substr(0, symbol.size() - 1) + "↑";
  if (symbol.ends_with('-')) return symbol.substr(0, symbol.size() - 1) + "↓";
  return symbol;
}

CustomerReport begun_report(const ReportFacts& facts, const EvaluationReport& now, const EvaluationReport* before,
                            const Language& in, Word subject) {
  return begun_customer_report(facts, now, before, subject, [&](const EvaluationFigure& figure) {
    const std::string_view name = positioning_figure_name(figure.symbol, in.language);
    return ShownFigure{standard_symbol(figure.symbol), name.empty() ? figure.name : std::string(name),
                       in.deviation_unit()};
  });
}

/// Why a figure is not evaluated, in the language of the report; as it is where there are no words for it.
std::string missing_words(const std::string& missing, const Language& in) {
  constexpr std::pair<FigureStatus, Word> kReasons[] = {
      {FigureStatus::no_readings, Word::no_readings},
      {FigureStatus::needs_two_runs, Word::needs_two_runs},
      {FigureStatus::needs_both_directions, Word::needs_both_directions},
      {FigureStatus::needs_this_direction, Word::needs_this_direction},
      {FigureStatus::needs_two_positions, Word::needs_two_positions}};
  for (const auto& [status, word] : kReasons) {
    if (missing == figure_status_words(status)) return in.word(word);
  }
  return missing;
}

/// What readings lack of what the standard asks. @param of  what they are of: a state, a diagonal; or empty
void add_shortfalls(const PositioningEvaluation& evaluation, const std::string& of, const Language& in,
                    CustomerReport& report) {
  for (const PositioningShortfall& one : positioning_shortfalls(evaluation, in.rotary)) {
    using Kind = PositioningShortfall::Kind;
    const Word word = one.kind == Kind::few_runs      ? Word::few_runs
                      : one.kind == Kind::uneven_runs ? Word::uneven_runs
                      : one.kind == Kind::few_targets ? Word::few_targets
                                                      : Word::equal_spacing;
    report.conditions.push_back(in.prefix(of) + customer_text(word, in.language, one.numbers));
  }
}

/// Which figures are not evaluated, and why.
void add_missing(const EvaluationReport& evaluated, const std::string& of, const Language& in, CustomerReport& report) {
  for (const EvaluationFigure& figure : evaluated.figures) {
    if (figure.value) continue;
    report.conditions.push_back(in.prefix(of) + standard_symbol(figure.symbol) + ": " +
                                missing_words(figure.missing, in));
  }
}

CustomerTable targets_table(const PositioningEvaluation& evaluation, const std::string& state, const Language& in) {
  const char* const unit = in.deviation_unit();
  CustomerTable table;
  table.caption = in.word(Word::target_errors) + (state.empty() ? "" : " – " + state);
  table.headers = {in.with_unit(Word::target, in.position_unit()),
                   in.with_unit(Word::mean_positive, unit),
                   in.with_unit(Word::scatter_positive, unit),
                   in.with_unit(Word::mean_negative, unit),
                   in.with_unit(Word::scatter_negative, unit),
                   in.with_unit(Word::reversal, unit),
                   in.with_unit(Word::mean_both, unit)};
  for (const PositioningTarget& target : evaluation.targets) {
    const auto mean = [&](std::size_t side) {
      return target.runs[side] > 0 ? in.deviation(target.mean[side]) : std::string(kNothingShown);
    };
    const auto scatter = [&](std::size_t side) {
      return target.runs[side] > 1 ? in.deviation(target.deviation[side]) : std::string(kNothingShown);
    };
    const auto figure = [&](const EvaluatedFigure& found) {
      return found.is_evaluated() ? in.deviation(found.value) : std::string(kNothingShown);
    };
    table.rows.push_back({in.position(target.position), mean(0), scatter(0), mean(1), scatter(1),
                          figure(target.reversal), figure(target.mean_bidirectional)});
  }
  return table;
}

PositioningPlotWords plot_words(const Language& in) {
  return {.position = in.with_unit(Word::target, in.position_unit()),
          .deviation = in.with_unit(Word::deviation, in.deviation_unit()),
          .means = {in.word(Word::positive_approach), in.word(Word::negative_approach)},
          .band = in.word(Word::mean_with_scatter),
          .bidirectional_mean = in.word(Word::mean_both)};
}

}  // namespace

CustomerReport customer_positioning(const ReportFacts& facts, bool rotary, const CustomerPositioning& now,
                                    const CustomerPositioning* before) {
  const Language in{facts.language, rotary};
  CustomerReport report = begun_report(facts, now.report, before != nullptr ? &before->report : nullptr, in,
                                       rotary ? Word::rotary_axis : Word::linear_axis);
  const auto add_state = [&](const CustomerPositioning& of, const std::string& state) {
    const PositioningEvaluation& evaluation = of.evaluation;
    add_shortfalls(evaluation, state, in, report);
    add_missing(of.report, state, in, report);
    report.drawings.push_back(
        {in.word(Word::target_errors) + (state.empty() ? "" : " – " + state),
         positioning_plot(evaluation, rotary, state.empty() ? report.subject : state, plot_words(in)).wide});
    report.tables.push_back(targets_table(evaluation, state, in));
    thin_table_rows(before != nullptr ? kMostRowsOfTwoTables : kMostTableRows, report.tables.back());
  };
  if (before != nullptr) add_state(*before, in.word(Word::before));
  add_state(now, before != nullptr ? in.word(Word::after) : "");
  // What the readings lack is among the conditions already; behind it come the notes of a correction.
  const std::vector<std::string>& notes = now.report.notes;
  const std::size_t shortfalls = positioning_shortfalls(now.evaluation, rotary).size();
  report.notes.insert(report.notes.end(), notes.begin() + static_cast<std::ptrdiff_t>(shortfalls), notes.end());
  return report;
}

CustomerReport customer_diagonals(const ReportFacts& facts, const EvaluationReport& report,
                                  const DiagonalsEvaluation& evaluation, const EvaluationReport* before) {
  const Language in{facts.language, false};
  CustomerReport shown = begun_report(facts, report, before, in, Word::diagonals);
  CustomerTable table;
  const char* const unit = in.deviation_unit();
  table.caption = in.word(Word::target_errors) + (before != nullptr ? " – " + in.word(Word::after) : "");
  table.headers = {in.word(Word::diagonal),
                   in.with_unit(Word::target, "mm"),
                   in.with_unit(Word::mean_positive, unit),
                   in.with_unit(Word::mean_negative, unit),
                   in.with_unit(Word::reversal, unit),
                   in.with_unit(Word::mean_both, unit)};
  for (const DiagonalEvaluation& diagonal : evaluation.diagonals) {
    add_shortfalls(diagonal.positioning, diagonal.name, in, shown);
    const CustomerTable one = targets_table(diagonal.positioning, "", in);
    for (const std::vector<std::string>& row : one.rows) {
      table.rows.push_back({diagonal.name, row[0], row[1], row[3], row[5], row[6]});
    }
  }
  add_missing(report, "", in, shown);
  thin_table_rows(kMostTableRows, table);
  shown.tables.push_back(std::move(table));
  shown.drawings.push_back({in.word(Word::target_errors), diagonals_plot(evaluation, shown.subject).wide});
  return shown;
}

}  // namespace abbe
