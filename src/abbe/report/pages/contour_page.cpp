#include "abbe/report/pages/contour_page.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "abbe/report/drawings/thinned.h"
#include "abbe/report/pages/contour_sections.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {
namespace {

constexpr std::size_t kSectionsDrawn = 60, kRefusedDrawn = 20;
constexpr std::size_t kContourPointsDrawn = 500;  // of a section

/// Hundredths of a micrometre are more than a drawing shows.
double hundredths(double um) { return std::round(100 * um) / 100; }

nlohmann::json column(const std::vector<PlotPoint>& points, double PlotPoint::*member) {
  nlohmann::json numbers = nlohmann::json::array();
  const std::size_t step = (points.size() + kContourPointsDrawn - 1) / kContourPointsDrawn;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(step, 1)) {
    numbers.push_back(hundredths(points[i].*member));
  }
  return numbers;
}

nlohmann::json drawn_section(const SectionOptions& options, const SectionReadings& section,
                             const SectionAnswer& answer) {
  const SectionPicture picture = section_picture(options, section, answer);
  nlohmann::json json = {{"name", section.name},
                         {"across_um", column(picture.scanned, &PlotPoint::x)},
                         {"height_um", column(picture.scanned, &PlotPoint::y)}};
  if (section.along) json["s_mm"] = *section.along;
  if (!answer.ok) {
    json["not_evaluated"] = answer.reason;
    return json;
  }
  json["error_um"] = 1e3 * answer.error;
  json["u_um"] = 1e3 * std::hypot(answer.error_uncertainty, options.origin_uncertainty);
  for (const SectionPicture::Edge& edge : picture.edges) {
    json["edges"].push_back({{"across_um", column(edge.curve, &PlotPoint::x)},
                             {"height_um", column(edge.curve, &PlotPoint::y)},
                             {"P1_um", {hundredths(edge.onset.x), hundredths(edge.onset.y)}},
                             {"P2_um", {hundredths(edge.corner.x), hundredths(edge.corner.y)}}});
  }
  return json;
}

/// Which sections are drawn: all, or some evenly, with the largest contour error and the first that were refused.
std::vector<std::size_t> drawn_sections(const std::vector<SectionAnswer>& answers) {
  const std::size_t every = (answers.size() + kSectionsDrawn - 1) / kSectionsDrawn;
  std::size_t largest = answers.size(), refused = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i].ok) continue;
    if (largest == answers.size() || std::abs(answers[i].error) > std::abs(answers[largest].error)) largest = i;
  }
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const bool is_refused = !answers[i].ok && refused++ < kRefusedDrawn;
    if (i % every == 0 || i == largest || is_refused) drawn.push_back(i);
  }
  return drawn;
}

/// Columns s_mm and the other, in the order of the curve.
nlohmann::json series(std::vector<PlotPoint> points, const char* value) {
  std::stable_sort(points.begin(), points.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  nlohmann::json json = {{"s_mm", nlohmann::json::array()}, {value, nlohmann::json::array()}};
  for (const PlotPoint& p : points) {
    json["s_mm"].push_back(p.x);
    json[value].push_back(p.y);
  }
  return json;
}

nlohmann::json also(const char* name, const std::vector<PlotPoint>& points) {
  nlohmann::json json = series(points, "value_um");
  json["name"] = name;
  return nlohmann::json::array({json});
}

}  // namespace

nlohmann::json contour_sections_block(const SectionOptions& options, const std::vector<SectionReadings>& sections,
                                      const std::vector<SectionAnswer>& answers) {
  std::vector<std::size_t> order(sections.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const bool along = along_is_stated(sections);
  if (along) {
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return *sections[a].along < *sections[b].along; });
  }
  nlohmann::json block = {
      {"s_mm", nlohmann::json::array()}, {"error_um", nlohmann::json::array()}, {"u_um", nlohmann::json::array()}};
  if (!along) block["counted"] = "section";
  std::vector<PlotPoint> roundings;
  for (const std::size_t i : order) {
    if (!answers[i].ok) continue;
    const double s = along ? *sections[i].along : static_cast<double>(i + 1);
    block["s_mm"].push_back(s);
    block["error_um"].push_back(1e3 * answers[i].error);
    block["u_um"].push_back(1e3 * std::hypot(answers[i].error_uncertainty, options.origin_uncertainty));
    for (const EdgeFit* const edge : answers[i].edges()) roundings.push_back({s, 1e3 * edge->rounding});
  }
  if (!roundings.empty()) block["also"] = also("rounding P1 P2", roundings);
  block["sections"] = nlohmann::json::array();
  for (const std::size_t i : drawn_sections(answers)) {
    block["sections"].push_back(drawn_section(options, sections[i], answers[i]));
  }
  block["sections_in_all"] = sections.size();
  return block;
}

nlohmann::json contour_points_block(const ContourPointsEvaluation& evaluated, bool joined) {
  std::vector<const ContourDeviation*> ordered;
  for (const std::size_t i : evaluated.counted) ordered.push_back(&evaluated.deviations[i]);
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const ContourDeviation* a, const ContourDeviation* b) { return a->along < b->along; });
  std::vector<double> across;
  for (const ContourDeviation* const d : ordered) across.push_back(1e3 * d->across.value());
  std::vector<PlotPoint> errors, heights;
  for (const std::size_t i : thinned(across)) {
    errors.push_back({ordered[i]->along, across[i]});
    heights.push_back({ordered[i]->along, 1e3 * ordered[i]->off.value()});
  }
  nlohmann::json block = series(errors, "error_um");
  block["joined"] = joined;
  block["also"] = also("out of the surface", heights);
  if (errors.size() == across.size()) return block;
  block["points"] = across.size();
  block["bias_um"] = sample_statistics(across).mean;
  for (double& error : across) error = std::abs(error);
  const SampleStatistics amounts = sample_statistics(across);
  block["mean_um"] = amounts.mean;
  block["largest_um"] = amounts.maximum;
  block["standard_deviation_um"] = amounts.deviation;
  return block;
}

}  // namespace abbe
