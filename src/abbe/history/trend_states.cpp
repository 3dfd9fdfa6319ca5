#include "abbe/history/trend_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/moved_references.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

constexpr double kSecondsPerDay = 86400;

/// A measured or lag state on which errors depend, and where they are taken.
struct ChosenState {
  MachineState state;  ///< as the newest campaign has it
  double value = 0;
};

/// The given states that the errors of any campaign use, the newest campaign first.
std::vector<MachineState> states_in_use(const std::vector<IdentifiedCampaign>& campaigns) {
  std::vector<MachineState> states;
  for (auto campaign = campaigns.rbegin(); campaign != campaigns.rend(); ++campaign) {
    const std::vector<std::uint8_t> used = used_states(campaign->machine, campaign->errors.errors);
    for (std::size_t j = 0; j < used.size(); ++j) {
      const MachineState& state = campaign->machine.states[j];
      const bool is_known =
          std::any_of(states.begin(), states.end(), [&](const MachineState& one) { return one.name == state.name; });
      if (used[j] != 0 && is_input(state.kind) && !is_known) states.push_back(state);
    }
  }
  return states;
}

/// Every state of any campaign that can be given, so that --state may name one on which no errors depend.
Machine machine_with_all_states(const std::vector<IdentifiedCampaign>& campaigns) {
  Machine machine;
  for (auto campaign = campaigns.rbegin(); campaign != campaigns.rend(); ++campaign) {
    for (const MachineState& state : campaign->machine.states) {
      if (find_state(machine, state.name) == kNoState) machine.states.push_back(state);
    }
  }
  return machine;
}

std::vector<ChosenState> chosen_states(const std::vector<IdentifiedCampaign>& campaigns,
                                       const std::vector<std::string>& texts) {
  const Machine all = machine_with_all_states(campaigns);
  const std::vector<double> given = state_options(all, "--state", texts);
  std::vector<ChosenState> chosen;
  for (const MachineState& state : states_in_use(campaigns)) {
    const double value = given[find_state(all, state.name)];
    chosen.push_back({state, std::isfinite(value) ? value : state.reference});
  }
  return chosen;
}

/// [states of the machine], NaN where nothing is chosen. A state of another unit keeps its reference: the comparison
/// refuses it by name.
std::vector<double> values_on(const Machine& machine, const std::vector<ChosenState>& chosen) {
  std::vector<double> values(machine.states.size(), std::numeric_limits<double>::quiet_NaN());
  for (const ChosenState& one : chosen) {
    const std::size_t j = find_state(machine, one.state.name);
    if (j != kNoState && is_input(machine.states[j].kind) && machine.states[j].unit == one.state.unit) {
      values[j] = one.value;
    }
  }
  return values;
}

bool is_outside(const Machine& machine, const ErrorsFile& file, std::size_t state, double value) {
  return std::isfinite(value) &&
         std::any_of(file.covered.begin(), file.covered.end(), [&](const CoveredState& covered) {
           return covered.column == state_column(machine.states[state]) && !covered.contains(value);
         });
}

/// Names of errors whose value at the state is an extrapolation.
std::vector<std::string> extrapolated_errors(const IdentifiedCampaign& campaign, const std::vector<double>& values) {
  const Machine& machine = campaign.machine;
  std::vector<std::string> names;
  const auto depends_on_outside = [&](std::size_t state) {
    if (state == kNoState) return false;
    const MachineState& one = machine.states.at(state);
    const auto outside = [&](std::size_t j) { return is_outside(machine, campaign.errors, j, values[j]); };
    return one.kind == StateKind::product ? outside(one.first) || outside(one.second) : outside(state);
  };
  for (const ErrorMotion& motion : campaign.errors.errors.motions) {
    if (depends_on_outside(motion.state)) names.push_back(error_motion_name(machine, motion.axis, motion.component));
  }
  for (const LocationError& location : campaign.errors.errors.locations) {
    if (!depends_on_outside(location.state)) continue;
    names.push_back(location_error_name(machine, location.axis, location.component));
  }
  return names;
}

void bring_to(IdentifiedCampaign& campaign, const std::vector<double>& values) {
  ErrorsFile& file = campaign.errors;
  const bool moves = [&] {
    for (std::size_t j = 0; j < values.size(); ++j) {
      if (std::isfinite(values[j]) && values[j] != campaign.machine.states[j].reference) return true;
    }
    return false;
  }();
  if (!moves) return;
  // Standard uncertainties alone would become correlated.
  if (file.covariance.size() == 0) file.covariance = stated_variances(file.errors);
  Eigen::MatrixXd by_parameters;
  file.errors = with_references(campaign.machine, file.errors, values, &by_parameters);
  if (file.covariance.size() > 0) file.covariance = by_parameters * file.covariance * by_parameters.transpose();
  campaign.machine = with_references(campaign.machine, values);
}

}  // namespace

CampaignsAtState campaigns_at_state(std::vector<IdentifiedCampaign> campaigns, const std::vector<std::string>& states) {
  CampaignsAtState result;
  const std::vector<ChosenState> chosen = chosen_states(campaigns, states);
  for (const ChosenState& one : chosen) result.at_state.emplace_back(state_column(one.state), one.value);
  for (IdentifiedCampaign& campaign : campaigns) {
    if (!chosen.empty()) {
      const std::vector<double> values = values_on(campaign.machine, chosen);
      for (const std::string& sentence : values_outside_covered(campaign.machine, campaign.errors, values))
        result.at_state.outside.push_back(campaign.name + ": " + sentence);
      result.extrapolated.push_back(extrapolated_errors(campaign, values));
      bring_to(campaign, values);
    }
  }
  result.campaigns = std::move(campaigns);
  return result;
}

double wander_per_day(const IdentifiedCampaign& campaign, const std::string& error, std::optional<double> at) {
  const ErrorAgeing& ageing = campaign.errors.ageing;
  if (!ageing.any()) return 0;
  const Machine& machine = campaign.machine;
  double sum = 0;  // of squared functions, per coefficient that wanders
  bool is_angle = false;
  for (const ErrorMotion& motion : campaign.errors.errors.motions) {
    if (!at || motion.state != kNoState || error_motion_name(machine, motion.axis, motion.component) != error) continue;
    std::vector<double> functions(motion.coefficients.size());
    motion.basis.values(*at, motion.coefficients, functions);
    for (const double value : functions) sum += value * value;
    is_angle = is_rotation(motion.component);
  }
  for (const LocationError& location : campaign.errors.errors.locations) {
    if (location.state != kNoState || location_error_name(machine, location.axis, location.component) != error)
      continue;
    sum += 1;
    is_angle = is_rotation(location.component);
  }
  for (const Reversal& reversal : campaign.errors.errors.reversals) {
    if (reversal_name(machine, reversal.axis) != error) continue;
    sum += 1;
    is_angle = machine.axes[reversal.axis].kind == AxisKind::rotary;
  }
  const double intensity = is_angle ? ageing.angle : ageing.length;
  return kSecondsPerDay * intensity * intensity * sum;
}

}  // namespace abbe
