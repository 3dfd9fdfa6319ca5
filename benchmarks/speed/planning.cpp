// Time to choose 300 readings from 10,000: random rows, and laser tracker readings on a five-axis trunnion machine.
//
//   planning [candidates] [chosen]     exit code 1 if one of the plans needs 20 s or more
#include "abbe/plan/readings/planning.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "abbe/geometry/rotation.h"
#include "abbe/identify/planning_candidates.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "five_axis_case.h"

namespace abbe::benchmarks {
namespace {

constexpr double kLimit_s = 20;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

PlanningCandidates random_rows(std::size_t count, std::size_t parameters) {
  PlanningCandidates candidates;
  candidates.rows.resize(static_cast<Eigen::Index>(3 * count), static_cast<Eigen::Index>(parameters));
  RandomStream random(1);
  for (Eigen::Index i = 0; i < candidates.rows.size(); ++i) candidates.rows.data()[i] = random.normal();
  for (std::size_t i = 0; i <= count; ++i) candidates.first_row.push_back(3 * i);
  return candidates;
}

/// Random poses over the travel, three reflectors in turn, one tracker beside the table, pose unknown.
PlanningCandidates tracker_rows(std::size_t count) {
  FiveAxisCase data;
  ErrorSet errors;
  for (ErrorMotion motion : data.errors.motions) {
    motion.basis.order = 3;
    motion.coefficients.assign(motion.basis.size(), 0.0);
    errors.motions.push_back(motion);
  }
  TrackerSetup setup;
  TrackerStation station;
  station.body_from_tracker = {rotation_from_error_angles({0.03, -0.02, 0.5}), {900, -200, 150}};
  station.noise = TrackerNoise::isotropic(5, 5);
  setup.stations = {station};
  const double offsets[3][3] = {{60, 0, -150}, {0, 80, -250}, {-70, -30, -100}};
  for (const auto& offset : offsets) {
    setup.reflectors.emplace_back();
    setup.reflectors.back().offset = {offset[0], offset[1], offset[2]};
  }
  TrackerSimulationOptions options;
  options.choice = SightChoice::cycle;
  options.noise_factor = 0;
  const PoseList poses = random_plan(data.machine, full_ranges(data.machine, 2), count, 1);
  const TrackerReadings readings = simulate_tracker(data.machine, errors, setup, poses, options).readings;
  TrackerObservations observations(data.machine, errors, setup, readings);
  const Problem problem = estimate_everything(data.machine, errors, {borrowed(observations)});
  return candidate_rows(problem);
}

bool run(const char* name, const PlanningCandidates& candidates, std::size_t chosen) {
  const auto start = std::chrono::steady_clock::now();
  const PlanningSpace space(candidates, Eigen::MatrixXd());
  const double factorised = seconds_since(start);
  std::printf("%s: %zu candidates, %zu parameters, rank %zu; space in %.2f s\n", name, space.count(),
              space.parameter_count(), space.dimension(), factorised);
  bool quick = true;
  for (const char* const criterion : {"D, determinant", "A, all parameters", "V, 200 predictions"}) {
    PlanningOptions options;
    options.count = chosen;
    if (criterion[0] != 'D') {
      const Eigen::Index p = static_cast<Eigen::Index>(space.parameter_count());
      options.criterion = PlanningCriterion::variance;
      options.functionals =
          criterion[0] == 'A'
              ? Eigen::MatrixXd(Eigen::MatrixXd::Identity(p, p))
              : Eigen::MatrixXd(candidates.rows.topRows(std::min<Eigen::Index>(600, candidates.rows.rows())));
    }
    const auto begin = std::chrono::steady_clock::now();
    const ReadingPlan plan = plan_readings(space, options);
    const double time = seconds_since(begin) + factorised;
    quick = quick && time < kLimit_s && plan.status == PlanningStatus::done;
    const double first = plan.history.front(), last = plan.history.back();
    std::printf(
        "  %s, %zu chosen: %s in %.2f s (space included), %zu exchanges in %zu passes, criterion %.6g to %.6g\n",
        criterion, plan.chosen.size(), status_text(plan.status), time, plan.exchanges, plan.passes, first, last);
  }
  return quick;
}

}  // namespace
}  // namespace abbe::benchmarks

int main(int count, char** arguments) {
  using namespace abbe::benchmarks;
  const std::size_t candidates = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 10000;
  const std::size_t chosen = count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 300;
  const bool random = run("random rows", random_rows(candidates, 150), chosen);
  const bool tracker = run("tracker on a trunnion machine", tracker_rows(candidates), chosen);
  return random && tracker ? 0 : 1;
}
