#include "abbe/study/planning/planning_schedule.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "abbe/instruments/path_plan.h"

namespace abbe {
namespace {

/// Poses in an order of short travel; all readings of one pose together.
std::vector<CandidateReading> by_short_travel(const Machine& machine, const std::vector<CandidateReading>& readings) {
  std::map<std::vector<double>, std::vector<CandidateReading>> at;
  PoseList poses;
  for (const CandidateReading& reading : readings) {
    std::vector<CandidateReading>& here = at[reading.pose];
    if (here.empty()) poses.append(reading.pose);
    here.push_back(reading);
  }
  const PoseList ordered = order_by_travel(machine, poses);
  std::vector<CandidateReading> result;
  for (std::size_t k = 0; k < ordered.count(); ++k)
    for (const CandidateReading& reading : at[ordered.pose(k)]) result.push_back(reading);
  return result;
}

/// Those of one condition: set-up after set-up, where these cannot be used together.
void append_in_order(const Study& study, const std::vector<CandidateReading>& readings,
                     std::vector<CandidateReading>& result) {
  const auto append = [&](const std::vector<CandidateReading>& own) {
    if (own.empty()) return;
    const std::vector<CandidateReading> ordered = by_short_travel(study.machine, own);
    result.insert(result.end(), ordered.begin(), ordered.end());
  };
  if (sees_points_only(study)) return append(readings);
  for (std::size_t s = 0; s < study.setups.size(); ++s) {
    std::vector<CandidateReading> own;
    for (const CandidateReading& reading : readings) {
      if (reading.setup == s) own.push_back(reading);
    }
    append(own);
  }
}

/// @param idle  becomes the pauses of the course, s, with the one before it
std::vector<double> walk(const Study& study, const PlannedStates& states, const std::vector<CandidateReading>& readings,
                         double& idle) {
  const PlanningStudy& plan = *study.planning;
  std::vector<double> times;
  times.reserve(readings.size());
  double time = 0;
  std::set<std::size_t> used;
  idle = 0;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const CandidateReading& reading = readings[k];
    if (states.has_course()) {
      const double begin = states.conditions()[reading.condition].from_s;
      const bool pause = k == 0 || begin > time;
      if (pause) {
        idle += begin - time;
        time = begin + states.visit_time();
      }
    } else if (k > 0) {
      time += states.change_time(readings[k - 1].condition, reading.condition);
    }
    const std::string& setup = study.setups[reading.setup].name;
    if (used.insert(reading.setup).second) time += plan.set_up_of(setup);
    time += plan.reading_of(setup);
    if (k == 0 || reading.pose != readings[k - 1].pose) {
      time += plan.settle_of(setup) + (k > 0 ? travel_time(plan, readings[k - 1].pose, reading.pose) : 0);
    }
    times.push_back(time);
  }
  return times;
}

}  // namespace

bool sees_points_only(const Study& study) {
  return std::all_of(study.setups.begin(), study.setups.end(),
                     [](const Setup& setup) { return setup.device->measures_points(); });
}

double travel_time(const PlanningStudy& plan, const std::vector<double>& from, const std::vector<double>& to) {
  double longest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]) / plan.speed[i]);
  return longest;
}

std::vector<CandidateReading> scheduled_readings(const Study& study, const PlannedStates& states,
                                                 const std::vector<CandidateReading>& readings) {
  std::vector<CandidateReading> result;
  std::map<std::size_t, std::vector<CandidateReading>> parts;
  for (const CandidateReading& reading : readings) parts[reading.part].push_back(reading);
  if (parts.size() > 1) {
    for (const auto& [part, own] : parts) append_in_order(study, own, result);
    return result;
  }
  std::set<std::size_t> conditions;
  for (const CandidateReading& reading : readings) conditions.insert(reading.condition);
  std::vector<std::size_t> order = states.in_order({conditions.begin(), conditions.end()});
  const auto take = [&](std::size_t condition, std::size_t setup, bool every_setup) {
    std::vector<CandidateReading> here;
    for (const CandidateReading& reading : readings) {
      if (reading.condition == condition && (every_setup || reading.setup == setup)) here.push_back(reading);
    }
    append_in_order(study, here, result);
  };
  if (sees_points_only(study) || states.has_course() || order.size() == 1) {
    for (const std::size_t condition : order) take(condition, 0, true);
    return result;
  }
  // There and back through the conditions, so that the next set-up begins where the last one ended.
  for (std::size_t s = 0; s < study.setups.size(); ++s) {
    const std::size_t before = result.size();
    for (const std::size_t condition : order) take(condition, s, false);
    if (result.size() > before) std::reverse(order.begin(), order.end());
  }
  return result;
}

double measuring_time(const Study& study, const PlannedStates& states, const std::vector<CandidateReading>& readings) {
  double idle = 0;
  const std::vector<double> times = walk(study, states, readings, idle);
  return times.empty() ? 0 : times.back() - idle;
}

std::vector<double> reading_times(const Study& study, const std::vector<CandidateReading>& readings,
                                  const PlannedStates& states) {
  double idle = 0;
  return walk(study, states, readings, idle);
}

}  // namespace abbe
