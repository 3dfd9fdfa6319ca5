#include "abbe/study/planning/planning_drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "abbe/errors/random_stream.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/planning/planning_conditions.h"
#include "abbe/study/planning/planning_schedule.h"

namespace abbe {
namespace {

using Eigen::Index;

constexpr std::size_t kReadingsOfPart = 6;  // at least
constexpr std::size_t kMostPartsInTime = 12;
constexpr int kTimedRounds = 4;
constexpr std::size_t kPosesOfPart = 40;  // at least
constexpr double kUndetermined = std::numeric_limits<double>::infinity();

/// The drift of every set-up over the parts of a plan, as far as an identification has it.
PlannedDrifts drifts_over(const Study& study, const std::vector<PlanningPart>& parts) {
  PlannedDrifts drifts(study.setups.size());
  for (std::size_t s = 0; s < study.setups.size(); ++s) {
    const Setup& setup = study.setups[s];
    if (!setup.drift || !setup.drift->is_identified()) continue;
    std::vector<double> times;
    for (const PlanningPart& part : parts) {
      const bool own = part.setup == PosesAt::kEverySetup || part.setup == s;
      if (own && (times.empty() || part.time_s > times.back())) times.push_back(part.time_s);
    }
    const auto device = setup.device->as_planned();
    const std::size_t stations = std::max<std::size_t>(1, device->station_names().size());
    drifts[s] = drift_over(*setup.drift, *device, std::vector<std::vector<double>>(stations, times));
  }
  return drifts;
}

/// Poses that a part may take: those of the plan under its condition, whatever their part, and others.
PoseList poses_of_part(const PlanningSetting& setting, const std::vector<CandidateReading>& readings,
                       const PlanningPart& part, std::size_t number, std::size_t parts, int round) {
  const Study& study = setting.model->study();
  PoseList poses;
  std::set<std::vector<double>> known;
  std::vector<CandidateReading> own;
  for (const CandidateReading& reading : readings) {
    if (reading.condition != part.condition) continue;
    if (known.insert(reading.pose).second) poses.append(reading.pose);
    if (reading.part == number) own.push_back(reading);
  }
  const auto append = [&](const PoseList& more, std::size_t most) {
    for (std::size_t k = 0; k < more.count() && most > 0; ++k) {
      if (!known.insert(more.pose(k)).second) continue;
      poses.append(more.pose(k));
      --most;
    }
  };
  const bool anywhere = may_stand_anywhere(*setting.model);
  if (round > 0 && anywhere) {
    const std::uint64_t seed = study.seed * 37 + static_cast<std::uint64_t>(round) + kSeedOfCondition * number;
    append(poses_around(*study.planning, own, part.condition, seed), static_cast<std::size_t>(-1));
    return poses;
  }
  const auto candidates = static_cast<std::size_t>(study.planning->candidates);
  const std::size_t most = std::max(kPosesOfPart, candidates / parts);
  const PoseList all = poses_under(study, part.condition, most);
  // Of a grid a part takes every so many: all poses in all parts would be too many.
  const std::size_t step = std::max<std::size_t>(1, all.count() / most);
  PoseList some;
  for (std::size_t k = (number + static_cast<std::size_t>(round)) % step; k < all.count(); k += step) {
    some.append(all.pose(k));
  }
  append(some, most);
  return poses;
}

TimedCandidates candidates_in_time(const PlanningSetting& setting, const std::vector<CandidateReading>& readings,
                                   const std::vector<PlanningPart>& parts, int round) {
  const Study& study = setting.model->study();
  std::vector<PosesAt> tried;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    tried.push_back({poses_of_part(setting, readings, parts[k], k, parts.size(), round), parts[k].condition, k,
                     parts[k].setup, parts[k].time_s});
  }
  TimedCandidates timed;
  timed.model = std::make_unique<const PlanningModel>(study, &setting.model->errors(), drifts_over(study, parts));
  timed.candidates = timed.model->readings_at(tried);
  add_reading_costs(study, timed.candidates);
  timed.space = std::make_unique<const PlanningSpace>(timed.candidates.rows, timed.model->known());
  return timed;
}

std::vector<std::size_t> places_of(const PlanningModel::Candidates& candidates,
                                   const std::vector<CandidateReading>& readings) {
  std::map<CandidateReading, std::size_t> places;
  for (std::size_t i = 0; i < candidates.readings.size(); ++i) places[candidates.readings[i]] = i;
  std::vector<std::size_t> found;
  for (const CandidateReading& reading : readings) {
    const auto place = places.find(reading);
    if (place != places.end()) found.push_back(place->second);
  }
  return found;
}

/// What the plan makes small, of readings as they are taken.
double criterion_as_taken(const PlanningModel& model, const PlanningSpace& space, const PlanningOptions& options,
                          const std::vector<CandidateReading>& readings) {
  if (!ConditionGroups::fit(model, readings)) return kUndetermined;
  const PlanValue value = value_of(space, rows_as_taken(model, readings), options.functionals);
  if (!value.determined) return kUndetermined;
  return options.criterion == PlanningCriterion::variance ? value.variance : -value.log_determinant;
}

void count_visits(StudyPlan& result) {
  std::map<std::vector<double>, std::size_t> visits;
  for (std::size_t k = 0; k < result.readings.size(); ++k) {
    if (k == 0 || result.readings[k].pose != result.readings[k - 1].pose) ++visits[result.readings[k].pose];
  }
  result.drift.poses = visits.size();
  result.drift.returned_to = result.drift.most_visits = 0;
  for (const auto& [pose, number] : visits) {
    result.drift.returned_to += number > 1 ? 1U : 0U;
    result.drift.most_visits = std::max(result.drift.most_visits, number);
  }
}

/// "tracker: x, y, z; polynomial of degree 1; random walk of 3 um after an hour"
std::vector<std::string> drifting_setups(const Study& study) {
  std::vector<std::string> result;
  for (const Setup& setup : study.setups) {
    if (!setup.drift || !setup.drift->is_identified()) continue;
    const DriftPlan& plan = *setup.drift;
    std::string words = setup.name + ": ";
    bool shifts = false, turns = false;
    for (const int component : plan.components) {
      words += (component == plan.components.front() ? "" : ", ") + std::string(drift_component_name(component));
      (component < 3 ? shifts : turns) = true;
    }
    if (plan.degree > 0) words += fmt::format("; polynomial of degree {}", plan.degree);
    if (plan.walks) {
      constexpr double kHour = 3600;
      words += "; random walk of ";
      if (shifts) words += fmt::format("{:.4g} um", 1e3 * plan.walk_length * std::sqrt(kHour));
      if (turns) words += fmt::format("{}{:.4g} urad", shifts ? " and " : "", 1e6 * plan.walk_angle * std::sqrt(kHour));
      words += plan.estimate_walk ? " after an hour, with which its estimate starts" : " after an hour";
    }
    result.push_back(std::move(words));
  }
  return result;
}

}  // namespace

bool has_drift(const Study& study) {
  return std::any_of(study.setups.begin(), study.setups.end(),
                     [](const Setup& setup) { return setup.drift && setup.drift->is_identified(); });
}

PlanningCandidates rows_as_taken(const PlanningModel& model, const std::vector<CandidateReading>& readings) {
  const PlannedStates& states = model.states();
  const std::vector<double> times = reading_times(model.study(), readings, states);
  std::vector<std::vector<double>> at;
  if (states.has_course()) {
    at = states.at_times(times);
  } else if (states.any()) {
    for (const CandidateReading& reading : readings) at.push_back(states.conditions()[reading.condition].states);
  }
  return model.rows_of(readings, at, has_drift(model.study()) ? times : std::vector<double>());
}

std::vector<PlanningPart> parts_in_order(const Study& study, const PlannedStates& states,
                                         std::vector<CandidateReading>& readings) {
  const std::vector<double> times = reading_times(study, readings, states);
  const std::size_t wanted = std::clamp<std::size_t>(readings.size() / kReadingsOfPart, 1, kMostPartsInTime);
  const bool together = sees_points_only(study);
  std::vector<PlanningPart> parts;
  for (std::size_t begin = 0, end = 0; begin < readings.size(); begin = end) {
    while (end < readings.size() && readings[end].condition == readings[begin].condition &&
           (together || readings[end].setup == readings[begin].setup)) {
      ++end;
    }
    const double share = static_cast<double>(end - begin) / static_cast<double>(readings.size());
    const auto pieces = static_cast<std::size_t>(std::max(1L, std::lround(share * static_cast<double>(wanted))));
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::size_t first = begin + (end - begin) * piece / pieces,
                        last = begin + (end - begin) * (piece + 1) / pieces;
      if (first == last) continue;
      PlanningPart part{readings[first].condition, together ? PosesAt::kEverySetup : readings[first].setup, 0,
                        last - first};
      for (std::size_t k = first; k < last; ++k) {
        part.time_s += times[k] / static_cast<double>(part.room);
        readings[k].part = parts.size();
      }
      parts.push_back(part);
    }
  }
  return parts;
}

Eigen::MatrixXd with_drifts(const Eigen::MatrixXd& rows, const PlanningModel& from, const PlanningModel& to) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows.rows(), static_cast<Index>(to.parameter_count()));
  for (std::size_t i = 0, k = 0; i < from.parameter_count(); ++i, ++k) {
    while (!(to.parameters()[k].id == from.parameters()[i].id)) ++k;
    result.col(static_cast<Index>(k)) = rows.col(static_cast<Index>(i));
  }
  return result;
}

TimedCandidates choose_in_time(const PlanningSetting& setting, const PlanningSpace& space,
                               const PlanningOptions& options, StudyPlan& result, const std::stop_token& stop) {
  const PlanningModel& model = *setting.model;
  const Study& study = model.study();
  TimedCandidates best;
  double criterion = criterion_as_taken(model, space, options, result.readings);
  std::size_t count = result.readings.size();
  for (int round = 0; round < kTimedRounds; ++round) {
    stop_if_asked(stop);
    std::vector<CandidateReading> readings = result.readings;
    const std::vector<PlanningPart> parts = parts_in_order(study, model.states(), readings);
    TimedCandidates timed = candidates_in_time(setting, readings, parts, round);
    PlanningOptions own = options;
    own.count = count;
    own.group.clear();
    own.most_of_group.clear();
    for (const CandidateReading& reading : timed.candidates.readings) {
      own.group.push_back(static_cast<std::uint32_t>(reading.part));
    }
    for (const PlanningPart& part : parts) own.most_of_group.push_back(part.room);
    own.start = places_of(timed.candidates, readings);
    if (own.start.size() > count) own.start.resize(count);
    if (own.criterion == PlanningCriterion::variance)
      own.functionals = with_drifts(options.functionals, model, *timed.model);
    const ReadingPlan chosen = plan_readings(*timed.space, own);
    if (chosen.status != PlanningStatus::done) continue;
    std::vector<CandidateReading> found;
    for (const std::size_t i : chosen.chosen) found.push_back(timed.candidates.readings[i]);
    found = scheduled_readings(study, model.states(), found);
    const double time = measuring_time(study, model.states(), found);
    if (study.planning->time > 0 && time > study.planning->time) {
      // Coming back to poses takes ways: fewer readings, and another try.
      count = static_cast<std::size_t>(0.98 * static_cast<double>(count) * study.planning->time / time);
      if (count == 0) break;
      continue;
    }
    const double value = criterion_as_taken(model, space, options, found);
    if (!(value < criterion)) continue;
    criterion = value;
    result.plan = chosen;
    result.readings = std::move(found);
    result.time = time;
    result.drift.parts = parts.size();
    best = std::move(timed);
  }
  if (!best.space) {
    const std::vector<PlanningPart> parts = parts_in_order(study, model.states(), result.readings);
    result.drift.parts = parts.size();
    best = candidates_in_time(setting, result.readings, parts, 0);
  }
  count_visits(result);
  result.drift.setups = drifting_setups(study);
  result.drift.determined = std::isfinite(criterion);
  if (!result.drift.determined) result.plan.status = PlanningStatus::not_determined;
  return best;
}

std::optional<PlanPoint> point_as_taken(const PlanningModel& model, const PlanningSpace& space,
                                        const Eigen::MatrixXd& predictions,
                                        const std::vector<CandidateReading>& readings) {
  if (readings.empty() || !ConditionGroups::fit(model, readings)) return std::nullopt;
  const PlanningCandidates rows = rows_as_taken(model, readings);
  const PlanValue value = value_of(space, rows, predictions);
  if (!value.determined) return std::nullopt;
  return PlanPoint{readings.size(), true, std::sqrt(value.variance / (static_cast<double>(predictions.rows()) / 3)),
                   uncertainty_with_prior(model, rows.rows, predictions)};
}

}  // namespace abbe
