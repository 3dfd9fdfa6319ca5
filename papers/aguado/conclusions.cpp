#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aguado/tables.h"

namespace abbe {
namespace {

std::vector<const AguadoRow*> rows_of_experiment(const std::vector<AguadoRow>& rows, AguadoExperiment experiment) {
  std::vector<const AguadoRow*> found;
  for (const AguadoRow& row : rows) {
    if (row.experiment == experiment) found.push_back(&row);
  }
  return found;
}

/// Where the published figure lies among what polynomials of rising order leave.
std::string order_words(const std::vector<AguadoRow>& rows, AguadoExperiment experiment, double published) {
  std::string list, place;
  const AguadoRow* previous = nullptr;
  for (const AguadoRow* row : rows_of_experiment(rows, experiment)) {
    if (row->order == 0) continue;
    list += fmt::format("{}{:.1f}", list.empty() ? "" : ", ", row->percent_left());
    if (previous == nullptr && row->percent_left() < published) place = "more than any of them leaves";
    if (previous != nullptr && previous->percent_left() >= published && row->percent_left() < published) {
      place = fmt::format("between orders {} and {}", previous->order, row->order);
    }
    previous = row;
  }
  if (place.empty()) place = "less than any of them leaves";
  return fmt::format("{}: polynomials of rising order leave {} % of the mean error here; the paper's {:.2f} % is {}.",
                     kAguadoPublished[static_cast<std::size_t>(experiment)].name, list, published, place);
}

std::string range_words(double low, double high) {
  return std::abs(high - low) < 0.005 ? fmt::format("{:.2f} %", low) : fmt::format("{:.2f} to {:.2f} %", low, high);
}

/// What the constant terms of C decide in Table 1, and whether the paper's figure follows from it.
std::string rotary_words(const std::vector<AguadoRow>& rows) {
  double with[2] = {1e9, -1e9}, without[2] = {1e9, -1e9};
  double nearest = 1e9, printed = 0;
  std::string nearest_model, nearest_status;
  const double paper = kAguadoPublished[0].percent;
  for (const AguadoRow* row : rows_of_experiment(rows, AguadoExperiment::table_1)) {
    double* range = row->constant ? with : without;
    range[0] = std::min(range[0], row->percent_left());
    range[1] = std::max(range[1], row->percent_left());
    if (row->as_paper) printed = row->percent_left();
    if (std::abs(row->percent_left() - paper) < std::abs(nearest - paper)) {
      nearest = row->percent_left();
      nearest_model = row->model;
      nearest_status = status_text(row->fit.identification.status);
    }
  }
  std::string words = fmt::format(
      "Table 1: without constant terms of C {} of the mean error are left here, with them {}; (15) as printed leaves "
      "{:.2f} %. ",
      range_words(without[0], without[1]), range_words(with[0], with[1]), printed);
  words += fmt::format("\"{}\" comes closest to the paper's {:.2f} % with {:.2f} % (status of the fit: {}). ",
                       nearest_model, paper, nearest, nearest_status);
  words +=
      "Which function caused the paper's figure does not follow from this: the errors of its machine are not "
      "published.";
  return words;
}

/// Fits that are much better where they were measured than elsewhere.
std::string validation_words(const std::vector<AguadoRow>& rows) {
  std::size_t wrong = 0, partial = 0, other = 0, joint = 0;
  for (const AguadoRow& row : rows) {
    const bool elsewhere = row.percent_left_unseen() > 2 * row.percent_left();
    const bool one_kind = row.experiment == AguadoExperiment::table_1 || row.experiment == AguadoExperiment::table_2;
    (one_kind ? partial : joint) += 1;
    if (elsewhere) (one_kind ? wrong : other) += 1;
  }
  return fmt::format(
      "In {} of {} fits of one kind of axis alone, and in {} of {} fits of all axes, the share of the error that is "
      "left at unseen poses is more than twice the share at the readings{}.",
      wrong, partial, other, joint, wrong + other > 0 ? ": a residual is not a validation" : "");
}

}  // namespace

std::vector<std::string> aguado_conclusions(const std::vector<AguadoRow>& rows) {
  std::vector<std::string> words = {
      rotary_words(rows),
      order_words(rows, AguadoExperiment::table_2,
                  100 * kAguadoPublished[1].final_mean / kAguadoPublished[1].initial_mean),
      order_words(rows, AguadoExperiment::table_3, kAguadoPublished[2].percent), validation_words(rows)};
  const AguadoRow* best = nullptr;
  std::string strategies;
  for (const AguadoRow* row : rows_of_experiment(rows, AguadoExperiment::strategy)) {
    strategies += fmt::format("{}{:.2f}", strategies.empty() ? "" : ", ", row->percent_left_unseen());
    if (best == nullptr || row->percent_left_unseen() < best->percent_left_unseen()) best = row;
  }
  if (best != nullptr) {
    words.push_back(fmt::format("Strategies 1, 2, 3 leave {} % at unseen poses; the least is left by \"{}\".",
                                strategies, best->model));
  }
  words.emplace_back(
      "The paper's synthetic machine and the orders of its polynomials are not published. Its numbers are compared "
      "with those of the reference machine, whose errors are known, not reproduced digit by digit.");
  return words;
}

}  // namespace abbe
