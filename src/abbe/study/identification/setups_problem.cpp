#include "abbe/study/identification/setups_problem.h"

#include <memory>

#include "abbe/study/identification/setup_drifts.h"

namespace abbe {

Problem setups_problem(const Machine& machine, const ErrorSet& errors, std::span<const CampaignSetup> setups,
                       std::span<const std::vector<std::uint8_t>> use) {
  std::vector<std::shared_ptr<Observations>> observations;
  for (const CampaignSetup& setup : setups) observations.push_back(setup.observations(machine, errors));
  Problem problem = estimate_everything(machine, errors, observations);
  problem.machine_parameters.clear();
  for (std::size_t s = 0; s < setups.size(); ++s) {
    problem.observations[s].use = use[s];
    for (const KnownUnknown& known : setups[s].known_unknowns()) {
      problem.priors.push_back({{s, known.unknown}, known.value, known.standard_uncertainty});
    }
    add_walk_priors(setups[s], s, problem);
  }
  return problem;
}

}  // namespace abbe
