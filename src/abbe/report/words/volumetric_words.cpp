#include "abbe/report/words/volumetric_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/statistics_json.h"

namespace abbe {
namespace {

double mean_in_um(const SampleStatistics& statistics) { return 1e3 * statistics.mean; }

}  // namespace

std::string error_line(const std::string& name, const SampleStatistics& s) {
  return fmt::format("  {:<46} mean {:>9.3f}   95 % {:>9.3f}   max {:>9.3f} um\n", name, 1e3 * s.mean, 1e3 * s.p95,
                     1e3 * s.maximum);
}

std::string volumetric_text(const VolumetricFigures& figures, const std::string& covers) {
  if (figures.poses == 0) return {};
  std::string text =
      fmt::format("volumetric error over {}, after the best fit of the workpiece datum\n", figures.poses_words);
  if (figures.predicted_before) text += error_line("predicted volumetric error, before", *figures.predicted_before);
  if (figures.predicted_after) {
    text += error_line("predicted volumetric error, after (k = 2)", *figures.predicted_after);
    if (!covers.empty()) text += fmt::format("    (of the {})\n", covers);
  }
  if (figures.true_before) text += error_line("true volumetric error, before", *figures.true_before);
  if (figures.true_after) text += error_line("true volumetric error, after", *figures.true_after);
  if (figures.outside > 0) {
    text += fmt::format("  left out: {} poses outside the range in which the errors are known\n", figures.outside);
  }
  return text;
}

void add_volumetric_figures(const VolumetricFigures& figures, nlohmann::ordered_json& json, const std::string& covers) {
  const auto object = [&] {
    nlohmann::ordered_json entry;
    entry["poses"] = figures.poses;
    entry["description"] = figures.poses_words + ", after the best fit of the workpiece datum";
    if (figures.outside > 0) entry["outside_range"] = figures.outside;
    return entry;
  };
  if (figures.predicted_before) {
    nlohmann::ordered_json entry = object();
    entry["before_um"] = statistics_um(*figures.predicted_before);
    if (figures.predicted_after) {
      entry["after_expanded_um"] = statistics_um(*figures.predicted_after);
      if (!covers.empty()) entry["uncertainty_covers"] = covers;
    }
    json["predicted_volumetric_error"] = entry;
  }
  if (figures.true_before) {
    nlohmann::ordered_json entry = object();
    entry["before_um"] = statistics_um(*figures.true_before);
    if (figures.true_after) entry["after_um"] = statistics_um(*figures.true_after);
    json["true_volumetric_error"] = entry;
  }
}

std::string volumetric_sentence(const VolumetricFigures& figures, const std::string& covers) {
  const std::string of = covers.empty() ? "" : ", " + covers;
  const std::string where = fmt::format("mean over {}", figures.poses_words);
  if (figures.true_before && figures.true_after) {
    const std::string predicted = figures.predicted_after ? fmt::format(" (predicted: {:.3g} um, k = 2{})",
                                                                        mean_in_um(*figures.predicted_after), of)
                                                          : "";
    return fmt::format("True volumetric error {:.4g} um before, {:.3g} um after correction{}, {}.",
                       mean_in_um(*figures.true_before), mean_in_um(*figures.true_after), predicted, where);
  }
  if (!figures.predicted_before) return "";
  const std::string after = figures.predicted_after ? fmt::format(", {:.3g} um (k = 2{}) after correction",
                                                                  mean_in_um(*figures.predicted_after), of)
                                                    : "";
  return fmt::format("Predicted volumetric error {:.4g} um before{}, {}.", mean_in_um(*figures.predicted_before), after,
                     where);
}

}  // namespace abbe
