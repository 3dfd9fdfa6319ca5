#include "study/print.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "study/advice.h"
#include "study/coverage.h"
#include "study/found_values_words.h"
#include "study/outlier_list.h"
#include "study/residual_figures.h"
#include "study/summary.h"

namespace abbe {
namespace {

void print_coverage(const ReadingCoverage& found) {
  fmt::print("  {:.1f} % of {} components of held-out readings within two standard uncertainties of the difference\n",
             100 * static_cast<double>(found.components_within) / static_cast<double>(found.components),
             found.components);
  fmt::print("  {:.1f} % of the readings, all components together, in the region of the same probability\n",
             100 * static_cast<double>(found.readings_within) / static_cast<double>(found.readings));
}

void print_unseen(const UnseenPoses& unseen, bool conditional) {
  const bool residual = unseen.quantity == UnseenQuantity::held_out_residual;
  const bool fitted_again = unseen.quantity != UnseenQuantity::volumetric_error;
  fmt::print("\n{}: {}\n", quantity_name(unseen.quantity), unseen.description);
  print_error_line(fitted_again ? "nominal machine, its set-up fitted again" : "before", unseen.before_statistics);
  print_error_line(fitted_again ? "identified machine" : "after", unseen.after_statistics);
  print_error_line(residual ? "expanded uncertainty of the model alone" : "predicted expanded uncertainty",
                   unseen.uncertainty_statistics);
  if (conditional) fmt::print("    (of the {}: see \"not identified\")\n", kIdentifiedErrorsOnly);
  if (unseen.against_truth) {
    fmt::print("  {:.1f} % of the coordinates within two standard uncertainties of the prediction\n",
               100 * unseen.coverage);
  }
  if (unseen.readings && unseen.readings->readings > 0) print_coverage(*unseen.readings);
  if (residual && unseen.times_noise > 0) {
    fmt::print(
        "  {:.3g} times the stated uncertainties of these readings, whose noise is in it: not an error of the "
        "machine\n",
        unseen.times_noise);
  }
}

/// Variances of the readings that were estimated from their residuals.
void print_variances(const VarianceComponents& components) {
  fmt::print("  variances of the readings, by restricted maximum likelihood:\n");
  if (components.estimated.variance_factor) {
    fmt::print("    variance factor of the stated uncertainties {:.4g}, standard uncertainty {:.2g}\n",
               components.variance.factor, components.variance_factor_uncertainty());
  }
  if (components.pose_noise_at_zero) {
    fmt::print("    pose noise: none found; not above {:.3g} um (k = 2)\n", 1e3 * components.pose_noise_uncertainty());
  } else if (components.estimated.pose_noise) {
    fmt::print("    pose noise {:.4g} um in every direction, standard uncertainty {:.2g} um\n",
               1e3 * components.pose_noise(), 1e3 * components.pose_noise_uncertainty());
  }
  fmt::print("    with the uncertainties as stated, chi-square is {:.1f} with {:.0f} degrees of freedom\n",
             components.stated_chi_square, components.stated_degrees_of_freedom);
  if (components.estimated.variance_factor) {
    fmt::print("    (chi-square above is no test: the variance factor makes it what it is)\n");
  }
}

}  // namespace

void print_study(const Study& study, const StudyResult& result, const char* shows_all) {
  fmt::print("{}: {}   ({})\n", study.name, study.machine.name, study.machine.chain());
  if (result.campaign.truth) fmt::print("simulated: the true errors are known\n");
  fmt::print("{} readings\n", result.campaign.reading_count());
  for (const std::string& warning : result.warnings) fmt::print("warning: {}\n", warning);
  for (const Distrust& reason : result.distrusted) fmt::print("not to be trusted: {}\n", reason.text);
  if (!study.identification) return;
  const Identification& identified = result.identification;
  fmt::print("\n{}\n", study_verdict(study, result));
  if (!result.usable()) {
    print_advice(result, shows_all);
    return;
  }
  const FitStatistics& fit = identified.statistics;
  fmt::print("\nidentification: {} after {} iterations, {} outliers\n", status_text(identified.status),
             identified.history.size(), identified.outliers.size());
  fmt::print("  {} parameters, rank {}; {} directions fixed by convention\n", identified.parameters.size(),
             identified.parameters.size() - identified.gauge.constraints.size(), identified.gauge.constraints.size());
  fmt::print("  chi-square {:.1f} with {:.0f} degrees of freedom (probability {:.3f}); observability O1 {:.4g}\n",
             fit.chi_square, fit.degrees_of_freedom, fit.p_value, fit.observability.o1);
  if (result.weighed) print_variances(result.weighed->components);
  if (result.monte_carlo && result.monte_carlo->status == MonteCarloStatus::done) {
    const nlohmann::ordered_json figures = study_summary(study, result)["monte_carlo"];
    fmt::print("  Monte Carlo, {} samples: uncertainties {:.3f} to {:.3f} times those of the covariance\n",
               result.monte_carlo->samples, figures["smallest_uncertainty_ratio"].get<double>(),
               figures["largest_uncertainty_ratio"].get<double>());
  }
  if (result.order_selection && result.order_selection->done) {
    fmt::print("  orders chosen at held-out poses:");
    for (std::size_t g = 0; g < result.order_selection->orders.size(); ++g) {
      fmt::print(" {} {}", result.model.order_groups[g].name, result.order_selection->orders[g]);
    }
    fmt::print("\n");
  }
  const bool conditional = !result.not_identified.errors.empty();
  if (result.volumetric) {
    fmt::print("\n");
    print_volumetric_figures(*result.volumetric, prediction_covers(result));
  }
  print_residual_figures(residual_figures(study, result));
  if (result.unseen && !result.unseen->after.empty()) print_unseen(*result.unseen, conditional);
  std::vector<std::string> ranges = coverage_sentences(study, result);
  if (result.map) ranges.insert(ranges.end(), result.map->moved.begin(), result.map->moved.end());
  if (!ranges.empty()) fmt::print("\nranges\n");
  for (const std::string& sentence : ranges) fmt::print("  {}\n", sentence);
  if (conditional) fmt::print("\nwarning: {}\n", not_identified_text(study, result));
  if (result.unseen && !result.unseen->open.empty())
    fmt::print("\nwarning: {}\n", open_directions_text(*result.unseen));
  print_found_values(found_values(study, result), shows_all);
  print_outliers(study, result, shows_all);
  if (!identified.gauge.constraints.empty()) {
    print_gauge_table(identified);
    if (result.unseen && result.unseen->open_known && result.unseen->open.empty()) {
      fmt::print("  none of these changes the volumetric error other than by the choice of the workpiece datum\n");
    }
  }
  print_advice(result, shows_all);
  print_not_identified(result);
}

}  // namespace abbe
