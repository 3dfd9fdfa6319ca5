#include "abbe/study/report/residual_figures.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

double root_of_ratio(double square, double freedom) { return freedom > 0 ? std::sqrt(square / freedom) : 0; }

}  // namespace

ResidualFigures residual_figures(const Study& study, const StudyResult& result) {
  ResidualFigures figures;
  const Identification& identified = result.identification;
  std::set<std::pair<std::size_t, std::size_t>> outliers;
  double outlier_square = 0, outlier_residuals = 0;
  for (const Outlier& outlier : identified.outliers) {
    outliers.insert({outlier.observations, outlier.reading});
    outlier_square += outlier.norm * outlier.norm;
    outlier_residuals += result.model.problem.observations[outlier.observations].observations->rows();
  }
  figures.outliers = outliers.size();
  figures.residuals = used_residual_count(result.model.problem);
  std::vector<double> all, good;
  for (std::size_t s = 0; s < result.model.problem.observations.size(); ++s) {
    const Observations& observations = *result.model.problem.observations[s].observations;
    const std::vector<std::uint8_t>& use = result.model.problem.observations[s].use;
    for (std::size_t k = 0; k < observations.reading_count(); ++k) {
      if (!use.empty() && use[k] == 0) continue;
      append_length(observations, k, all);
      if (outliers.count({s, k}) == 0) append_length(observations, k, good);
    }
  }
  figures.length = sample_statistics(all);
  figures.length_without_outliers = sample_statistics(good);
  // With a robust loss the chi-square of the fit is that without the outliers.
  const FitStatistics& fit = identified.statistics;
  const bool robust = study.identification->loss != LossKind::none;
  const double sign = robust ? 1 : -1;
  const double other =
      root_of_ratio(fit.chi_square + sign * outlier_square, fit.degrees_of_freedom + sign * outlier_residuals);
  const double stated = root_of_ratio(fit.chi_square, fit.degrees_of_freedom);
  figures.times_noise = robust ? other : stated;
  figures.times_noise_without_outliers = robust ? stated : other;
  return figures;
}

std::string residual_text(const ResidualFigures& figures) {
  const auto line = [](const std::string& name, const SampleStatistics& length, double times) {
    std::string lengths;
    if (length.count > 0) lengths = fmt::format("rms {:.3f}   max {:.3f} um; ", 1e3 * length.rms, 1e3 * length.maximum);
    return fmt::format("  {:<46} {}{:.3g} times the stated uncertainties\n", name, lengths, times);
  };
  const std::string title = "\nresidual of the readings (their noise included; not an error of the machine)\n";
  if (figures.outliers == 0) {
    return title + line("all readings that were used, no outliers", figures.length, figures.times_noise);
  }
  const std::string outliers = fmt::format("{} outlier{}", figures.outliers, figures.outliers == 1 ? "" : "s");
  return title + line("with the " + outliers, figures.length, figures.times_noise) +
         line("without the " + outliers, figures.length_without_outliers, figures.times_noise_without_outliers);
}

nlohmann::ordered_json residual_json(const ResidualFigures& figures) {
  nlohmann::ordered_json json;
  json["residuals"] = figures.residuals;
  json["outliers"] = figures.outliers;
  json["times_stated_uncertainty"] = figures.times_noise;
  json["times_stated_uncertainty_without_outliers"] = figures.times_noise_without_outliers;
  if (figures.length.count > 0) {
    json["length_um"] = statistics_um(figures.length);
    json["length_without_outliers_um"] = statistics_um(figures.length_without_outliers);
  }
  return json;
}

}  // namespace abbe
