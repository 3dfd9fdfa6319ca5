#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/machine_json.h"
#include "abbe/report/pages/scan_plan_page.h"
#include "abbe/verify/evaluations/statistics.h"
#include "liu/results.h"

namespace abbe {
namespace {

constexpr std::size_t kDrawnDistances = 4000;

std::vector<double> amounts_um(const LiuDeviation& deviation) {
  std::vector<double> amounts;
  for (const double distance : deviation.distances) amounts.push_back(1e3 * std::abs(distance));
  return amounts;
}

nlohmann::json thinned_for_drawing(const std::vector<double>& values) {
  const std::size_t every = 1 + values.size() / kDrawnDistances;
  nlohmann::json kept = nlohmann::json::array();
  for (std::size_t i = 0; i < values.size(); i += every) kept.push_back(for_drawing(values[i]));
  return kept;
}

nlohmann::json percentiles_of(const std::vector<double>& values) {
  return {{"median", percentile(values, 0.5)}, {"p95", percentile(values, 0.95)}};
}

/// Distances of the measured points from the part before and after the compensation.
nlohmann::json distances_histogram(const LiuMeasuredPart& part) {
  const std::vector<double> before = amounts_um(part.measurement.before), after = amounts_um(part.measurement.after);
  return {{"title", part.model.name + ", measured points"},
          {"quantity", "distance from the part"},
          {"of", "points"},
          {"before_um", thinned_for_drawing(before)},
          {"after_um", thinned_for_drawing(after)},
          {"before_percentiles_um", percentiles_of(before)},
          {"after_percentiles_um", percentiles_of(after)}};
}

}  // namespace

nlohmann::json liu_page(const LiuResults& r) {
  nlohmann::json page;
  page["machine"] = nlohmann::json(report_machine(r.machine));
  const auto unit = std::find_if(r.units.begin(), r.units.end(),
                                 [](const LiuUnitResults& results) { return results.unit == LiuUnit::micrometre; });
  if (unit == r.units.end() || unit->parts.empty()) return page;
  const LiuMeasuredPart& part = unit->parts.front();
  const nlohmann::json plan =
      scan_plan_page_data(r.machine, part.model.mesh, part.plan,
                          liu_plan_options(part.model, liu_clamping(LiuUnit::micrometre)), part.model.name);
  for (const char* const key : {"path", "surface"}) {
    if (plan.contains(key)) page[key] = plan[key];
  }
  if (page.contains("path")) page["path"]["title"] = "Path of the probe over the " + part.model.name;
  page["histograms"] = nlohmann::json::array();
  for (const LiuMeasuredPart& measured : unit->parts) {
    if (measured.measurement.before.points > 0 && measured.measurement.after.points > 0) {
      page["histograms"].push_back(distances_histogram(measured));
    }
  }
  const LiuMeasurement& m = part.measurement;
  page["summary"]["verdict"] = fmt::format(
      "The {} with the errors of Table 3 (shifts in um): {:.2f} um before compensation, {:.2f} um after, root mean "
      "squares{}.",
      part.model.name, 1e3 * m.before.rms, 1e3 * m.after.rms,
      part.paper_before > 0 && part.paper_after > 0
          ? fmt::format("; the paper states {:.2f} um and {:.2f} um", part.paper_before, part.paper_after)
          : "");
  return page;
}

}  // namespace abbe
