#include "abbe/report/pages/registration_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/words/registration_words.h"

namespace abbe {
namespace {

EvaluationFigure figure_in_unit(std::string symbol, std::string name, const std::string& unit, int decimals,
                                double value) {
  EvaluationFigure result;
  result.symbol = std::move(symbol);
  result.name = std::move(name);
  result.unit = unit;
  result.decimals = decimals;
  result.value = value;
  return result;
}

void add_pose(const FineRegistration& fine, EvaluationReport& report) {
  static constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    EvaluationFigure place = figure_in_unit(kAxes[k], fmt::format("middle of the scan on the part, {}", kAxes[k]), "mm",
                                            6, fine.reference[k]);
    place.uncertainty = 2 * std::sqrt(std::max(0.0, fine.covariance(3 + k, 3 + k)));
    report.figures.push_back(place);
  }
  for (int k = 0; k < 3; ++k) {
    EvaluationFigure turn = figure_in_unit(fmt::format("U_{}", "ABC"[k]),
                                           fmt::format("expanded uncertainty (k = 2) of the turn about {}", kAxes[k]),
                                           "urad", 3, 2 * std::sqrt(std::max(0.0, fine.covariance(k, k))));
    turn.quantity = Quantity::angle;
    report.figures.push_back(turn);
  }
  report.figures.push_back(
      figure_in_unit("scale", "robust standard deviation of the distances", "um", 3, fine.scale_mm));
  report.figures.push_back(figure_in_unit("rms", "root mean square of the distances, weighted", "um", 3, fine.rms_mm));
  EvaluationTable pose{"Pose: part = rotation * scan + translation", {"", "rotation", "", "", "translation in mm"}, {}};
  for (int row = 0; row < 3; ++row) {
    std::vector<std::string> cells{kAxes[row]};
    for (int k = 0; k < 3; ++k) cells.push_back(fmt::format("{:.9f}", fine.mesh_from_scan.rotation(row, k)));
    cells.push_back(fmt::format("{:.6f}", fine.mesh_from_scan.translation[row]));
    pose.rows.push_back(std::move(cells));
  }
  report.tables.push_back(std::move(pose));
}

}  // namespace

double farthest_shown_mm(const TriangleMesh& part) {
  const Eigen::Vector3d extent = part.vertices.rowwise().maxCoeff() - part.vertices.rowwise().minCoeff();
  return 0.01 * extent.norm();
}

EvaluationReport registration_page(const std::string& title, const Registration& result, const TriangleMesh& part,
                                   const ScanComparison* compared, int threads) {
  const FineRegistration& fine = result.fine;
  EvaluationReport report;
  report.kind = "registration";
  report.title = title;
  report.standard = registration_words(result);
  report.page = nlohmann::json::object();
  if (!has_pose(result) || compared == nullptr) return report;
  add_pose(fine, report);
  report.facts.emplace_back("on the surface", fmt::format("{:.1f} % of the points", 100 * result.inlier_share));
  report.facts.emplace_back("that count", fmt::format("{} points", fine.used));
  for (const std::string& words : undetermined_words(fine)) {
    report.notes.push_back("Not determined by this scan, and not in the uncertainties: " + words + ".");
  }
  if (!result.alternatives.empty()) {
    report.notes.push_back(fmt::format("{} other {} as well; registration.json has them.", result.alternatives.size(),
                                       result.alternatives.size() == 1 ? "pose fits" : "poses fit"));
  }
  const SurfaceDeviation& deviation = compared->deviation;
  report.facts.emplace_back("left out of the picture",
                            fmt::format("{} points beyond the border of the surface, {} farther than {:.3g} mm",
                                        deviation.beyond_border, deviation.too_far, farthest_shown_mm(part)));
  report.page = deviation_page(part, compared->closest, deviation, colour_range_mm(compared->counted_mm), threads);
  return report;
}

}  // namespace abbe
