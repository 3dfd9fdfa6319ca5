#include "abbe/study/identification/trust.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/identify/trust/outlier_clusters.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/identify/trust/repeated_readings.h"
#include "abbe/study/identification/state_ranges.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/study_result.h"

namespace abbe {
namespace {

/// Less than chance, but not enough to refuse the result: worth telling.
constexpr double kHardlyChance = 1e-4;
/// Smaller probabilities are reported as below this value.
constexpr double kLeastTold = 1e-300;

std::string warning_of_poor_fit(const FitStatistics& fit) {
  if (!(fit.degrees_of_freedom > 0) || !(fit.variance_factor > 1) || !(fit.p_value < kHardlyChance)) return {};
  return fmt::format(
      "the residuals are {:.3g} times as large as the stated uncertainties of the readings explain (chi-square "
      "probability {:.1e}): the model lacks errors that the readings show, or the readings are less certain than "
      "stated. The stated uncertainties of the result are too small.",
      std::sqrt(fit.variance_factor), fit.p_value);
}

/// The covariance scaled to the residuals of the fit: noise stated too large or too small hides nothing, and refuses
/// nothing.
HeldOutErrors held_out_errors(const UnseenPoses& unseen, const FitStatistics& fit) {
  HeldOutErrors errors{.before = unseen.before,
                       .after = unseen.after,
                       .readings = !unseen.against_truth,
                       .numbers = static_cast<double>(unseen.numbers),
                       .fitted_before = static_cast<double>(unseen.fitted_before)};
  for (const double expanded : unseen.expanded_uncertainty) errors.predicted_square += 0.25 * expanded * expanded;
  if (fit.variance_factor > 0) errors.predicted_square *= fit.variance_factor;
  return errors;
}

std::vector<ReadingFacts> facts_of(const Campaign& campaign) {
  std::vector<ReadingFacts> facts;
  for (const CampaignSetup& setup : campaign.setups) facts.push_back(setup.facts());
  return facts;
}

/// Outliers that stand together: the first three places, the most significant first.
void judge_outliers(const std::vector<ReadingFacts>& facts, bool robust, StudyResult& result) {
  constexpr std::size_t kMostTold = 3;
  std::vector<OutlierCluster> clusters = outlier_clusters(result.model.problem, result.identification.outliers, facts);
  if (clusters.size() > kMostTold) clusters.resize(kMostTold);
  for (const OutlierCluster& cluster : clusters) {
    const std::string text = cluster_text(cluster);
    if (robust && cluster.is_region_left_out()) {
      result.distrusted.push_back(
          {DistrustKind::region_left_out,
           text + ": the robust loss leaves a whole region out, of which the result says nothing",
           {{"readings", static_cast<double>(cluster.readings)},
            {"outliers", static_cast<double>(cluster.outliers)},
            {"readings_elsewhere", static_cast<double>(cluster.readings_elsewhere)},
            {"outliers_elsewhere", static_cast<double>(cluster.outliers_elsewhere)},
            {"probability", cluster.probability()}}});
    } else {
      const std::string chance = cluster.probability() < kLeastTold
                                     ? fmt::format(" (by chance with a probability below {:.0e})", kLeastTold)
                                     : fmt::format(" (by chance with a probability of {:.1e})", cluster.probability());
      result.warnings.push_back("outliers are clustered: " + text + chance +
                                ". Something was different there, or the model does not hold.");
    }
  }
}

}  // namespace

void judge_trust(const Study& study, StudyResult& result) {
  const Identification& identified = result.identification;
  if (!result.usable()) {
    // What stands apart may be what keeps it from converging.
    if (!identified.outliers.empty()) judge_outliers(facts_of(result.campaign), false, result);
    return;
  }
  const auto doubt = [&](std::optional<Distrust> found) {
    if (found) result.distrusted.push_back(std::move(*found));
  };
  const auto warn = [&](std::string text) {
    if (!text.empty()) result.warnings.push_back(std::move(text));
  };
  std::optional<Distrust> misfit = distrust_of_fit(identified.statistics);
  if (!misfit) warn(warning_of_poor_fit(identified.statistics));
  warn(warning_of_overstated_noise(identified.statistics));
  doubt(std::move(misfit));
  if (result.unseen && !result.unseen->after.empty()) {
    doubt(distrust_of_held_out(held_out_errors(*result.unseen, identified.statistics)));
  }
  const std::vector<ReadingFacts> facts = facts_of(result.campaign);
  judge_outliers(facts, study.identification->loss != LossKind::none, result);
  for (std::size_t s = 0; s < facts.size(); ++s) {
    const RepeatedReadings repeated = repeated_readings(*result.model.problem.observations[s].observations, facts[s]);
    if (repeated.are_copies()) warn(copies_text(repeated, facts[s]));
  }
  for (Distrust& size : distrust_of_sizes(study.machine, identified.errors))
    result.distrusted.push_back(std::move(size));
}

std::vector<std::string> study_warnings(const Study& study, const StudyResult& result) {
  std::vector<std::string> warnings = result.warnings;
  if (result.unseen && !result.unseen->open.empty()) warnings.push_back(open_directions_text(*result.unseen));
  if (!result.not_identified.errors.empty()) warnings.push_back(not_identified_text(study, result));
  return warnings;
}

std::string distrust_kinds(const StudyResult& result) {
  std::string kinds;
  for (const Distrust& reason : result.distrusted) {
    const std::string kind = kind_text(reason.kind);
    if (kinds.find(kind) == std::string::npos) kinds += (kinds.empty() ? "" : ", ") + kind;
  }
  return kinds;
}

nlohmann::ordered_json distrust_json(const StudyResult& result) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Distrust& reason : result.distrusted) {
    nlohmann::ordered_json entry = {{"kind", kind_text(reason.kind)}, {"text", reason.text}};
    for (const auto& [name, value] : reason.numbers) entry[name] = value;
    list.push_back(entry);
  }
  return list;
}

ErrorsFile identified_errors_file(const Study& study, const StudyResult& result) {
  ErrorsFile file;
  file.errors = result.identification.errors;
  file.covariance = machine_covariance(result.identification, file.errors.parameter_count());
  for (const Distrust& reason : result.distrusted) file.distrusted.push_back(reason.text);
  file.misfit_accepted = result.misfit_accepted && !result.distrusted.empty();
  file.warnings = study_warnings(study, result);
  file.covered = covered_states(study, result);
  file.covered_time_s = covered_time_s(result);
  file.ageing = {study.identification->ageing_length, study.identification->ageing_angle};
  return file;
}

bool says_no(const Study& study, const StudyResult& result) {
  if (!study.identification) return !result.campaign.is_explained() && !result.misfit_accepted;
  return !result.usable() || (!result.distrusted.empty() && !result.misfit_accepted);
}

}  // namespace abbe
