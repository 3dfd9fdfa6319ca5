#include "abbe/study/identification/setup_drifts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

DriftingPlace place_of(const DriftPlan& plan, const Instrument& device, std::size_t station) {
  const std::vector<std::string> stations = device.station_names();
  DriftingPlace place;
  place.name = station < stations.size() ? stations[station] : device.name();
  for (const InstrumentPlace& one : device.places()) {
    if (one.name == place.name || stations.empty()) {
      place.pivot = one.position;
      break;
    }
  }
  if (plan.about) place.pivot = *plan.about;
  return place;
}

/// All times, or so many evenly over them that straight lines between them have to do.
std::vector<double> knots_over(const std::vector<double>& times, std::size_t most) {
  if (times.size() <= most) return times;
  std::vector<double> knots;
  for (std::size_t i = 0; i < most; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(most - 1);
    knots.push_back(times.front() + share * (times.back() - times.front()));
  }
  knots.back() = times.back();
  return knots;
}

/// Inverse covariance of a walk of unit intensity at its knots, where it is 0 at the first one.
Eigen::MatrixXd walk_information(const std::vector<double>& knots_s) {
  const auto n = static_cast<Eigen::Index>(knots_s.size()) - 1;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double per_step = 1 / (knots_s[k + 1] - knots_s[k]);
    information(i, i) += per_step;
    if (i == 0) continue;
    information(i - 1, i - 1) += per_step;
    information(i, i - 1) -= per_step;
    information(i - 1, i) -= per_step;
  }
  return information;
}

/// Calls use(place, component, first unknown among the drift's) for every walk of a drift.
template <class Use>
void for_each_walk(const SetupDrift& drift, const Use& use) {
  for (std::size_t p = 0; p < drift.places.size(); ++p) {
    const DriftingPlace& place = drift.places[p];
    if (place.knots_s.empty()) continue;
    for (std::size_t c = 0; c < place.components.size(); ++c) {
      use(place, place.components[c], drift.first_unknown(p, c) + static_cast<std::size_t>(place.degree));
    }
  }
}

double walk_variance(const DriftPlan& plan, int component) {
  const double intensity = component < 3 ? plan.walk_length : plan.walk_angle;
  return intensity * intensity;
}

}  // namespace

std::shared_ptr<const SetupDrift> assumed_drift(const DriftPlan& plan, const Instrument& device,
                                                const InstrumentReadings& readings, const std::string& place) {
  if (!plan.is_identified()) return nullptr;
  if (readings.time_s.empty()) {
    throw InputError({.file = place, .field = "drift"}, "the readings have no times", "a column time_s");
  }
  const std::vector<std::vector<double>> times = times_by_station(device, readings);
  for (std::size_t s = 0; s < times.size(); ++s) {
    if (times[s].size() != 1) continue;
    throw InputError({.file = place, .field = "drift"},
                     fmt::format("all readings of {} have the same time", place_of(plan, device, s).name),
                     "readings over a span of time");
  }
  return drift_over(plan, device, times);
}

std::vector<std::vector<double>> times_by_station(const Instrument& device, const InstrumentReadings& readings) {
  std::vector<std::vector<double>> times(std::max<std::size_t>(1, device.station_names().size()));
  for (std::size_t k = 0; k < readings.time_s.size(); ++k) {
    times[device.station_of(readings.item[k])].push_back(readings.time_s[k]);
  }
  for (std::vector<double>& of_one : times) {
    std::sort(of_one.begin(), of_one.end());
    of_one.erase(std::unique(of_one.begin(), of_one.end()), of_one.end());
  }
  return times;
}

std::shared_ptr<const SetupDrift> drift_over(const DriftPlan& plan, const Instrument& device,
                                             const std::vector<std::vector<double>>& times) {
  auto drift = std::make_shared<SetupDrift>();
  for (std::size_t s = 0; s < times.size(); ++s) {
    DriftingPlace& one = drift->places.emplace_back(place_of(plan, device, s));
    if (times[s].size() < 2) continue;
    one.components = plan.components;
    one.start_s = times[s].front();
    one.end_s = times[s].back();
    one.degree = plan.degree;
    if (plan.walks) one.knots_s = knots_over(times[s], plan.knots);
  }
  drift->values.assign(drift->unknown_count(), 0.0);
  return drift;
}

std::shared_ptr<const SetupDrift> true_drift(const DriftPlan& plan, const Instrument& truth,
                                             const std::vector<double>& time_s, RandomStream& random) {
  std::vector<double> times = time_s;
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  if (!plan.truth || times.size() < 2) return nullptr;
  auto drift = std::make_shared<SetupDrift>();
  const std::size_t stations = std::max<std::size_t>(1, truth.station_names().size());
  for (std::size_t s = 0; s < stations; ++s) {
    DriftingPlace& place = drift->places.emplace_back(place_of(plan, truth, s));
    place.components = {0, 1, 2, 3, 4, 5};
    place.start_s = times.front();
    place.end_s = times.back();
    place.degree = 3;
    place.knots_s = times;
    for (const std::vector<double>& polynomial : plan.truth->polynomial) {
      const bool is_angle = &polynomial - plan.truth->polynomial.data() >= 3;
      for (std::size_t k = 0; k < 3; ++k) drift->values.push_back(k < polynomial.size() ? polynomial[k] : 0.0);
      double walk = 0;
      for (std::size_t i = 1; i < times.size(); ++i) {
        const double intensity = is_angle ? plan.truth->walk_angle : plan.truth->walk_length;
        walk += intensity * std::sqrt(times[i] - times[i - 1]) * random.normal();
        drift->values.push_back(walk);
      }
    }
  }
  return drift;
}

void add_walk_priors(const CampaignSetup& setup, std::size_t index, Problem& problem) {
  if (setup.readings.drift != nullptr) add_walk_priors(*setup.drift, *setup.readings.drift, index, problem);
}

void add_walk_priors(const DriftPlan& plan, const SetupDrift& drift, std::size_t index, Problem& problem) {
  const std::size_t before = problem.observations[index].observations->unknowns().size() - drift.unknown_count();
  for_each_walk(drift, [&](const DriftingPlace& place, int component, std::size_t first) {
    const std::size_t n = place.knots_s.size() - 1;
    JointPrior prior;
    for (std::size_t i = 0; i < n; ++i) prior.parameters.push_back({index, before + first + i});
    prior.value = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
    prior.information = walk_information(place.knots_s) / walk_variance(plan, component);
    prior.residual_count = static_cast<double>(n);
    problem.joint_priors.push_back(std::move(prior));
  });
}

std::vector<EstimatedWalk> walks_to_estimate(const Campaign& campaign, const Problem& problem) {
  std::vector<EstimatedWalk> walks;
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    const CampaignSetup& setup = campaign.setups[s];
    if (setup.readings.drift == nullptr || !setup.drift->estimate_walk) continue;
    const SetupDrift& drift = *setup.readings.drift;
    const std::size_t before = problem.observations[s].observations->unknowns().size() - drift.unknown_count();
    for_each_walk(drift, [&](const DriftingPlace& place, int component, std::size_t first) {
      const bool is_angle = component >= 3;
      const ParameterId id{s, before + first};
      const auto prior = std::find_if(problem.joint_priors.begin(), problem.joint_priors.end(),
                                      [&](const JointPrior& one) { return one.parameters.front() == id; });
      const std::string name = place.name + (is_angle ? " turns" : " shifts");
      if (walks.empty() || walks.back().setup != s || walks.back().name != name) {
        walks.push_back({name, s, is_angle, {}, walk_variance(*setup.drift, component)});
      }
      walks.back().priors.push_back(static_cast<std::size_t>(prior - problem.joint_priors.begin()));
    });
  }
  return walks;
}

void take_drift_of(const CampaignSetup& setup, const std::string& file, InstrumentReadings& readings) {
  if (setup.readings.drift == nullptr) return;
  if (readings.time_s.empty()) {
    throw InputError({.file = file, .field = "time_s"}, "the readings have no times, and their set-up drifts",
                     "a column time_s, counted from the same moment as that of the other readings");
  }
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const DriftingPlace& place = setup.readings.drift->places[setup.start->station_of(readings.item[k])];
    const double time = readings.time_s[k];
    if (place.components.empty() || (time >= place.start_s && time <= place.end_s)) continue;
    throw InputError(
        {.file = file, .field = "time_s"},
        fmt::format("reading {} was taken at {:.6g} s, when the drift of {} is not known", k + 1, time, place.name),
        fmt::format("times from {:.6g} to {:.6g} s", place.start_s, place.end_s));
  }
  readings.drift = setup.readings.drift;
}

void stand_at_start_of_drift(const CampaignSetup& setup, InstrumentReadings& readings) {
  if (setup.readings.drift == nullptr) return;
  double first = setup.readings.time_s.front();
  for (const double time : setup.readings.time_s) first = std::min(first, time);
  readings.drift = setup.readings.drift;
  readings.time_s.assign(readings.count(), first);
}

}  // namespace abbe
