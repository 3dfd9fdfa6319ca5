#include "abbe/study/identification/state_ranges.h"

#include <algorithm>
#include <limits>

#include "abbe/errors/error_states.h"

namespace abbe {

std::vector<CoveredState> covered_states(const Study& study, const StudyResult& result) {
  std::vector<CoveredState> covered;
  const std::vector<std::uint8_t> used = used_states(study.machine, result.identification.errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    const MachineState& state = study.machine.states[j];
    if (used[j] == 0 || !is_input(state.kind)) continue;
    CoveredState range{state_column(state), std::numeric_limits<double>::infinity(),
                       -std::numeric_limits<double>::infinity()};
    for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
      const PoseList& poses = result.campaign.setups[s].poses();
      const std::vector<std::uint8_t>& use = result.model.problem.observations[s].use;
      if (j >= poses.state.size()) continue;
      for (std::size_t k = 0; k < poses.state[j].size(); ++k) {
        if (!use.empty() && use[k] == 0) continue;
        range.from = std::min(range.from, poses.state[j][k]);
        range.to = std::max(range.to, poses.state[j][k]);
      }
    }
    if (range.from <= range.to) covered.push_back(range);
  }
  return covered;
}

double covered_time_s(const StudyResult& result) {
  double span = 0;
  for (const CampaignSetup& setup : result.campaign.setups) {
    const std::vector<double>& times = setup.readings.time_s;
    if (times.empty()) continue;
    const auto [first, last] = std::minmax_element(times.begin(), times.end());
    span = std::max(span, *last - *first);
  }
  return span;
}

}  // namespace abbe
