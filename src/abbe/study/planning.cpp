#include "abbe/study/planning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <set>
#include <tuple>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kPredictionPoses = 200;
constexpr double kShares[] = {0.3, 0.4, 0.5, 0.65, 0.8, 1, 1.25, 1.6, 2};
constexpr int kTimeRounds = 6;
constexpr std::size_t kRandomDraws = 9;
constexpr int kRefinements = 4;
constexpr std::size_t kPosesAround = 6;
constexpr double kWholeTurn = 2 * std::numbers::pi * 0.99;
constexpr double kAtAnEnd = 0.4;

double move_time(const PlanningStudy& plan, const std::vector<double>& from, const std::vector<double>& to) {
  double longest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]) / plan.speed[i]);
  return longest;
}

/// Random poses over the ranges. The best places of polynomials are the ends and the middle of a range, which random
/// positions of five axes never meet together: in every second pose each axis with two ends stands at one of these.
PoseList candidate_poses(const Machine& machine, const PlanningStudy& plan, std::uint64_t seed) {
  PoseList poses = random_plan(machine, plan.axes, static_cast<std::size_t>(plan.candidates), seed);
  for (std::size_t k = 1; k < poses.count(); k += 2) {
    RandomStream random(seed + 1, k);
    for (std::size_t i = 0; i < plan.axes.size(); ++i) {
      const AxisRange& range = plan.axes[i];
      const double share = random.uniform();
      const bool turn = machine.axes[i].kind == AxisKind::rotary && range.to - range.from > kWholeTurn;
      if (turn || range.step > 0) continue;
      poses.axis[i][k] = share < kAtAnEnd ? range.from : share < 2 * kAtAnEnd ? range.to : (range.from + range.to) / 2;
    }
  }
  return poses;
}

/// The poses of readings, and beside each some in which one or two axes stand elsewhere (coordinate exchange; Meyer and
/// Nachtsheim, Technometrics 37 (1995) 60): at an end, in the middle, or anywhere.
PoseList poses_around(const PlanningStudy& plan, const std::vector<SightReading>& readings, std::uint64_t seed) {
  PoseList poses;
  std::set<std::vector<double>> known;
  for (const SightReading& reading : readings)
    if (known.insert(reading.pose).second) poses.append(reading.pose);
  const std::size_t given = poses.count();
  for (std::size_t k = 0; k < given; ++k)
    for (std::size_t n = 0; n < kPosesAround; ++n) {
      RandomStream random(seed, k * kPosesAround + n);
      std::vector<double> pose = poses.pose(k);
      for (std::size_t change = 0; change < 1 + n % 2; ++change) {
        const std::size_t i =
            std::min(pose.size() - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(pose.size())));
        const AxisRange& range = plan.axes[i];
        const double share = random.uniform(), anywhere = random.uniform(range.from, range.to);
        pose[i] = share < 0.25   ? range.from
                  : share < 0.5  ? range.to
                  : share < 0.65 ? (range.from + range.to) / 2
                                 : anywhere;
      }
      if (known.insert(pose).second) poses.append(pose);
    }
  return poses;
}

/// Same readings, poses in an order of short travel; all readings of one pose together.
std::vector<SightReading> by_travel(const Machine& machine, const std::vector<SightReading>& readings) {
  std::map<std::vector<double>, std::vector<SightReading>> at;
  PoseList poses;
  for (const SightReading& reading : readings) {
    std::vector<SightReading>& here = at[reading.pose];
    if (here.empty()) poses.append(reading.pose);
    here.push_back(reading);
  }
  const PoseList ordered = order_by_travel(machine, poses);
  std::vector<SightReading> result;
  for (std::size_t k = 0; k < ordered.count(); ++k)
    for (const SightReading& reading : at[ordered.pose(k)]) result.push_back(reading);
  return result;
}

double total_time(const PlanningStudy& plan, const std::vector<SightReading>& readings) {
  double time = 0;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    time += plan.reading;
    if (k > 0 && readings[k].pose == readings[k - 1].pose) continue;
    time += plan.settle + (k > 0 ? move_time(plan, readings[k - 1].pose, readings[k].pose) : 0);
  }
  return time;
}

/// Who looks at what from where.
using ReadingPlace = std::tuple<std::vector<double>, std::size_t, std::size_t, std::size_t>;
ReadingPlace place_of(const SightReading& reading) {
  return {reading.pose, reading.setup, reading.station, reading.reflector};
}

double root_mean_square(const PlanValue& value, const Eigen::MatrixXd& predictions) {
  return std::sqrt(value.variance / (static_cast<double>(predictions.rows()) / 3));
}

/// As many candidates as the plan has, without any choice.
void try_at_random(const PlanningSpace& space, const Eigen::MatrixXd& predictions, std::uint64_t seed,
                   StudyPlan& result) {
  std::vector<double> found;
  for (std::size_t draw = 0; draw < kRandomDraws; ++draw) {
    RandomStream random(seed + 2, draw);
    std::vector<std::size_t> order(space.count());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (std::size_t k = 0; k < result.readings.size(); ++k) {
      const double left = static_cast<double>(order.size() - k);
      std::swap(order[k], order[k + std::min(order.size() - k - 1, static_cast<std::size_t>(random.uniform() * left))]);
    }
    order.resize(result.readings.size());
    const PlanValue value = value_of(space, order, predictions);
    if (value.determined) found.push_back(root_mean_square(value, predictions));
  }
  result.random_tried = kRandomDraws;
  if (found.size() < (kRandomDraws + 1) / 2) return;
  std::sort(found.begin(), found.end());
  result.random_poses = PlanPoint{result.readings.size(), true, found[found.size() / 2], 0};
}

void say_what_is_enough(const PlanningStudy& plan, StudyPlan& result) {
  std::vector<std::size_t> counts, places;
  std::vector<double> uncertainty;
  for (std::size_t k = 0; k < result.curve.size(); ++k) {
    if (!result.curve[k].determined) continue;
    counts.push_back(result.curve[k].readings);
    uncertainty.push_back(result.curve[k].uncertainty);
    places.push_back(k);
  }
  result.enough = result.curve.size();
  if (plan.target > 0) {
    for (std::size_t k = uncertainty.size(); k-- > 0 && uncertainty[k] <= plan.target;) result.enough = places[k];
    result.enough_words = result.enough < result.curve.size()
                              ? fmt::format("the first of these numbers that reaches {:.4g} um", 1e3 * plan.target)
                              : fmt::format("none of these numbers reaches {:.4g} um", 1e3 * plan.target);
    return;
  }
  if (counts.size() < 2) {
    result.enough_words = "too few points of the curve determine everything";
    return;
  }
  const std::size_t enough = enough_points(counts, uncertainty);
  if (enough < counts.size()) {
    result.enough = places[enough];
    result.enough_words = "from here on, more readings only average noise";
  } else {
    result.enough_words = "the uncertainty still falls faster than by averaging: more readings are worth it";
  }
}

}  // namespace

StudyPlan plan_study(const Study& study, const std::function<void(double)>& progress) {
  const PlanningModel model(study);
  const PlanningStudy& plan = *study.planning;
  const PoseList poses =
      plan.grid ? grid_plan(study.machine, plan.axes) : candidate_poses(study.machine, plan, study.seed);
  PlanningModel::Candidates candidates = model.readings_at(poses);
  StudyPlan result;
  result.candidates = candidates.readings.size();
  result.hidden = candidates.hidden;
  result.forbidden = candidates.forbidden;
  if (result.candidates == 0) {
    throw InputError({.field = "plan"}, "no candidate has a line of sight outside the forbidden boxes",
                     "other stations, reflectors, ranges or boxes");
  }
  auto space = std::make_unique<const PlanningSpace>(candidates.rows, model.known());
  result.parameters = space->parameter_count();
  result.seen = space->dimension();
  const Eigen::MatrixXd predictions =
      model.prediction_rows(random_plan(study.machine, plan.axes, kPredictionPoses, study.seed * 7919 + 1));
  const Eigen::VectorXd unseen = space->unseen_part(predictions);
  // Rows that are zero but for rounding have no direction.
  const Eigen::VectorXd sizes = space->functionals(predictions).rowwise().norm();
  for (Eigen::Index i = 0; i < unseen.size(); ++i)
    if (sizes[i] > 1e-9 * sizes.maxCoeff()) result.unseen_part = std::max(result.unseen_part, unseen[i]);

  PlanningOptions options;
  options.threads = study.threads;
  options.seed = study.seed;
  if (plan.goal != PlanningGoal::determinant) {
    options.criterion = PlanningCriterion::variance;
    options.functionals = plan.goal == PlanningGoal::volumetric ? predictions : model.parameter_rows();
  }
  if (progress) options.progress = [&](double share) { progress(0.6 * share); };

  const double quickest = plan.reading + plan.settle / static_cast<double>(model.sight_count());
  std::size_t count = plan.readings > 0 ? static_cast<std::size_t>(plan.readings) : result.candidates;
  if (plan.time > 0 && quickest > 0)
    count = std::min(count, static_cast<std::size_t>(std::max(1.0, plan.time / quickest)));
  const auto take = [&](const ReadingPlan& chosen, const PlanningModel::Candidates& from) {
    result.plan = chosen;
    result.readings.clear();
    for (const std::size_t i : chosen.chosen) result.readings.push_back(from.readings[i]);
    result.readings = by_travel(study.machine, result.readings);
    result.time = total_time(plan, result.readings);
  };
  for (int round = 0; round < kTimeRounds; ++round) {
    options.count = std::min(count, result.candidates);
    take(plan_readings(*space, options), candidates);
    if (result.plan.status != PlanningStatus::done || plan.time <= 0 || result.time <= plan.time) break;
    count =
        static_cast<std::size_t>(std::max(1.0, 0.99 * static_cast<double>(options.count) * plan.time / result.time));
  }
  if (result.plan.status != PlanningStatus::done) return result;
  try_at_random(*space, predictions, study.seed, result);

  const bool may_stand_anywhere = !plan.grid && std::none_of(plan.axes.begin(), plan.axes.end(),
                                                             [](const AxisRange& range) { return range.step > 0; });
  options.progress = nullptr;
  for (int round = 0; round < kRefinements && may_stand_anywhere; ++round) {
    PlanningModel::Candidates around =
        model.readings_at(poses_around(plan, result.readings, study.seed * 31 + static_cast<std::uint64_t>(round)));
    auto space_around = std::make_unique<const PlanningSpace>(around.rows, model.known());
    if (space_around->dimension() != space->dimension()) break;
    std::map<ReadingPlace, std::size_t> places;
    for (std::size_t i = 0; i < around.readings.size(); ++i) places[place_of(around.readings[i])] = i;
    PlanningOptions refined = options;
    refined.count = result.plan.chosen.size();
    for (const SightReading& reading : result.readings) refined.start.push_back(places.at(place_of(reading)));
    const ReadingPlan better = plan_readings(*space_around, refined);
    if (better.status != PlanningStatus::done) break;
    const StudyPlan before = result;
    take(better, around);
    if (plan.time > 0 && result.time > plan.time) {
      result = before;
      break;
    }
    candidates = std::move(around);
    space = std::move(space_around);
    result.refinements = round + 1;
    if (progress) progress(0.6 + 0.2 * (round + 1) / kRefinements);
  }
  result.uncertainty = root_mean_square(value_of(*space, result.plan.chosen, predictions), predictions);
  const auto rows_of = [&](const std::vector<std::size_t>& chosen) {
    std::size_t count_rows = 0;
    for (const std::size_t i : chosen) count_rows += candidates.rows.first_row[i + 1] - candidates.rows.first_row[i];
    PlanningCandidates::Rows rows(static_cast<Eigen::Index>(count_rows), candidates.rows.rows.cols());
    Eigen::Index next = 0;
    for (const std::size_t i : chosen)
      for (std::size_t k = candidates.rows.first_row[i]; k < candidates.rows.first_row[i + 1]; ++k)
        rows.row(next++) = candidates.rows.rows.row(static_cast<Eigen::Index>(k));
    return rows;
  };
  result.with_prior = uncertainty_with_prior(model, rows_of(result.plan.chosen), predictions);

  PlanningOptions curve_options = options;
  curve_options.most_passes = 2;
  std::vector<std::size_t> counts;
  for (const double share : kShares) {
    const auto number = static_cast<std::size_t>(share * static_cast<double>(result.readings.size()));
    if (number >= 1 && number <= space->count() && (counts.empty() || number > counts.back())) counts.push_back(number);
  }
  const std::vector<ReadingPlan> curve = plan_curve(*space, curve_options, counts);
  for (std::size_t k = 0; k < curve.size(); ++k) {
    PlanPoint point{counts[k], curve[k].status == PlanningStatus::done, 0, 0};
    if (point.determined) point.with_prior = uncertainty_with_prior(model, rows_of(curve[k].chosen), predictions);
    if (point.determined)
      point.uncertainty = root_mean_square(value_of(*space, curve[k].chosen, predictions), predictions);
    result.curve.push_back(point);
  }
  say_what_is_enough(plan, result);
  if (progress) progress(0.85);
  compare_with_grids(model, *space, predictions, result);
  result.not_identified = find_not_in_model(study, model.errors());
  if (progress) progress(1);
  return result;
}

}  // namespace abbe
