#include "abbe/study/common_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>

#include "abbe/errors/error_states.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

/// Names of the states that the errors of any campaign use.
std::set<std::string> names_in_use(const std::vector<IdentifiedCampaign>& campaigns) {
  std::set<std::string> names;
  for (const IdentifiedCampaign& campaign : campaigns) {
    const std::vector<std::uint8_t> used = used_states(campaign.machine, campaign.errors.errors);
    for (std::size_t j = 0; j < used.size(); ++j) {
      if (used[j] != 0) names.insert(campaign.machine.states[j].name);
    }
  }
  return names;
}

std::string name_of(const Machine& machine, std::size_t state) {
  return state == kNoState ? std::string() : machine.states[state].name;
}

/// In what the definitions of a state differ, in words; empty: they are the same. The axes of both are the same.
std::string difference(const Machine& machine, const MachineState& a, const Machine& other, const MachineState& b) {
  if (a.kind != b.kind) {
    return fmt::format("is of kind {} instead of {}", state_kind_name(b.kind), state_kind_name(a.kind));
  }
  if (a.unit != b.unit) return fmt::format("is in {} instead of {}", b.unit, a.unit);
  if (a.reference != b.reference) {
    return fmt::format("has the reference {:g} instead of {:g}", b.reference, a.reference);
  }
  if (a.axis != b.axis) {
    return fmt::format("is that of axis {} instead of {}", other.axes[b.axis].name, machine.axes[a.axis].name);
  }
  if (a.time_constant != b.time_constant) {
    return fmt::format("has the time constant {:g} s instead of {:g} s", b.time_constant, a.time_constant);
  }
  if (a.loads != b.loads) return "has other masses";
  if (name_of(machine, a.first) != name_of(other, b.first) || name_of(machine, a.second) != name_of(other, b.second)) {
    return a.kind == StateKind::lag ? "lags behind another state" : "has other factors";
  }
  return {};
}

}  // namespace

void bring_to_common_states(Machine& machine, std::vector<IdentifiedCampaign>& campaigns) {
  const std::set<std::string> in_use = names_in_use(campaigns);
  for (IdentifiedCampaign& campaign : campaigns) {
    const std::vector<MachineState> own = campaign.machine.states;
    const std::size_t known = machine.states.size();
    std::vector<std::size_t> common;  // of each state
    for (const MachineState& state : own) {
      common.push_back(find_state(machine, state.name));
      if (common.back() != kNoState) continue;
      common.back() = machine.states.size();
      machine.states.push_back(state);
    }
    const auto moved = [&](std::size_t state) { return state == kNoState ? kNoState : common.at(state); };
    for (std::size_t j = known; j < machine.states.size(); ++j) {
      machine.states[j].first = moved(machine.states[j].first);
      machine.states[j].second = moved(machine.states[j].second);
    }
    for (std::size_t j = 0; j < own.size(); ++j) {
      if (!in_use.contains(own[j].name)) continue;
      const std::string words = difference(machine, machine.states[common[j]], campaign.machine, own[j]);
      if (words.empty()) continue;
      throw InputError({.file = campaign.errors_file, .field = "state." + own[j].name},
                       fmt::format("{} {} (in {})", own[j].name, words, campaigns.front().errors_file),
                       "one definition of a state in all campaigns; --machine names one description for all");
    }
    for (ErrorMotion& motion : campaign.errors.errors.motions) motion.state = moved(motion.state);
    for (LocationError& location : campaign.errors.errors.locations) location.state = moved(location.state);
    campaign.machine.states = machine.states;
  }
  if (machine.states.size() > kMaxStates) {
    throw InputError({.field = "campaigns"}, fmt::format("{} states in all campaigns", machine.states.size()),
                     fmt::format("at most {}", kMaxStates));
  }
  for (IdentifiedCampaign& campaign : campaigns) campaign.machine.states = machine.states;
}

}  // namespace abbe
