#include "abbe/study/report/outlier_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"
#include "abbe/study/study_result.h"

namespace abbe {
namespace {

constexpr std::size_t kOutliersShown = 5;
constexpr std::size_t kMostOutliers = 1000;

/// Name of the point of a reading in the input, empty if it has none.
std::string point_of(const StudyResult& result, const Outlier& outlier) {
  const std::vector<std::string>& points = result.campaign.setups[outlier.observations].readings.point_name;
  return points.empty() ? std::string() : points[outlier.reading];
}

}  // namespace

std::string outliers_text(const Study& study, const StudyResult& result, const char* shows_all) {
  std::string text;
  const std::vector<Outlier>& outliers = result.identification.outliers;
  if (outliers.empty()) return text;
  text += "\noutliers, by the length of their residual in standard uncertainties\n";
  const std::size_t shown = shows_all == nullptr ? outliers.size() : std::min(outliers.size(), kOutliersShown);
  for (std::size_t i = 0; i < shown; ++i) {
    const Outlier& outlier = outliers[i];
    const std::string point = point_of(result, outlier);
    std::string pose;
    const std::vector<double> positions =
        result.model.problem.observations[outlier.observations].observations->positions(outlier.reading);
    for (std::size_t a = 0; a < positions.size(); ++a) {
      const Axis& axis = study.machine.axes[a];
      pose += fmt::format("{}{} {:.6g} {}", a > 0 ? ", " : "", axis.name, positions[a] / position_unit(axis),
                          position_suffix(axis));
    }
    text += fmt::format("  {} reading {}{}{}: {:.1f} at {}\n", result.campaign.setups[outlier.observations].name,
                        outlier.reading, point.empty() ? "" : ", point ", point, outlier.norm, pose);
  }
  if (shown < outliers.size()) text += fmt::format("  {} more: {}\n", outliers.size() - shown, shows_all);
  return text;
}

nlohmann::ordered_json outliers_json(const Study& study, const StudyResult& result) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Outlier& outlier : result.identification.outliers) {
    if (list.size() == kMostOutliers) break;
    nlohmann::ordered_json entry = {{"setup", study.setups[outlier.observations].name}, {"reading", outlier.reading}};
    const std::string point = point_of(result, outlier);
    if (!point.empty()) entry["point"] = point;
    entry["normalised_length"] = outlier.norm;
    entry["weight"] = outlier.weight;
    list.push_back(entry);
  }
  return list;
}

}  // namespace abbe
