#include "abbe/study/evaluations/location_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/errors/error_states.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/identify/identify.h"
#include "abbe/study/evaluations/cycle_readings.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

/// A cycle with a smaller share of the readings of a usual one was broken off.
constexpr double kWholeCycle = 0.5;

/// Location errors without a state that the readings have determined: indices into ErrorSet::parameters().
std::vector<std::size_t> determined_locations(const Problem& problem, const Identification& whole) {
  std::size_t first = 0;
  for (const ErrorMotion& motion : problem.errors.motions) first += motion.coefficients.size();
  std::vector<std::size_t> found;
  for (std::size_t p = 0; p < whole.parameters.size(); ++p) {
    const ParameterId& id = whole.parameters[p].id;
    if (!id.is_machine() || id.index < first || id.index >= first + problem.errors.locations.size()) continue;
    if (problem.errors.locations[id.index - first].state != kNoState) continue;
    if (whole.standard_uncertainties[static_cast<Eigen::Index>(p)] > 0) found.push_back(id.index);
  }
  return found;
}

/// The readings of one cycle, of set-ups that have any, with all that the whole campaign found.
Problem problem_of_cycle(const Machine& machine, const Campaign& campaign, const Identification& whole,
                         const std::vector<std::size_t>& locations,
                         const std::vector<std::vector<std::size_t>>& readings) {
  Problem problem;
  problem.machine = machine;
  problem.errors = whole.errors;
  problem.machine_parameters = locations;
  ReadingPoint start;
  start.machine = whole.errors.parameters();
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    if (readings[s].empty()) continue;
    CampaignSetup part = campaign.setups[s];
    part.readings = part.readings.subset(readings[s]);
    SelectedObservations selected;
    selected.observations = part.observations(machine, whole.errors);
    std::vector<std::uint8_t> is_open(selected.observations->unknowns().size(), 1);
    for (const KnownUnknown& known : part.known_unknowns()) is_open[known.unknown] = 0;
    for (std::size_t u = 0; u < is_open.size(); ++u) {
      if (is_open[u] != 0) selected.unknowns.push_back(u);
    }
    problem.observations.push_back(std::move(selected));
    start.setups.push_back(whole.setup[s]);
  }
  set_observations(problem, start);
  return problem;
}

/// Appends the means of the measured temperatures over the readings of a cycle, where they are given at all of them.
void add_temperatures(const Machine& machine, const Campaign& campaign,
                      const std::vector<std::vector<std::size_t>>& readings, double time,
                      std::vector<TimeSeries>& temperatures) {
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    const MachineState& state = machine.states[j];
    if (state.kind != StateKind::measured || state.unit != "degC") continue;
    double sum = 0, count = 0;
    for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
      const std::vector<std::vector<double>>& given = campaign.setups[s].poses().state;
      for (const std::size_t k : readings[s]) {
        sum += j < given.size() && !given[j].empty() ? given[j][k] : NAN;
        ++count;
      }
    }
    if (std::isnan(sum)) continue;
    const auto found = std::find_if(temperatures.begin(), temperatures.end(),
                                    [&](const TimeSeries& series) { return series.name == state.name; });
    TimeSeries& series =
        found != temperatures.end() ? *found : temperatures.emplace_back(TimeSeries{state.name, {}, {}});
    series.time.push_back(time);
    series.values.push_back(sum / count);
  }
}

void require_timeless_errors(const Study& study, const ErrorSet& errors, const std::string& file) {
  const std::vector<std::uint8_t> used = used_states(study.machine, errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] == 0 || !is_input(study.machine.states[j].kind)) continue;
    throw InputError(
        {.file = file, .field = "identify"},
        fmt::format("errors depend on {}, which would hide what the test shows", study.machine.states[j].name),
        "errors without measured states");
  }
}

/// All of a campaign identified, without what only its own report needs.
StudyResult whole_campaign(const Study& study, const Campaign& campaign, const std::string& file) {
  if (!study.identification) {
    throw InputError({.file = file}, "nothing is to be identified", "a table [identify] with locations");
  }
  Study plain = study;
  plain.identification->monte_carlo = 0;
  plain.identification->held_out_fraction = 0;
  StudyResult result;
  result.campaign = campaign;
  identify_study(plain, result, {.advice = false});
  if (!result.usable()) {
    throw InputError({.file = file}, "the whole campaign cannot be identified: " + result.identification.message,
                     "readings that determine the errors of the study");
  }
  require_timeless_errors(study, result.model.problem.errors, file);
  return result;
}

/// Whether the readings of a cycle alone determine what is found in it.
bool is_determined(const Identification& found) {
  return found.status == IdentifyStatus::converged && found.gauge.constraints.empty();
}

/// Identifies one cycle and appends what was found. @returns why it is left out; empty: it is not
std::string add_cycle(const Study& study, const StudyResult& whole, const std::vector<std::size_t>& locations,
                      const CycleReadings& cycles, std::size_t number, LocationErrorsOverTime& result) {
  LocationCycle cycle{.readings = cycles.count(number)};
  const std::size_t usual = cycles.usual_count();
  if (static_cast<double>(cycle.readings) < kWholeCycle * static_cast<double>(usual)) {
    return fmt::format("it has {} readings, a usual cycle {}", cycle.readings, usual);
  }
  const auto readings = cycles.of_cycle(number, whole.campaign.setups.size());
  Problem problem = problem_of_cycle(study.machine, whole.campaign, whole.identification, locations, readings);
  const Identification found = identify(problem, identify_options(study));
  if (!is_determined(found)) return "its readings alone do not determine the location errors";
  const std::size_t first = cycles.starts[number], last = cycles.starts[number + 1];
  cycle.from = cycles.all[first].time;
  cycle.to = cycles.all[last - 1].time;
  for (std::size_t k = first; k < last; ++k) cycle.time += cycles.all[k].time / static_cast<double>(cycle.readings);
  cycle.chi_square = found.statistics.chi_square;
  cycle.degrees_of_freedom = found.statistics.degrees_of_freedom;
  result.cycles.push_back(cycle);
  for (std::size_t i = 0; i < locations.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    result.locations[i].values.push_back(found.estimates[at]);
    result.locations[i].uncertainty.push_back(found.standard_uncertainties[at]);
  }
  // Parameters that all cycles share are those that were not found again.
  const std::size_t free = whole.identification.statistics.parameter_count;
  result.common_parameters = std::max(result.common_parameters, free - std::min(free, estimated_count(problem)));
  add_temperatures(study.machine, whole.campaign, readings, cycle.time, result.temperatures);
  return {};
}

}  // namespace

LocationErrorsOverTime location_errors_over_time(const Study& study, const Campaign& campaign,
                                                 const CycleChoice& choice, const std::string& file) {
  LocationErrorsOverTime result;
  const CycleReadings cycles = divide_into_cycles(study.machine, campaign, choice, file, result.pause);
  const StudyResult whole = whole_campaign(study, campaign, file);
  const std::vector<std::size_t> locations = determined_locations(whole.model.problem, whole.identification);
  if (locations.empty()) {
    throw InputError({.file = file, .field = "identify.locations"}, "no location error is identified",
                     "location errors such as EX0C");
  }
  const std::vector<std::string> names = parameter_names(study.machine, whole.identification.errors);
  const std::vector<bool> angles = parameters_are_angles(study.machine, whole.identification.errors);
  for (const std::size_t index : locations) result.locations.push_back({names[index], angles[index], {}, {}});
  for (std::size_t c = 0; c + 1 < cycles.starts.size(); ++c) {
    const std::string why = add_cycle(study, whole, locations, cycles, c, result);
    if (why.empty()) continue;
    const double after = cycles.all[cycles.starts[c]].time - cycles.all.front().time;
    result.left_out.push_back(fmt::format("The cycle that begins after {:.4g} min is left out: {}.", after / 60, why));
  }
  if (result.cycles.size() >= 2) return result;
  std::string first = result.left_out.front();
  first.pop_back();
  throw InputError({.file = file}, "fewer than two cycles determine the location errors. " + first,
                   "in every cycle all poses that the study needs; --cycle-min and --pause-min define the cycles");
}

}  // namespace abbe
