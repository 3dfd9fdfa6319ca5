#include "abbe/report/customer/customer_tests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/customer/customer_parts.h"
#include "abbe/report/customer/local_numbers.h"
#include "abbe/report/drawings/svg_plot.h"
#include "abbe/report/drawings/svg_polar_plot.h"
#include "abbe/report/drawings/thinned.h"
#include "abbe/report/evaluations/rotation_report.h"

namespace abbe {
namespace {

using Word = CustomerWord;

constexpr const char* kMicrometre = "µm";
/// Angles at which deviations around a circle are shown.
constexpr int kShownAngles = 24;
/// More columns do not fit on a sheet.
constexpr std::size_t kMostMotionsInTable = 6;
constexpr std::size_t kMostMotionDrawings = 2;

std::string micro_text(double value, ReportLanguage language) { return local_number(1e3 * value, 2, language); }

/// The element nearest to an angle of a circle, if one is within half a step of those that are shown.
std::optional<std::size_t> nearest_to_angle(std::span<const double> angles, double wanted) {
  std::optional<std::size_t> nearest;
  double least = std::numbers::pi / kShownAngles;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double distance = std::abs(std::remainder(angles[i] - wanted, 2 * std::numbers::pi));
    if (distance > least) continue;
    least = distance;
    nearest = i;
  }
  return nearest;
}

double shown_angle(int i) { return 2 * std::numbers::pi * i / kShownAngles; }

std::string degrees_text(double angle, ReportLanguage language) {
  return local_short_number(std::round(angle / kDegree), language);
}

CustomerDrawing circular_drawing(const CircularResult& result, const std::string& plane, const CustomerReport& report) {
  const ReportLanguage language = report.facts.language;
  PolarPlot plot(report.subject, local_word_with_unit(Word::radial_deviation, kMicrometre, language));
  if (plane.size() == 2) plot.name_axes(std::string("+") + plane[0], std::string("+") + plane[1]);
  constexpr std::array<Word, 2> kDirections = {Word::clockwise, Word::counterclockwise};
  constexpr std::array<PlotColour, 2> kColours = {PlotColour::first, PlotColour::second};
  for (std::size_t k = 0; k < 2; ++k) {
    const CircularDeviation& path = result.paths[k];
    if (path.status != CircleStatus::done) continue;
    std::vector<PolarPoint> points;
    for (const std::size_t i : thinned(path.deviations)) points.push_back({path.angle[i], 1e3 * path.deviations[i]});
    plot.line(points, !path.partial, {kColours[k]}, local_word(kDirections[k], language));
  }
  return {local_word(Word::radial_deviation, language), plot.picture().wide};
}

CustomerTable circular_table(const CircularResult& result, ReportLanguage language) {
  CustomerTable table;
  table.caption = local_word(Word::radial_near_angles, language);
  table.headers = {local_word_with_unit(Word::angle, "°", language),
                   local_word_with_unit(Word::clockwise, kMicrometre, language),
                   local_word_with_unit(Word::counterclockwise, kMicrometre, language)};
  for (int row = 0; row < kShownAngles; ++row) {
    std::vector<std::string> cells = {degrees_text(shown_angle(row), language)};
    bool is_empty = true;
    for (const CircularDeviation& path : result.paths) {
      const auto at = path.status == CircleStatus::done ? nearest_to_angle(path.angle, shown_angle(row)) : std::nullopt;
      cells.push_back(at ? micro_text(path.deviations[*at], language) : std::string(kNothingShown));
      is_empty = is_empty && !at;
    }
    if (!is_empty) table.rows.push_back(std::move(cells));
  }
  return table;
}

CustomerDrawing motion_drawing(const RotationResult& result, const AxisErrorMotion& motion, const std::string& name,
                               ReportLanguage language) {
  const bool is_angle = is_tilt(motion.kind);
  const double unit = micro_per_unit(is_angle);
  PolarPlot plot(name, local_word_with_unit(Word::total, is_angle ? "µrad" : kMicrometre, language));
  std::vector<PolarPoint> total, synchronous;
  for (const std::size_t i : thinned(motion.total)) {
    total.push_back({result.angle[i % result.positions], unit * motion.total[i]});
  }
  for (std::size_t k = 0; k < result.positions; ++k) {
    synchronous.push_back({result.angle[k], unit * motion.synchronous[k]});
  }
  plot.line(total, false, {PlotColour::soft, 0.7, false, 0.6}, local_word(Word::total, language));
  plot.line(synchronous, true, {PlotColour::first, 2}, local_word(Word::synchronous, language));
  return {name, plot.picture().wide};
}

/// "radial, plane 1" of "radial, plane 1: synchronous error motion".
std::string motion_words(const EvaluationReport& report, AxisErrorMotionKind kind, ReportLanguage language) {
  for (const EvaluationFigure& figure : report.figures) {
    if (figure.symbol != std::string(error_motion_symbol(kind)) + "_total") continue;
    const std::string name = test_figure_name(report.kind, figure, language);
    return name.substr(0, name.rfind(": "));
  }
  return error_motion_symbol(kind);
}

CustomerTable motions_table(const RotationResult& result, std::size_t first, std::size_t last,
                            const EvaluationReport& report, ReportLanguage language) {
  CustomerTable table;
  table.caption = local_word(Word::synchronous_at_angles, language);
  table.headers = {local_word_with_unit(Word::angle, "°", language)};
  for (std::size_t m = first; m < last; ++m) {
    const AxisErrorMotionKind kind = result.motions[m].kind;
    table.headers.push_back(motion_words(report, kind, language) + " / " + (is_tilt(kind) ? "µrad" : kMicrometre));
  }
  for (int row = 0; row < kShownAngles; ++row) {
    const auto at = nearest_to_angle(result.angle, shown_angle(row));
    if (!at) continue;
    std::vector<std::string> cells = {degrees_text(shown_angle(row), language)};
    for (std::size_t m = first; m < last; ++m) {
      const AxisErrorMotion& motion = result.motions[m];
      cells.push_back(local_number(micro_per_unit(is_tilt(motion.kind)) * motion.synchronous[*at], 2, language));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// Deviations over positions in the order of the positions.
std::vector<std::size_t> order_along(const Straightness& line) {
  std::vector<std::size_t> order(line.deviations.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return line.positions[a] < line.positions[b]; });
  return order;
}

CustomerDrawing line_drawing(const Straightness& line, const std::string& caption, ReportLanguage language) {
  XyPlot plot(caption, local_word_with_unit(Word::position, "mm", language),
              local_word_with_unit(Word::deviation, kMicrometre, language));
  std::vector<PlotPoint> points;
  for (const std::size_t i : order_along(line)) points.push_back({line.positions[i], 1e3 * line.deviations[i]});
  plot.line(points, {PlotColour::first, 1}, "");
  plot.points(points, Marker::circle, {PlotColour::first}, "");
  plot.level(1e3 * line.largest, micro_text(line.largest, language), {PlotColour::soft, 1, true, 1});
  plot.level(1e3 * line.smallest, micro_text(line.smallest, language), {PlotColour::soft, 1, true, 1});
  return {caption, plot.picture().wide};
}

std::string line_caption(const std::string& name, ReportLanguage language) {
  std::string caption = customer_text(Word::line_deviations, language, name);
  while (caption.ends_with(' ')) caption.pop_back();
  return caption;
}

/// @param lines  about the same readings, with the header of each
CustomerTable line_table(const std::string& caption, const std::vector<std::pair<Word, const Straightness*>>& lines,
                         std::size_t most, ReportLanguage language) {
  CustomerTable table;
  table.caption = caption;
  table.headers = {local_word_with_unit(Word::position, "mm", language)};
  for (const auto& [header, line] : lines) {
    table.headers.push_back(local_word_with_unit(header, kMicrometre, language));
  }
  const Straightness& first = *lines.front().second;
  for (const std::size_t i : order_along(first)) {
    std::vector<std::string> cells = {local_short_number(first.positions[i], language)};
    for (const auto& [header, line] : lines) cells.push_back(micro_text(line->deviations[i], language));
    table.rows.push_back(std::move(cells));
  }
  thin_table_rows(most, table);
  return table;
}

}  // namespace

CustomerReport customer_circular(const ReportFacts& facts, const EvaluationReport& now, const CircularResult& result,
                                 const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::circular_test);
  const ReportLanguage language = facts.language;
  add_fact(now, "plane", Word::plane_fact, report);
  add_fact(now, "nominal radius", Word::radius_fact, report);
  constexpr std::array<std::pair<const char*, Word>, 3> kCentres = {{{"least squares", Word::centre_least_squares},
                                                                     {"minimum zone", Word::centre_minimum_zone},
                                                                     {"instrument", Word::centre_instrument}}};
  const std::string stated_centre = fact_of(now, "centre");
  for (const auto& [centre, word] : kCentres) {
    if (stated_centre != centre) continue;
    report.conditions.push_back(customer_text(Word::centre_fact, language, local_word(word, language)));
  }
  const bool any = result.paths[0].status == CircleStatus::done || result.paths[1].status == CircleStatus::done;
  if (!any) return report;
  report.drawings.push_back(circular_drawing(result, fact_of(now, "plane"), report));
  report.tables.push_back(circular_table(result, language));
  return report;
}

CustomerReport customer_rotation(const ReportFacts& facts, const EvaluationReport& now, const RotationResult& result,
                                 const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::rotation_motions);
  const ReportLanguage language = facts.language;
  add_fact(now, "whole turns", Word::turns_fact, report);
  const std::size_t n = result.motions.size();
  for (std::size_t m = 0; m < std::min(n, kMostMotionDrawings); ++m) {
    const AxisErrorMotion& motion = result.motions[m];
    report.drawings.push_back(motion_drawing(result, motion, motion_words(now, motion.kind, language), language));
  }
  for (std::size_t first = 0; first < n; first += kMostMotionsInTable) {
    report.tables.push_back(motions_table(result, first, std::min(n, first + kMostMotionsInTable), now, language));
  }
  return report;
}

CustomerReport customer_straightness(const ReportFacts& facts, const EvaluationReport& now,
                                     const Straightness& least_squares, const Straightness& minimum_zone,
                                     const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::straightness_test);
  const ReportLanguage language = facts.language;
  add_fact(now, "readings", Word::reading_count_fact, report);
  add_fact(now, "length", Word::length_fact, report);
  if (minimum_zone.status != StraightnessStatus::done) return report;
  const std::string caption = line_caption("", language);
  report.drawings.push_back(line_drawing(minimum_zone, caption, language));
  report.tables.push_back(
      line_table(caption, {{Word::from_least_squares, &least_squares}, {Word::from_minimum_zone, &minimum_zone}},
                 kMostTableRows, language));
  return report;
}

CustomerReport customer_squareness(const ReportFacts& facts, const EvaluationReport& now, const Squareness& result,
                                   const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::squareness_test);
  const ReportLanguage language = facts.language;
  if (result.status != StraightnessStatus::done) return report;
  const Word from_line =
      fact_of(now, "reference lines") == "minimum-zone" ? Word::from_minimum_zone : Word::from_least_squares;
  const std::vector<std::string> names = now.figures.front().about;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::string caption = line_caption(k < names.size() ? names[k] : "", language);
    report.drawings.push_back(line_drawing(result.lines[k], caption, language));
    report.tables.push_back(line_table(caption, {{from_line, &result.lines[k]}}, kMostRowsOfTwoTables, language));
  }
  return report;
}

CustomerReport customer_sections(const ReportFacts& facts, const EvaluationReport& now, const SectionsEvaluation& found,
                                 const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::contour_test);
  const ReportLanguage language = facts.language;
  CustomerTable table;
  table.caption = local_word(Word::section_errors, language);
  table.headers = {local_word(Word::section, language), local_word_with_unit(Word::along, "mm", language),
                   local_word_with_unit(Word::contour_error, kMicrometre, language), "U / µm",
                   local_word_with_unit(Word::rounding, kMicrometre, language)};
  // Sections whose places are not all stated are drawn by their numbers.
  const bool are_along = std::all_of(found.answers.begin(), found.answers.end(),
                                     [](const SectionAnswer& answer) { return answer.along.has_value(); });
  std::vector<PlotPoint> errors;
  for (std::size_t i = 0; i < found.answers.size(); ++i) {
    const SectionAnswer& answer = found.answers[i];
    std::vector<std::string> row = {answer.name,
                                    answer.along ? local_short_number(*answer.along, language) : kNothingShown};
    if (answer.ok) {
      std::string rounding;
      for (const EdgeFit* edge : answer.edges()) {
        rounding += (rounding.empty() ? "" : "; ") + micro_text(edge->rounding, language);
      }
      row.insert(row.end(),
                 {micro_text(answer.error, language), micro_text(2 * answer.error_uncertainty, language), rounding});
      errors.push_back({are_along ? *answer.along : static_cast<double>(i + 1), 1e3 * answer.error});
    } else {
      row.insert(row.end(), 3, kNothingShown);
    }
    table.rows.push_back(std::move(row));
  }
  thin_table_rows(kMostTableRows, table);
  if (!errors.empty()) {
    XyPlot plot(report.subject,
                are_along ? local_word_with_unit(Word::along, "mm", language) : local_word(Word::section, language),
                local_word_with_unit(Word::contour_error, kMicrometre, language));
    plot.level(0, "", {PlotColour::soft, 1});
    plot.line(errors, {PlotColour::first, 1}, "");
    plot.points(errors, Marker::circle, {PlotColour::first}, "");
    report.drawings.push_back({local_word(Word::contour_error, language), plot.picture().wide});
  }
  report.tables.push_back(std::move(table));
  return report;
}

CustomerReport customer_contour_points(const ReportFacts& facts, const EvaluationReport& now,
                                       const ContourPointsEvaluation& found, const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::contour_test);
  const ReportLanguage language = facts.language;
  CustomerTable table;
  table.caption = local_word(Word::point_errors, language);
  table.headers = {local_word_with_unit(Word::along, "mm", language),
                   local_word_with_unit(Word::across, kMicrometre, language),
                   local_word_with_unit(Word::out_of_surface, kMicrometre, language),
                   local_word_with_unit(Word::distance, kMicrometre, language)};
  const auto shown = [&](const std::optional<double>& value) {
    return value ? micro_text(*value, language) : std::string(kNothingShown);
  };
  std::vector<std::size_t> order;
  std::vector<double> across;
  for (std::size_t i = 0; i < found.deviations.size(); ++i) {
    if (!found.deviations[i].beyond_end) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return found.deviations[a].along < found.deviations[b].along; });
  for (const std::size_t i : order) {
    const ContourDeviation& point = found.deviations[i];
    table.rows.push_back({local_number(point.along, 3, language), shown(point.across), shown(point.off),
                          micro_text(point.distance, language)});
  }
  thin_table_rows(kMostTableRows, table);
  for (const std::size_t i : found.counted) across.push_back(found.deviations[i].across.value());
  std::vector<PlotPoint> points;
  for (const std::size_t i : thinned(across)) {
    points.push_back({found.deviations[found.counted[i]].along, 1e3 * across[i]});
  }
  if (!points.empty()) {
    XyPlot plot(report.subject, local_word_with_unit(Word::along, "mm", language),
                local_word_with_unit(Word::across, kMicrometre, language));
    plot.level(0, "", {PlotColour::soft, 1});
    plot.points(points, Marker::circle, {PlotColour::first}, "");
    report.drawings.push_back({local_word(Word::contour_error, language), plot.picture().wide});
  }
  report.tables.push_back(std::move(table));
  return report;
}

CustomerReport customer_linkage(const ReportFacts& facts, const EvaluationReport& now, const EvaluationReport* before) {
  return begun_test_report(facts, now, before, Word::linkage_test);
}

}  // namespace abbe
