#include "abbe/verify/parts/contour_sections.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

std::vector<const EdgeFit*> SectionAnswer::edges() const {
  if (!groove) return {&first};
  return {&first, &second};
}

SectionAnswer evaluate_section(const SectionReadings& section, const SectionOptions& options) {
  EdgeOptions edge = options.edge;
  if (section.beam_tilt) edge.beam_tilt = *section.beam_tilt;
  SectionAnswer answer;
  answer.name = section.name;
  answer.along = section.along;
  answer.groove = options.groove;
  if (options.groove) {
    const GrooveFit groove = fit_groove(section.points, edge);
    answer.first = groove.left;
    answer.second = groove.right;
    answer.ok = groove.ok();
    if (groove.left.status != EdgeStatus::ok) answer.reason = "left edge: " + groove.left.reason;
    if (groove.left.status == EdgeStatus::ok) answer.reason = "right edge: " + groove.right.reason;
    answer.error = groove.middle;
    answer.error_uncertainty = groove.middle_uncertainty;
    answer.width = groove.width;
  } else {
    answer.first = fit_edge(section.points, edge);
    answer.ok = answer.first.status == EdgeStatus::ok;
    answer.reason = answer.first.reason;
    answer.error = answer.first.corner.x();
    answer.error_uncertainty = answer.first.corner_uncertainty();
  }
  return answer;
}

SectionsEvaluation evaluate_sections(const std::vector<SectionReadings>& sections, const SectionOptions& options) {
  SectionsEvaluation result;
  std::vector<double> errors, uncertainties, roundings, rounding_uncertainties, radii;
  result.largest = sections.size();
  for (const SectionReadings& section : sections) {
    SectionAnswer answer = evaluate_section(section, options);
    if (answer.ok) {
      errors.push_back(answer.error);
      uncertainties.push_back(answer.error_uncertainty);
      const bool first = result.largest == sections.size();
      if (first || std::abs(answer.error) > std::abs(result.answers[result.largest].error)) {
        result.largest = result.answers.size();
      }
      for (const EdgeFit* const edge : answer.edges()) {
        roundings.push_back(edge->rounding);
        rounding_uncertainties.push_back(edge->rounding_uncertainty);
        radii.push_back(edge->radius);
      }
    } else {
      ++result.refused;
    }
    result.answers.push_back(std::move(answer));
  }
  result.contour = contour_figures(errors, uncertainties, options.origin_uncertainty);
  result.rounding = contour_figures(roundings, rounding_uncertainties);
  if (!radii.empty()) result.radius = sample_statistics(radii).mean;
  return result;
}

bool along_is_stated(const std::vector<SectionReadings>& sections) {
  return std::all_of(sections.begin(), sections.end(), [](const SectionReadings& s) { return s.along.has_value(); });
}

ContourPointsEvaluation evaluate_contour_points(const std::vector<CommandPiece>& pieces, const Eigen::Matrix3Xd& points,
                                                double common) {
  ContourPointsEvaluation result;
  result.deviations = contour_deviations(pieces, points);
  std::vector<double> distances, across, off;
  for (std::size_t i = 0; i < result.deviations.size(); ++i) {
    const ContourDeviation& d = result.deviations[i];
    if (d.beyond_end) {  // no distance across the curve
      ++result.beyond;
      continue;
    }
    distances.push_back(d.distance);
    if (!d.across || !d.off) {
      ++result.undirected;
      continue;
    }
    across.push_back(*d.across);
    off.push_back(*d.off);
    result.counted.push_back(i);
  }
  result.across = contour_figures(across, {}, common);
  result.off = contour_figures(off);
  result.distance = contour_figures(distances, {}, common);
  return result;
}

}  // namespace abbe
