#include "abbe/study/planning/planning_conditions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/geometry/decompositions.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/study/planning/planning_drift.h"
#include "abbe/study/planning/planning_schedule.h"

namespace abbe {
namespace {

using Eigen::Index;

constexpr double kNoTime = std::numeric_limits<double>::infinity();
/// More conditions than these are taken only if the study wants them.
constexpr std::size_t kMostConditionsTried = 8;
constexpr std::size_t kMostJudged = 250;
constexpr double kAsGoodConditions = 0.02;
/// Of the way between poses at random, what an order of short travel leaves.
constexpr double kShortTravel = 0.1;
constexpr std::size_t kPosesOfTravel = 50;

/// By the mean information of the candidates of each condition: fast enough for every exchange of conditions.
class MeanInformation {
 public:
  explicit MeanInformation(const ConditionsToJudge& judged)
      : judged_(judged),
        prior_(judged.model.weak_prior() + judged.model.known().transpose() * judged.model.known()),
        prediction_(judged.predictions.transpose() * judged.predictions /
                    (static_cast<double>(judged.predictions.rows()) / 3)) {
    const std::size_t count = judged.model.states().conditions().size();
    const PlanningCandidates& rows = judged.candidates.rows;
    mean_.assign(count, Eigen::MatrixXd::Zero(rows.rows.cols(), rows.rows.cols()));
    std::vector<double> readings(count, 0);
    for (std::size_t i = 0; i < rows.count(); ++i) {
      const auto first = static_cast<Index>(rows.first_row[i]);
      const auto block = rows.rows.middleRows(first, static_cast<Index>(rows.first_row[i + 1]) - first);
      const std::size_t condition = judged.candidates.readings[i].condition;
      mean_[condition].noalias() += block.transpose() * block;
      ++readings[condition];
    }
    for (std::size_t c = 0; c < count; ++c) mean_[c] /= std::max(1.0, readings[c]);
  }

  /// mm; infinite where there is no time for readings.
  double uncertainty(const std::vector<std::size_t>& conditions) const {
    const std::size_t readings = readings_within(judged_.model, conditions);
    if (readings == 0) return kNoTime;
    Eigen::MatrixXd information = prior_;
    const double each = static_cast<double>(readings) / static_cast<double>(conditions.size());
    for (const std::size_t condition : conditions) information += each * mean_[condition];
    const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Cholesky factor(Eigen::MatrixXd(scale.asDiagonal() * information * scale.asDiagonal()));
    const Eigen::MatrixXd solved =
        factor.solve_columns(Eigen::MatrixXd(scale.asDiagonal() * prediction_ * scale.asDiagonal()));
    return std::sqrt(std::max(0.0, solved.trace()));
  }

 private:
  const ConditionsToJudge& judged_;
  Eigen::MatrixXd prior_, prediction_;
  std::vector<Eigen::MatrixXd> mean_;
};

/// One more condition than before, then each for another as long as that helps.
std::vector<std::size_t> one_more(const MeanInformation& mean, std::vector<std::size_t> chosen, std::size_t count,
                                  const std::stop_token& stop) {
  const auto best_at = [&](std::size_t place) {
    double best = mean.uncertainty(chosen);
    bool better = false;
    for (std::size_t c = 0; c < count; ++c) {
      stop_if_asked(stop);
      if (std::find(chosen.begin(), chosen.end(), c) != chosen.end()) continue;
      const std::size_t before = std::exchange(chosen[place], c);
      const double value = mean.uncertainty(chosen);
      if (value < best * (1 - 1e-9)) {
        best = value;
        better = true;
      } else {
        chosen[place] = before;
      }
    }
    return better;
  };
  std::size_t first = 0;
  while (std::find(chosen.begin(), chosen.end(), first) != chosen.end()) ++first;
  chosen.push_back(first);
  best_at(chosen.size() - 1);
  bool better = chosen.size() > 1;
  for (int pass = 0; better && pass < 3; ++pass) {
    better = false;
    for (std::size_t place = 0; place < chosen.size(); ++place) better = best_at(place) || better;
  }
  return chosen;
}

PlanningCandidates::Rows rows_of_candidates(const PlanningCandidates& all, const std::vector<std::size_t>& chosen) {
  Index count = 0;
  for (const std::size_t i : chosen) count += static_cast<Index>(all.first_row[i + 1] - all.first_row[i]);
  PlanningCandidates::Rows rows(count, all.rows.cols());
  Index next = 0;
  for (const std::size_t i : chosen)
    for (std::size_t k = all.first_row[i]; k < all.first_row[i + 1]; ++k)
      rows.row(next++) = all.rows.row(static_cast<Index>(k));
  return rows;
}

/// Directions that the candidates of some conditions leave open, of those that all candidates see.
void find_open(const ConditionsToJudge& judged, const PlanningSpace& space, ConditionsOfANumber& one) {
  std::vector<std::size_t> there;
  for (std::size_t i = 0; i < judged.candidates.readings.size(); ++i) {
    const std::size_t condition = judged.candidates.readings[i].condition;
    if (std::binary_search(one.conditions.begin(), one.conditions.end(), condition)) there.push_back(i);
  }
  const PlanValue value = value_of(space, there, Eigen::MatrixXd());
  one.open = space.dimension() - value.rank;
  if (one.open == 0) return;
  one.open_words = open_errors(judged.model, space, rows_of_candidates(judged.candidates.rows, there), value.rank);
}

/// What readings at these conditions are worth, chosen as a plan chooses them. More than kMostJudged are as many times
/// a choice of these: candidates are fewer than those of the plan itself.
void judge_choice(const ConditionsToJudge& judged, const PlanningSpace& with_prior, const WorkInStep& in_step,
                  ConditionsOfANumber& one) {
  const PlanningStudy& plan = *judged.model.study().planning;
  PlanningOptions options;
  options.threads = judged.model.study().threads;
  options.in_step = in_step;
  options.most_passes = 1;
  options.count = std::min(one.readings, kMostJudged);
  options.repeats = options.count;
  if (plan.goal != PlanningGoal::determinant) {
    options.criterion = PlanningCriterion::variance;
    options.functionals = plan.goal == PlanningGoal::volumetric ? judged.predictions : judged.model.parameter_rows();
  }
  for (const CandidateReading& reading : judged.candidates.readings) {
    options.eligible.push_back(std::binary_search(one.conditions.begin(), one.conditions.end(), reading.condition) ? 1
                                                                                                                   : 0);
  }
  ConditionGroups(judged.model).limit(judged.candidates, options);
  const ReadingPlan chosen = plan_readings(with_prior, options);
  if (chosen.status != PlanningStatus::done) return;
  const double times = static_cast<double>(one.readings) / static_cast<double>(options.count);
  const PlanningCandidates::Rows rows = rows_of_candidates(judged.candidates.rows, chosen.chosen) * std::sqrt(times);
  one.with_prior = uncertainty_with_prior(judged.model, rows, judged.predictions);
}

void mark_chosen(std::vector<ConditionsOfANumber>& curve) {
  std::size_t least_open = static_cast<std::size_t>(-1);
  for (const ConditionsOfANumber& one : curve) {
    if (one.with_prior > 0) least_open = std::min(least_open, one.open);
  }
  double best = kNoTime;
  for (const ConditionsOfANumber& one : curve) {
    if (one.with_prior > 0 && one.open == least_open) best = std::min(best, one.with_prior);
  }
  for (ConditionsOfANumber& one : curve) {
    if (!(one.with_prior > 0) || one.open != least_open || one.with_prior > (1 + kAsGoodConditions) * best) continue;
    one.chosen = true;
    return;
  }
}

/// Variance of each functional, [m], from an information matrix.
Eigen::VectorXd variances_by(const Eigen::MatrixXd& information, const Eigen::MatrixXd& functionals) {
  // Scaled, for lengths and angles differ by orders of magnitude.
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Cholesky factor(Eigen::MatrixXd(scale.asDiagonal() * information * scale.asDiagonal()));
  return factor.half_solve(scale.asDiagonal() * functionals.transpose()).colwise().squaredNorm().transpose();
}

Eigen::VectorXd variances_of(const PlanningSpace& space, const PlanningCandidates& readings,
                             const Eigen::MatrixXd& functionals) {
  const Eigen::MatrixXd seen = readings.rows * space.estimates_from_seen();
  return variances_by(seen.transpose() * seen + space.known_information(), space.functionals(functionals));
}

Eigen::VectorXd variances_with_prior(const PlanningModel& model, const PlanningCandidates& readings,
                                     const Eigen::MatrixXd& functionals) {
  return variances_by(
      readings.rows.transpose() * readings.rows + model.weak_prior() + model.known().transpose() * model.known(),
      functionals);
}

}  // namespace

double time_of_reading(const PlanningModel& model, bool together) {
  const Study& study = model.study();
  const PlanningStudy& plan = *study.planning;
  const PoseList poses = random_plan(study.machine, plan.axes, kPosesOfTravel, study.seed);
  double travel = 0;
  for (std::size_t k = 1; k < poses.count(); ++k) {
    travel += travel_time(plan, poses.pose(k - 1), poses.pose(k)) / static_cast<double>(kPosesOfTravel - 1);
  }
  const double sights = together ? static_cast<double>(std::max<std::size_t>(1, model.sight_count())) : 1;
  return std::max(1e-3, plan.reading + (plan.settle + kShortTravel * travel) / sights);
}

std::size_t readings_within(const PlanningModel& model, const std::vector<std::size_t>& conditions) {
  const PlanningStudy& plan = *model.study().planning;
  std::size_t most = plan.readings > 0 ? static_cast<std::size_t>(plan.readings) : static_cast<std::size_t>(-1);
  if (plan.time > 0) {
    const double each = time_of_reading(model, false);
    double left = plan.time - model.states().change_time(conditions);
    for (const Setup& setup : model.study().setups) left -= plan.set_up_of(setup.name);
    most = std::min(most, static_cast<std::size_t>(std::max(0.0, left / each)));
  }
  if (!model.states().has_course()) return most;
  const std::vector<std::size_t> room = ConditionGroups(model).room;
  std::size_t all = 0;
  for (const std::size_t condition : conditions) all += room[condition];
  return std::min(most, all);
}

std::vector<ConditionsOfANumber> choose_conditions(const ConditionsToJudge& judged, const JobOptions& job) {
  const PlanningModel& model = judged.model;
  const std::vector<PlanningCondition>& all = model.states().conditions();
  const auto count = static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [](const PlanningCondition& one) { return one.possible; }));
  const std::size_t wanted = model.study().planning->conditions;
  const std::size_t most = std::min(count, wanted > 0 ? wanted : kMostConditionsTried);
  const PlanningSpace space(judged.candidates.rows, model.known());
  const Eigen::VectorXd prior = model.weak_prior().diagonal().cwiseSqrt();
  Eigen::MatrixXd known(model.known().rows() + prior.size(), prior.size());
  known.topRows(model.known().rows()) = model.known();
  known.bottomRows(prior.size()) = Eigen::MatrixXd(prior.asDiagonal());
  const PlanningSpace with_prior(judged.candidates.rows, known);
  const MeanInformation mean(judged);
  std::vector<ConditionsOfANumber> curve;
  std::vector<std::size_t> chosen;
  while (curve.size() < most) {
    chosen = one_more(mean, chosen, count, job.stop);
    ConditionsOfANumber one;
    one.conditions = chosen;
    std::sort(one.conditions.begin(), one.conditions.end());
    one.readings = readings_within(model, one.conditions);
    if (one.readings > 0) {
      find_open(judged, space, one);
      judge_choice(judged, with_prior, job.in_step, one);
    }
    curve.push_back(std::move(one));
  }
  mark_chosen(curve);
  return curve;
}

ConditionGroups::ConditionGroups(const PlanningModel& model) {
  if (!model.states().has_course()) return;
  const double quickest = time_of_reading(model, true);
  for (const PlanningCondition& slot : model.states().conditions()) {
    const double time = slot.to_s - slot.from_s - model.states().visit_time();
    room.push_back(static_cast<std::size_t>(std::max(0.0, time / quickest)));
  }
}

void ConditionGroups::limit(const PlanningModel::Candidates& candidates, PlanningOptions& options) const {
  if (room.empty()) return;
  options.most_of_group = room;
  options.group.clear();
  for (const CandidateReading& reading : candidates.readings) {
    options.group.push_back(static_cast<std::uint32_t>(reading.condition));
  }
}

bool ConditionGroups::shrink(const PlanningModel& model, const std::vector<CandidateReading>& readings) {
  if (room.empty()) return false;
  const std::vector<PlanningCondition>& slots = model.states().conditions();
  const std::vector<double> times = reading_times(model.study(), readings, model.states());
  bool any = false;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const bool last = k + 1 == readings.size() || readings[k + 1].condition != readings[k].condition;
    const std::size_t condition = readings[k].condition;
    const PlanningCondition& slot = slots[condition];
    if (!last || !(times[k] > slot.to_s)) continue;
    const auto taken = static_cast<double>(std::count_if(
        readings.begin(), readings.end(), [&](const CandidateReading& one) { return one.condition == condition; }));
    const double share = (slot.to_s - slot.from_s) / (times[k] - slot.from_s);
    room[condition] = std::min(room[condition], static_cast<std::size_t>(0.97 * share * taken));
    any = true;
  }
  return any;
}

bool ConditionGroups::fit(const PlanningModel& model, const std::vector<CandidateReading>& readings) {
  if (!model.states().has_course()) return true;
  const std::vector<double> times = reading_times(model.study(), readings, model.states());
  for (std::size_t k = 0; k < readings.size(); ++k) {
    if (times[k] > model.states().conditions()[readings[k].condition].to_s) return false;
  }
  return true;
}

void judge_over_states(const PlanningModel& model, const PlanningSpace& space, const Eigen::MatrixXd& predictions,
                       StudyPlan& result) {
  const PlannedStates& states = model.states();
  const bool drifting = has_drift(model.study());
  if (!states.any() && !drifting) return;
  if (states.has_course()) {
    result.reading_states = states.at_times(reading_times(model.study(), result.readings, states));
  } else if (states.any()) {
    for (const CandidateReading& reading : result.readings) {
      result.reading_states.push_back(states.conditions()[reading.condition].states);
    }
  }
  const auto root_mean = [&predictions](const Eigen::VectorXd& variance) {
    return std::sqrt(variance.sum() / (static_cast<double>(predictions.rows()) / 3));
  };
  const auto variances = [&](const PlanningCandidates& rows) {
    // What is open has no uncertainty without prior knowledge.
    return leaves_states_open(result) ? variances_with_prior(model, rows, predictions)
                                      : variances_of(space, rows, predictions);
  };
  const PlanningCandidates rows = rows_as_taken(model, result.readings);
  if (!value_of(space, rows, predictions).determined) {
    result.plan.status = PlanningStatus::not_determined;
    return;
  }
  const Eigen::VectorXd variance = variances(rows);
  result.uncertainty = root_mean(variance);
  if (drifting) result.drift.still = root_mean(variances(model.rows_of(result.readings, result.reading_states)));
  result.with_prior = uncertainty_with_prior(model, rows.rows, predictions);
  if (!states.any()) return;
  const std::size_t used = states.used_at().size();
  std::vector<double> sum(used, 0), number(used, 0);
  for (Index row = 0; row < variance.size(); ++row) {
    const std::size_t at = static_cast<std::size_t>(row / 3) % used;
    sum[at] += variance[row];
    number[at] += 1.0 / 3;
  }
  for (std::size_t k = 0; k < used; ++k) {
    result.over_states.push_back({states.used_at()[k], states.has_course() ? states.used_at_time()[k] : 0,
                                  std::sqrt(sum[k] / std::max(1.0, number[k]))});
  }
  result.sensors = planned_sensors(model, rows, predictions, result.reading_states);
}

}  // namespace abbe
