#include "abbe/study/verification/verified_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/errors/error_states.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/trust/trust.h"
#include "abbe/study/identification/setups_problem.h"
#include "abbe/study/verification/verification_condition.h"
#include "abbe/study/verification/verified_readings_report.h"

namespace abbe {
namespace {

/// Readings with the unknowns of their set-ups fitted, the errors of the machine held.
class FittedSetups {
 public:
  FittedSetups(const ReadingsToVerify& request, const Campaign& campaign, const ErrorSet& errors,
               const std::vector<std::vector<std::uint8_t>>& use)
      : problem_(setups_problem(request.study.machine, errors, campaign.setups, use)) {
    if (estimated_count(problem_) == 0) return;
    IdentifyOptions options;
    options.solver.threads = request.study.threads;
    const Identification fitted = identify(problem_, options);
    if (fitted.converged) return;
    throw InputError({.file = request.study.name}, "its set-ups cannot be fitted to the readings: " + fitted.message,
                     "readings that determine where the instruments stood");
  }

  const Problem& problem() const { return problem_; }

  /// Lengths of measured - modelled of one set-up, [readings], mm; negative: not used, or only angles are read.
  std::vector<double> lengths(std::size_t setup) const {
    const SelectedObservations& selected = problem_.observations[setup];
    std::vector<double> result = lengths_by_reading(*selected.observations);
    for (std::size_t k = 0; k < selected.use.size(); ++k)
      if (selected.use[k] == 0) result[k] = -1;
    return result;
  }

 private:
  Problem problem_;
};

/// Readings of which all axes are where the errors are known.
std::vector<std::uint8_t> covered_readings(const Machine& machine, const ErrorSet& errors, const PoseList& poses) {
  std::vector<std::uint8_t> covered(poses.count(), 1);
  for (std::size_t axis = 0; axis < poses.axis.size(); ++axis) {
    const std::vector<double> positions = positions_of_axis(machine, poses, axis);
    for (std::size_t k = 0; k < covered.size(); ++k) {
      if (!errors.covers(axis, positions[k])) covered[k] = 0;
    }
  }
  return covered;
}

/// Gives one set-up the values of the request for states that its readings do not give.
void give_states(const ReadingsToVerify& request, CampaignSetup& setup) {
  const Machine& machine = request.study.machine;
  PoseList& poses = setup.readings.poses;
  for (std::size_t j = 0; j < request.states.size(); ++j) {
    if (!std::isfinite(request.states[j])) continue;
    const std::string column = state_column(machine.states[j]);
    if (j < poses.state.size() && !poses.state[j].empty()) {
      throw InputError({.field = "--state " + column}, "the readings of '" + setup.name + "' have this state",
                       "an option only for states that the readings do not give");
    }
    poses.state.resize(machine.states.size());
    poses.state[j].assign(poses.count(), request.states[j]);
  }
}

/// Every reading gets its state; says where that is unknown or beyond what the errors were measured at.
void take_states(const ReadingsToVerify& request, Campaign& campaign, VerifiedReadings& result) {
  const Machine& machine = request.study.machine;
  const ErrorSet& errors = request.identified.errors;
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  for (CampaignSetup& setup : campaign.setups) {
    give_states(request, setup);
    const std::size_t missing = missing_state(machine, errors, setup.poses());
    if (missing != kNoState) {
      const std::string column = state_column(machine.states[missing]);
      throw InputError(
          {.file = setup.name},
          fmt::format("the errors depend on {}, which is not given at all readings", machine.states[missing].name),
          fmt::format("a column {} in the readings, a channel, or --state {}=VALUE", column, column));
    }
    for (std::size_t j = 0; j < used.size(); ++j) {
      if (used[j] == 0 || machine.states[j].kind != StateKind::approach || !setup.poses().approach.empty()) continue;
      result.warnings.push_back(
          fmt::format("{}: the readings do not say from which side {} came: the mean of both sides is used", setup.name,
                      machine.axes[machine.states[j].axis].name));
    }
    for (const std::string& sentence : states_outside_covered(machine, request.identified, setup.poses()))
      result.outside.push_back(setup.name + ": " + sentence);
  }
  result.warnings.insert(result.warnings.end(), result.outside.begin(), result.outside.end());
}

void judge(const ReadingsToVerify& request, VerifiedReadings& result) {
  const auto add = [&](const char* name, bool met, std::string text) {
    result.verdicts.push_back({name, std::move(text), met});
  };
  if (!result.after.empty()) {
    const bool met = result.after_statistics.rms < result.before_statistics.rms;
    add("improvement", met,
        fmt::format("the identified errors {} the residuals smaller", met ? "make" : "do NOT make"));
  }
  const IndependentReadings& judged = result.judged;
  if (judged.degrees_of_freedom > 0) {
    const bool met = judged.p_value >= kNoChance;
    add("consistency", met,
        fmt::format("the uncertainties of the readings{} {} what is left (chi-square {:.1f} with {:.0f} degrees of "
                    "freedom, probability {})",
                    result.uncertainties_known ? " and of the errors" : " alone", met ? "explain" : "do NOT explain",
                    judged.chi_square, judged.degrees_of_freedom,
                    judged.p_value < kNoChance ? std::string("below 1e-06") : fmt::format("{:.2g}", judged.p_value)));
  }
  if (request.least_reduction) {
    const bool met = result.reduction() >= *request.least_reduction;
    add("reduction", met,
        result.after.empty()
            ? std::string("NOT known, because only angles are read")
            : fmt::format("the mean residual becomes {:.1f} times smaller: {} the required {:g} times",
                          result.reduction(), met ? "at least" : "LESS than", *request.least_reduction));
  }
  if (request.largest_ratio) {
    const bool met = result.ratio() > 0 && result.ratio() <= *request.largest_ratio;
    add("ratio", met,
        !(judged.degrees_of_freedom > 0)
            ? std::string("NOT known, because there are no more readings than unknowns of the set-ups")
            : fmt::format("what is left is {:.2f} times what the uncertainties explain: {} the permitted {:g} times",
                          result.ratio(), met ? "within" : "ABOVE", *request.largest_ratio));
  }
}

}  // namespace

double VerifiedReadings::reduction() const {
  return after_statistics.mean > 0 ? before_statistics.mean / after_statistics.mean : 0;
}

double VerifiedReadings::ratio() const {
  return judged.degrees_of_freedom > 0 ? std::sqrt(judged.chi_square / judged.degrees_of_freedom) : 0;
}

LeftOutPoses VerifiedReadings::left_out() const {
  return {.all = readings, .not_covered = not_covered, .what = "readings", .extrapolated = outside};
}

bool VerifiedReadings::says_no() const {
  return std::any_of(verdicts.begin(), verdicts.end(), [](const ReadingsVerdict& verdict) { return !verdict.met; });
}

VerifiedReadings verify_readings(const ReadingsToVerify& request, const JobOptions& options) {
  require_condition("--least-reduction", request.least_reduction);
  require_condition("--largest-ratio", request.largest_ratio);
  const auto progress = stoppable_progress(options);
  constexpr std::size_t kSteps = 3;
  progress(0, kSteps);
  Campaign campaign = gather_readings(request.study, {.stop = options.stop});
  find_start_values(request.study.machine, campaign);

  VerifiedReadings result;
  take_states(request, campaign, result);
  const ErrorSet& identified = request.identified.errors;
  std::vector<std::vector<std::uint8_t>> use;
  for (const CampaignSetup& setup : campaign.setups) {
    use.push_back(covered_readings(request.study.machine, identified, setup.poses()));
    result.readings += use.back().size();
    result.not_covered += static_cast<std::size_t>(std::count(use.back().begin(), use.back().end(), 0));
  }
  if (result.not_covered == result.readings) {
    throw InputError({.file = request.study.name}, "no reading is where all errors are known",
                     "readings within the ranges of the error motions in " + request.errors_file);
  }
  result.warnings.insert(result.warnings.begin(), campaign.warnings.begin(), campaign.warnings.end());
  progress(1, kSteps);
  const FittedSetups nominal(request, campaign, ErrorSet{}, use);
  progress(2, kSteps);
  const FittedSetups compensated(request, campaign, identified, use);
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    const SetupResiduals& setup =
        result.setups.emplace_back(SetupResiduals{campaign.setups[s].name, nominal.lengths(s), compensated.lengths(s)});
    for (std::size_t k = 0; k < setup.after.size(); ++k) {
      if (setup.after[k] < 0) continue;
      result.before.push_back(setup.before[k]);
      result.after.push_back(setup.after[k]);
    }
  }
  result.before_statistics = sample_statistics(result.before);
  result.after_statistics = sample_statistics(result.after);
  Eigen::MatrixXd covariance = covariance_of(request.identified);
  result.uncertainties_known = covariance.size() > 0;
  if (!result.uncertainties_known) {
    const auto count = static_cast<Eigen::Index>(identified.parameter_count());
    covariance = Eigen::MatrixXd::Zero(count, count);
  }
  result.judged = judge_independent_readings(compensated.problem(), covariance, request.study.threads);
  judge(request, result);
  write_readings_report(request, campaign, result);
  progress(kSteps, kSteps);
  return result;
}

}  // namespace abbe
