#include "abbe/study/report/study_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/words/volumetric_words.h"
#include "abbe/study/identification/drift_words.h"
#include "abbe/study/identification/streamed_identification.h"
#include "abbe/study/report/advice.h"
#include "abbe/study/report/coverage.h"
#include "abbe/study/report/found_values_words.h"
#include "abbe/study/report/outlier_list.h"
#include "abbe/study/report/residual_figures.h"
#include "abbe/study/report/summary.h"

namespace abbe {
namespace {

std::string coverage_text(const ReadingCoverage& found) {
  std::string text = fmt::format(
      "  {:.1f} % of {} components of held-out readings within two standard uncertainties of the difference\n",
      100 * static_cast<double>(found.components_within) / static_cast<double>(found.components), found.components);
  text += fmt::format("  {:.1f} % of the readings, all components together, in the region of the same probability\n",
                      100 * static_cast<double>(found.readings_within) / static_cast<double>(found.readings));
  return text;
}

std::string unseen_text(const UnseenPoses& unseen, bool conditional) {
  std::string text;
  const bool residual = unseen.quantity == UnseenQuantity::held_out_residual;
  const bool fitted_again = unseen.quantity != UnseenQuantity::volumetric_error;
  text += fmt::format("\n{}: {}\n", quantity_name(unseen.quantity), unseen.description);
  text += error_line(fitted_again ? "nominal machine, its set-up fitted again" : "before", unseen.before_statistics);
  text += error_line(fitted_again ? "identified machine" : "after", unseen.after_statistics);
  text += error_line(residual ? "expanded uncertainty of the model alone" : "predicted expanded uncertainty",
                     unseen.uncertainty_statistics);
  if (conditional) text += fmt::format("    (of the {}: see \"not identified\")\n", kIdentifiedErrorsOnly);
  if (unseen.against_truth) {
    text += fmt::format("  {:.1f} % of the coordinates within two standard uncertainties of the prediction\n",
                        100 * unseen.coverage);
  }
  if (unseen.readings && unseen.readings->readings > 0) text += coverage_text(*unseen.readings);
  if (residual && unseen.times_noise > 0) {
    text += fmt::format(
        "  {:.3g} times the stated uncertainties of these readings, whose noise is in it: not an error of the "
        "machine\n",
        unseen.times_noise);
  }
  return text;
}

const char* common_noise_words(const VarianceComponents& components) {
  return components.estimated.by_block ? "noise common to a block of time" : "pose noise";
}

/// Variances of the readings that were estimated from their residuals.
std::string variances_text(const VarianceComponents& components) {
  std::string text = "  variances of the readings, by restricted maximum likelihood:\n";
  if (components.estimated.variance_factor) {
    text += fmt::format("    variance factor of the stated uncertainties {:.4g}, standard uncertainty {:.2g}\n",
                        components.variance.factor, components.variance_factor_uncertainty());
  }
  if (components.pose_noise_at_zero) {
    text += fmt::format("    {}: none found; not above {:.3g} um (k = 2)\n", common_noise_words(components),
                        1e3 * components.pose_noise_uncertainty());
  } else if (components.estimated.pose_noise) {
    text += fmt::format("    {} {:.4g} um in every direction, standard uncertainty {:.2g} um\n",
                        common_noise_words(components), 1e3 * components.pose_noise(),
                        1e3 * components.pose_noise_uncertainty());
  }
  text += fmt::format("    with the uncertainties as stated, chi-square is {:.1f} with {:.0f} degrees of freedom\n",
                      components.stated_chi_square, components.stated_degrees_of_freedom);
  if (components.estimated.variance_factor) {
    text += "    (chi-square above is not a test: the variance factor makes it what it is)\n";
  }
  return text;
}

}  // namespace

std::string study_text(const Study& study, const StudyResult& result, const char* shows_all) {
  std::string text = fmt::format("{}: {}   ({})\n", study.name, study.machine.name, study.machine.chain());
  if (result.campaign.truth) text += "simulated: the true errors are known\n";
  text += fmt::format("{} readings\n", all_reading_count(result.campaign));
  for (const std::string& warning : result.warnings) text += fmt::format("warning: {}\n", warning);
  for (const Distrust& reason : result.distrusted) text += fmt::format("not to be trusted: {}\n", reason.text);
  if (!study.identification) return text;
  const Identification& identified = result.identification;
  text += fmt::format("\n{}\n", study_verdict(study, result));
  if (!result.usable()) {
    text += advice_text(result, shows_all);
    return text;
  }
  const FitStatistics& fit = identified.statistics;
  text += fmt::format("\nidentification: {} after {} iterations, {} outliers\n", status_text(identified.status),
                      identified.history.size(), identified.outliers.size());
  text += fmt::format("  {} parameters, rank {}; {} directions fixed by convention\n", identified.parameters.size(),
                      identified.parameters.size() - identified.gauge.constraints.size(),
                      identified.gauge.constraints.size());
  text +=
      fmt::format("  chi-square {:.1f} with {:.0f} degrees of freedom (probability {:.3f}); observability O1 {:.4g}\n",
                  fit.chi_square, fit.degrees_of_freedom, fit.p_value, fit.observability.o1);
  if (result.weighed) text += variances_text(result.weighed->components);
  if (result.monte_carlo && result.monte_carlo->status == MonteCarloStatus::done) {
    const nlohmann::ordered_json figures = study_summary(study, result)["monte_carlo"];
    text += fmt::format("  Monte Carlo, {} samples: uncertainties {:.3f} to {:.3f} times those of the covariance\n",
                        result.monte_carlo->samples, figures["smallest_uncertainty_ratio"].get<double>(),
                        figures["largest_uncertainty_ratio"].get<double>());
  }
  if (result.terms) text += chosen_terms_text(*result.terms);
  if (result.sensors) text += ranked_sensors_text(*result.sensors);
  if (result.order_selection && result.order_selection->done) {
    text += "  orders chosen at held-out poses:";
    for (std::size_t g = 0; g < result.order_selection->orders.size(); ++g) {
      text += fmt::format(" {} {}", result.model.order_groups[g].name, result.order_selection->orders[g]);
    }
    text += "\n";
  }
  const bool conditional = !result.not_identified.errors.empty();
  if (result.volumetric) {
    text += "\n";
    text += volumetric_text(*result.volumetric, prediction_covers(result));
  }
  text += residual_text(residual_figures(study, result));
  if (result.unseen && !result.unseen->after.empty()) text += unseen_text(*result.unseen, conditional);
  std::vector<std::string> ranges = coverage_sentences(study, result);
  if (result.map) ranges.insert(ranges.end(), result.map->moved.begin(), result.map->moved.end());
  if (!ranges.empty()) text += "\nranges\n";
  for (const std::string& sentence : ranges) text += fmt::format("  {}\n", sentence);
  if (conditional) text += fmt::format("\nwarning: {}\n", not_identified_text(study, result));
  if (result.unseen && !result.unseen->open.empty())
    text += fmt::format("\nwarning: {}\n", open_directions_text(*result.unseen));
  text += found_values_text(found_values(study, result), shows_all);
  text += drift_text(result);
  text += outliers_text(study, result, shows_all);
  if (!identified.gauge.constraints.empty()) {
    text += gauge_table_text(identified);
    if (result.unseen && result.unseen->open_known && result.unseen->open.empty()) {
      text += "  none of these changes the volumetric error other than by the choice of the workpiece datum\n";
    }
  }
  text += advice_text(result, shows_all);
  text += not_identified_remedies_text(result);
  return text;
}

std::string parameters_text(const StudyResult& result) {
  const Identification& identified = result.identification;
  std::string text = fmt::format("{:<24} {:>16} {:>16}\n", "parameter", "value", "u");
  for (std::size_t p = 0; p < identified.parameters.size(); ++p) {
    const bool angle = identified.parameters[p].is_angle, pure = identified.parameters[p].is_pure_number;
    const double unit = pure ? kPurePerUnit : micro_per_unit(angle);
    const auto at = static_cast<Eigen::Index>(p);
    text +=
        fmt::format("{:<24} {:>16.4f} {:>16.4f} {}\n", identified.parameters[p].name, unit * identified.estimates[at],
                    unit * identified.standard_uncertainties[at], pure ? kPureUnit : micro_unit(angle));
  }
  return text;
}

}  // namespace abbe
