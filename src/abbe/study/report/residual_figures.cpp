#include "abbe/study/report/residual_figures.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/study_result.h"

namespace abbe {
namespace {

double root_of_ratio(double square, double freedom) { return freedom > 0 ? std::sqrt(square / freedom) : 0; }

}  // namespace

NoiseFigures noise_figures(const Study& study, const StudyResult& result) {
  NoiseFigures figures;
  const Identification& identified = result.identification;
  double outlier_square = 0, outlier_residuals = 0;
  for (const Outlier& outlier : identified.outliers) {
    outlier_square += outlier.norm * outlier.norm;
    outlier_residuals += result.model.problem.observations[outlier.observations].observations->rows();
  }
  figures.outliers = identified.outliers.size();
  figures.residuals = used_residual_count(result.model.problem);
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

ResidualFigures residual_figures(const Study& study, const StudyResult& result) {
  ResidualFigures figures{noise_figures(study, result), {}, {}};
  std::vector<std::vector<std::uint8_t>> is_outlier;  // [observations][readings]
  for (const SelectedObservations& selected : result.model.problem.observations)
    is_outlier.emplace_back(selected.observations->reading_count());
  for (const Outlier& outlier : result.identification.outliers) is_outlier[outlier.observations][outlier.reading] = 1;
  std::vector<double> all, good;
  for (std::size_t s = 0; s < is_outlier.size(); ++s) {
    const SelectedObservations& selected = result.model.problem.observations[s];
    const std::vector<double> lengths = lengths_by_reading(*selected.observations, study.threads);
    for (std::size_t k = 0; k < lengths.size(); ++k) {
      if (lengths[k] < 0 || (!selected.use.empty() && selected.use[k] == 0)) continue;
      all.push_back(lengths[k]);
      if (is_outlier[s][k] == 0) good.push_back(lengths[k]);
    }
  }
  figures.length = sample_statistics(all);
  figures.length_without_outliers = good.size() == all.size() ? figures.length : sample_statistics(good);
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
