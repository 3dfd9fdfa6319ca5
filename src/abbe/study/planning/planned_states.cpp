#include "abbe/study/planning/planned_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "abbe/errors/error_states.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostSlots = 100;
constexpr std::size_t kTimesOfUse = 48;
constexpr std::size_t kUsedPerState = 5;
constexpr std::size_t kMostUsed = 48;
constexpr std::size_t kMostEnds = 8;

void collect_sensors(const Machine& machine, std::size_t state, std::set<std::size_t>& sensors) {
  const MachineState& one = machine.states.at(state);
  if (one.kind == StateKind::measured) sensors.insert(state);
  if (one.kind == StateKind::lag) collect_sensors(machine, one.first, sensors);
  if (one.kind != StateKind::product) return;
  collect_sensors(machine, one.first, sensors);
  collect_sensors(machine, one.second, sensors);
}

/// All combinations of one entry of each list, as indices, the last list fastest.
std::vector<std::vector<std::size_t>> combinations_of(const std::vector<std::vector<double>>& lists) {
  std::vector<std::vector<std::size_t>> all = {{}};
  for (const std::vector<double>& list : lists) {
    std::vector<std::vector<std::size_t>> longer;
    for (const std::vector<std::size_t>& one : all) {
      for (std::size_t k = 0; k < list.size(); ++k) {
        longer.push_back(one);
        longer.back().push_back(k);
      }
    }
    all = std::move(longer);
  }
  return all;
}

std::vector<double> picked_values(const std::vector<std::vector<double>>& lists,
                                  const std::vector<std::size_t>& places) {
  std::vector<double> values;
  for (std::size_t i = 0; i < lists.size(); ++i) values.push_back(lists[i][places[i]]);
  return values;
}

template <typename T>
void thin_out(std::vector<T>& list, std::size_t most) {
  if (list.size() <= most) return;
  std::vector<T> kept;
  for (std::size_t k = 0; k < most; ++k) kept.push_back(list[k * (list.size() - 1) / (most - 1)]);
  list = std::move(kept);
}

}  // namespace

std::vector<std::size_t> sensors_of_state(const Machine& machine, std::size_t state) {
  std::set<std::size_t> sensors;
  if (state != kNoState) collect_sensors(machine, state, sensors);
  return {sensors.begin(), sensors.end()};
}

void give_states(const std::vector<std::vector<double>>& states, PoseList& poses) {
  if (states.empty() || states.front().empty()) return;
  poses.state.assign(states.front().size(), {});
  for (std::size_t j = 0; j < poses.state.size(); ++j) {
    if (std::isnan(states.front()[j])) continue;
    for (std::size_t k = 0; k < poses.count(); ++k) {
      poses.state[j].push_back(states.size() == 1 ? states.front()[j] : states.at(k)[j]);
    }
  }
}

PlannedStates::PlannedStates(const Study& study, const ErrorSet& errors) : machine_(study.machine), conditions_(1) {
  const std::vector<std::uint8_t> used = used_states(machine_, errors);
  std::set<std::size_t> sensors;
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] == 0) continue;
    if (machine_.states[j].kind == StateKind::approach) {
      throw InputError({.field = "identify.motion.state"},
                       fmt::format("errors depend on {}, and a plan does not say from which side axes come",
                                   machine_.states[j].name),
                       "a plan of the other errors");
    }
    if (!is_input(machine_.states[j].kind)) continue;
    needed_.push_back(j);
    collect_sensors(machine_, j, sensors);
  }
  sensors_.assign(sensors.begin(), sensors.end());
  if (needed_.empty()) {
    if (!study.planning || (study.planning->states.empty() && !study.planning->course)) return;
    throw InputError({.field = study.planning->course ? "plan.course" : "plan.state"},
                     "no error to be identified depends on a measured state or a lag",
                     "errors with states in [[identify.motion]] or [[identify.location]]");
  }
  if (study.planning && study.planning->course) {
    add_course(study);
  } else {
    take_values(study, errors);
    add_values();
  }
}

/// @param values  [PlanningStudy::states]
std::vector<double> PlannedStates::states_of(const std::vector<double>& values) const {
  std::vector<double> states(machine_.states.size(), kNoValue);
  for (const std::size_t state : needed_) {
    const MachineState& one = machine_.states[state];
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (values_[i].state == state) states[state] = values[i];
    }
    // In the steady state a lag has the value of its channel.
    for (std::size_t i = 0; i < values_.size() && std::isnan(states[state]); ++i) {
      if (one.kind == StateKind::lag && values_[i].state == one.first) states[state] = values[i];
    }
  }
  return states;
}

void PlannedStates::take_values(const Study& study, const ErrorSet& errors) {
  if (study.planning) values_ = study.planning->states;
  std::vector<double> first;
  for (const PlannedState& one : values_) {
    const bool used = std::find(needed_.begin(), needed_.end(), one.state) != needed_.end() ||
                      std::find(sensors_.begin(), sensors_.end(), one.state) != sensors_.end();
    if (!used) {
      throw InputError({.field = "plan.state." + machine_.states[one.state].name}, "no error depends on this state",
                       "states of the errors: " + reference_words(machine_, errors));
    }
    first.push_back(one.values.front());
    slow_first_.push_back(slow_first_.size());
  }
  std::stable_sort(slow_first_.begin(), slow_first_.end(),
                   [this](std::size_t a, std::size_t b) { return values_[a].change > values_[b].change; });
  const std::vector<double> states = states_of(first);
  for (const std::size_t state : needed_) {
    if (!std::isnan(states[state])) continue;
    const MachineState& one = machine_.states[state];
    const std::string& name = one.kind == StateKind::lag ? machine_.states[one.first].name : one.name;
    throw InputError(
        {.field = "plan"},
        fmt::format("the errors depend on {}, and the study does not say at which values readings can be taken",
                    one.name),
        fmt::format("a table [plan.state.{}] with from and to, or [plan.course]", name));
  }
}

void PlannedStates::add_values() {
  std::vector<std::vector<double>> possible, used, ends;
  bool beyond = false;
  for (const PlannedState& one : values_) {
    possible.push_back(one.values);
    const bool one_value = one.used_from == one.used_to;
    used.push_back(evenly_spaced(one.used_from, one.used_to, one_value ? 1 : kUsedPerState));
    ends.push_back(evenly_spaced(one.used_from, one.used_to, one_value ? 1 : 2));
    beyond = beyond || one.used_from < one.values.front() || one.used_to > one.values.back();
  }
  conditions_.clear();
  for (const std::vector<std::size_t>& level : combinations_of(possible)) {
    conditions_.push_back({states_of(picked_values(possible, level)), level});
  }
  used_at_.clear();
  std::vector<std::vector<std::size_t>> places = combinations_of(used);
  thin_out(places, kMostUsed);
  for (const std::vector<std::size_t>& place : places) used_at_.push_back(states_of(picked_values(used, place)));
  if (!beyond) return;
  places = combinations_of(ends);
  thin_out(places, kMostEnds);
  for (const std::vector<std::size_t>& place : places) {
    PlanningCondition& end = conditions_.emplace_back();
    end.states = states_of(picked_values(ends, place));
    end.level.assign(values_.size(), 0);
    end.possible = false;
  }
}

void PlannedStates::add_course(const Study& study) {
  const PlannedCourse& course = *study.planning->course;
  channels_ = read_channels(machine_, {}, course.channels);
  visit_ = course.visit;
  const std::string file = course.channels.files.front().file.string();
  const auto [from, to] = channels_.common_time();
  if (!(from < to)) {
    throw InputError({.file = file}, "the channels of the course have no time in common", "values over the same time");
  }
  const double slots = std::ceil((to - from) / course.slot * (1 - 1e-12));
  if (slots > kMostSlots) {
    throw InputError({.field = "plan.course.slot"}, fmt::format("the course has {:g} parts of this length", slots),
                     fmt::format("at least slot_s = {:.4g}", (to - from) / kMostSlots));
  }
  std::vector<double> middle;
  conditions_.clear();
  for (std::size_t k = 0; k < static_cast<std::size_t>(slots); ++k) {
    PlanningCondition& slot = conditions_.emplace_back();
    slot.from_s = from + static_cast<double>(k) * course.slot;
    slot.to_s = std::min(to, slot.from_s + course.slot);
    middle.push_back(0.5 * (slot.from_s + slot.to_s));
  }
  const std::vector<std::vector<double>> states = at_times(middle);
  for (std::size_t k = 0; k < states.size(); ++k) conditions_[k].states = states[k];
  used_at_time_ = evenly_spaced(from, to, kTimesOfUse);
  used_at_ = at_times(used_at_time_);
  std::vector<UncertainStart> starts;
  PoseList first;
  first.axis.assign(1, {from});
  channels_.give(machine_, {from}, {file, "time"}, first, &starts);
  for (const UncertainStart& start : starts) {
    if (std::find(needed_.begin(), needed_.end(), start.state) == needed_.end()) continue;
    notes_.push_back(uncertain_start_words(machine_, start));
  }
}

std::vector<std::vector<double>> PlannedStates::at_times(const std::vector<double>& time_s) const {
  PoseList poses;
  poses.axis.assign(1, time_s);  // only their number counts
  channels_.give(machine_, time_s, {"[plan.course]", "time"}, poses);
  for (const std::size_t state : needed_) {
    if (state < poses.state.size() && !poses.state[state].empty()) continue;
    throw InputError(
        {.field = "plan.course"},
        fmt::format("the errors depend on {}, which the course does not have", machine_.states[state].name),
        "a column " + state_column(machine_.states[state]));
  }
  std::vector<std::vector<double>> states(time_s.size(), std::vector<double>(machine_.states.size(), kNoValue));
  for (std::size_t k = 0; k < states.size(); ++k) {
    for (const std::size_t state : needed_) states[k][state] = poses.state[state][k];
  }
  return states;
}

double PlannedStates::change_time(std::size_t from, std::size_t to) const {
  double longest = 0;  // several states change at the same time
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (conditions_[from].level[i] != conditions_[to].level[i]) longest = std::max(longest, values_[i].change);
  }
  return longest;
}

std::vector<std::size_t> PlannedStates::in_order(std::vector<std::size_t> conditions) const {
  // There and back: behind a step of a slower state the faster ones go the other way.
  const auto key = [this](std::size_t condition) {
    std::vector<std::ptrdiff_t> places;
    std::size_t steps = 0;
    for (const std::size_t i : slow_first_) {
      const auto level = static_cast<std::ptrdiff_t>(conditions_[condition].level[i]);
      places.push_back(steps % 2 == 0 ? level : -level);
      steps += conditions_[condition].level[i];
    }
    return std::pair(places, condition);
  };
  std::sort(conditions.begin(), conditions.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return conditions;
}

double PlannedStates::change_time(const std::vector<std::size_t>& conditions) const {
  const std::vector<std::size_t> order = in_order(conditions);
  double sum = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k > 0) sum += change_time(order[k - 1], order[k]);
    if (has_course() && (k == 0 || order[k] != order[k - 1] + 1)) sum += visit_;
  }
  return sum;
}

std::string PlannedStates::words(const std::vector<double>& states) const {
  std::string words;
  for (std::size_t j = 0; j < states.size(); ++j) {
    if (std::isnan(states[j])) continue;
    words += fmt::format("{}{} = {:.4g}", words.empty() ? "" : ", ", state_column(machine_.states[j]), states[j]);
  }
  return words;
}

}  // namespace abbe
