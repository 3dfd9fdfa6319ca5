#include "study/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/formats/measurement_file.h"
#include "abbe/identify/prediction.h"
#include "abbe/instruments/tracker_start.h"

namespace abbe {
namespace {

/// Predictions of one set-up's observations with their uncertainty, for readings that take no part in the fit.
struct Prediction {
  std::vector<double> error;        ///< length of measured - modelled, mm
  std::vector<double> uncertainty;  ///< root of the trace of the prediction's covariance, mm
  std::size_t within = 0, coordinates = 0;
};

/// @param observations  weighted with 1 um in every coordinate, so that residuals and derivatives are in um
Prediction predict(const TrackerObservations& observations, const Identification& identification, std::size_t setup) {
  // Columns of the covariance that these observations depend on.
  std::vector<std::size_t> machine, unknowns;
  std::vector<Eigen::Index> columns;
  for (std::size_t i = 0; i < identification.parameters.size(); ++i) {
    const ParameterId& id = identification.parameters[i].id;
    if (id.is_machine()) {
      machine.push_back(id.index);
      columns.push_back(static_cast<Eigen::Index>(i));
    }
  }
  for (std::size_t i = 0; i < identification.parameters.size(); ++i) {
    const ParameterId& id = identification.parameters[i].id;
    if (!id.is_machine() && id.observations == setup) {
      unknowns.push_back(id.index);
      columns.push_back(static_cast<Eigen::Index>(i));
    }
  }
  const Eigen::Index p = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd covariance(p, p);
  for (Eigen::Index i = 0; i < p; ++i) {
    for (Eigen::Index j = 0; j < p; ++j) {
      covariance(i, j) =
          identification.covariance(columns[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(j)]);
    }
  }

  Prediction prediction;
  constexpr std::size_t kBlock = Observations::kBlockSize;
  const std::size_t count = observations.reading_count();
  std::vector<double> residuals(3 * kBlock);
  Eigen::MatrixXd jacobian(3 * kBlock, p);
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t n = std::min(kBlock, count - first);
    jacobian.resize(static_cast<Eigen::Index>(3 * n), p);
    observations.evaluate(first, n, machine, unknowns, residuals.data(), jacobian.data(), 3 * n);
    const Eigen::MatrixXd propagated = jacobian * covariance;
    for (std::size_t k = 0; k < n; ++k) {
      double square = 0, variance = 0;
      for (std::size_t row = 0; row < 3; ++row) {
        const Eigen::Index index = static_cast<Eigen::Index>(row * n + k);
        const double r = residuals[row * n + k];
        const double v = propagated.row(index).dot(jacobian.row(index));
        square += r * r;
        variance += v;
        prediction.within += std::abs(r) <= 2 * std::sqrt(std::max(v, 0.0)) ? 1U : 0U;
        ++prediction.coordinates;
      }
      prediction.error.push_back(1e-3 * std::sqrt(square));
      prediction.uncertainty.push_back(1e-3 * std::sqrt(std::max(variance, 0.0)));
    }
  }
  return prediction;
}

void weigh_in_micrometres(TrackerSetup& setup, TrackerReadings& readings) {
  for (TrackerStation& station : setup.stations) station.noise = TrackerNoise::isotropic(1, 0);
  readings.stated = StatedUncertainty::none;
  readings.uncertainty = {};
}

/// The readings held out of the fit (or used in it), as a list of their own.
TrackerReadings select(const TrackerReadings& all, const std::vector<std::uint8_t>& use, bool used) {
  TrackerReadings part;
  part.measure = all.measure;
  part.stated = all.stated;
  part.poses.axis.resize(all.poses.axis.size());
  for (std::size_t k = 0; k < all.count(); ++k) {
    if ((use.empty() || use[k] != 0) != used) continue;
    for (std::size_t i = 0; i < all.poses.axis.size(); ++i) part.poses.axis[i].push_back(all.poses.axis[i][k]);
    part.station.push_back(all.station[k]);
    part.reflector.push_back(all.reflector[k]);
    for (std::size_t i = 0; i < 3; ++i) part.measured[i].push_back(all.measured[i][k]);
    if (!all.time_s.empty()) part.time_s.push_back(all.time_s[k]);
    for (std::size_t i = 0; i < 6; ++i) {
      if (!all.uncertainty[i].empty()) part.uncertainty[i].push_back(all.uncertainty[i][k]);
    }
  }
  return part;
}

/// Distances of the nominal machine from points, with station poses fitted to them.
std::vector<double> nominal_errors(const Machine& machine, TrackerSetup setup, const TrackerReadings& readings) {
  apply(find_station_poses(machine, ErrorSet{}, setup, readings), setup);
  const TrackerObservations observations(machine, ErrorSet{}, setup, readings);
  std::vector<double> errors(readings.count());
  for (std::size_t k = 0; k < errors.size(); ++k) errors[k] = observations.distance(k).norm();
  return errors;
}

void add_prediction(const Prediction& prediction, UnseenPoses& unseen, std::size_t& within, std::size_t& coordinates) {
  unseen.after.insert(unseen.after.end(), prediction.error.begin(), prediction.error.end());
  for (double u : prediction.uncertainty) unseen.expanded_uncertainty.push_back(2 * u);
  within += prediction.within;
  coordinates += prediction.coordinates;
}

}  // namespace

IdentifyOptions identify_options(const Study& study) {
  const IdentificationPlan& plan = *study.identification;
  IdentifyOptions options;
  options.solver.max_iterations = plan.max_iterations;
  options.solver.relative_cost = plan.tolerance;
  options.solver.threads = study.threads;
  options.loss = plan.loss;
  options.loss_tuning = plan.loss_scale;
  return options;
}

AxisRange known_range(const Machine& machine, const ErrorSet& errors, std::size_t axis, std::size_t count) {
  AxisRange range = full_ranges(machine, count)[axis];
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.axis != axis || motion.basis.periodic) continue;
    const Basis& basis = motion.basis;
    if (basis.kind == BasisKind::fourier && basis.to - basis.from >= basis.period * (1 - 1e-9)) continue;
    range.from = std::max(range.from, basis.from);
    range.to = std::min(range.to, basis.to);
  }
  range.count = range.is_fixed() ? 1 : count;
  return range;
}

void identify_study(const Study& study, StudyResult& result, const ProgressCallback& progress) {
  find_start_poses(study.machine, result.campaign);
  result.model = build_model(study, result.campaign);
  result.warnings = result.campaign.warnings;
  if (!result.model.impossible.empty()) {
    result.identification.status = IdentifyStatus::rank_deficient;
    result.identification.message = result.model.impossible;
    return;
  }
  const IdentificationPlan& plan = *study.identification;
  Problem& problem = result.model.problem;
  const IdentifyOptions options = identify_options(study);
  if (!result.model.order_groups.empty()) {
    OrderSelectionOptions selection;
    selection.seed = study.seed;
    selection.identify = options;
    result.order_selection = select_orders(problem, result.model.order_groups, selection);
    if (result.order_selection->done) problem.machine_parameters = result.order_selection->machine_parameters;
  }
  StagedIdentification staged = identify_in_stages(problem, plan.strategy, options);
  result.stages = std::move(staged.stages);
  result.identification = std::move(staged.total);
  // What a convention fixes is listed with the gauge; what had to be fixed without one is a warning.
  for (const GaugeConstraint& constraint : result.identification.gauge.constraints) {
    if (!constraint.by_convention) result.warnings.push_back(constraint.words + ": " + constraint.inseparable_words);
  }
  if (!result.usable()) return;
  if (plan.monte_carlo > 0) {
    MonteCarloOptions monte_carlo_options;
    monte_carlo_options.samples = static_cast<std::size_t>(plan.monte_carlo);
    monte_carlo_options.seed = study.seed;
    monte_carlo_options.threads = study.threads;
    result.monte_carlo = monte_carlo(problem, result.identification, monte_carlo_options);
  }
  if (progress) progress(1, 1);
}

UnseenPoses evaluate_unseen(const Study& study, const StudyResult& result, std::size_t poses) {
  const Machine& machine = study.machine;
  const ErrorSet& identified = result.identification.errors;
  UnseenPoses unseen;
  unseen.against_truth = result.campaign.truth.has_value();
  std::size_t within = 0, coordinates = 0;
  for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
    const CampaignSetup& setup = result.campaign.setups[s];
    TrackerReadings readings;
    if (unseen.against_truth) {
      std::vector<AxisRange> ranges;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) ranges.push_back(known_range(machine, identified, i, 2));
      TrackerSimulationOptions options;
      options.noise_factor = 0;
      options.line_of_sight = false;
      options.choice = SightChoice::cycle;
      options.threads = study.threads;
      const PoseList list = random_plan(machine, ranges, poses, study.seed * 7919 + s);
      readings = simulate_tracker(machine, *result.campaign.truth, setup.truth, list, options).readings;
    } else if (study.identification->held_out_file) {
      if (s > 0) continue;
      readings = read_held_out(study, result.campaign);
    } else {
      readings = select(setup.readings, result.model.problem.observations[s].use, false);
      if (readings.count() == 0) continue;
    }
    const std::vector<double> before =
        nominal_errors(machine, unseen.against_truth ? setup.truth : setup.start, readings);
    unseen.before.insert(unseen.before.end(), before.begin(), before.end());
    // The observations carry the identified poses and offsets; build them as the fit did, so that the unknowns
    // correspond.
    TrackerSetup weighed = setup.start;
    weigh_in_micrometres(weighed, readings);
    TrackerObservations observations(machine, identified, weighed, readings);
    observations.set_parameters(identified.parameters(), result.identification.setup[s]);
    add_prediction(predict(observations, result.identification, s), unseen, within, coordinates);
  }
  unseen.coverage = coordinates > 0 ? static_cast<double>(within) / static_cast<double>(coordinates) : 0;
  unseen.before_statistics = sample_statistics(unseen.before);
  unseen.after_statistics = sample_statistics(unseen.after);
  unseen.uncertainty_statistics = sample_statistics(unseen.expanded_uncertainty);
  unseen.description =
      unseen.against_truth
          ? fmt::format("{} random poses that were not measured, against the simulated truth", unseen.after.size())
          : fmt::format("{} readings held out of the fit", unseen.after.size());
  return unseen;
}

StudyMap map_study(const Study& study, const StudyResult& result, const ProgressCallback& progress) {
  const Machine& machine = study.machine;
  const ErrorSet& identified = result.identification.errors;
  StudyMap map;
  if (study.map && study.map->poses_file) {
    map.poses = read_poses(*study.map->poses_file, machine);
    map.description = fmt::format("{} poses of {}", map.poses.count(), study.map->poses_file->filename().string());
  } else {
    std::vector<AxisRange> ranges;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      ranges.push_back(study.map ? study.map->axes[i]
                                 : known_range(machine, identified, i, machine.axes.size() > 3 ? 5 : 9));
    }
    PoseGrid grid;
    for (const AxisRange& range : ranges) {
      map.grid.push_back(range.is_fixed() ? 1 : range.count);
      grid.values.push_back(evenly_spaced(range.from, range.to, map.grid.back()));
    }
    const PoseSource source = pose_source(grid);
    map.poses.axis.assign(machine.axes.size(), std::vector<double>(source.count));
    std::vector<double*> pointers;
    for (std::vector<double>& values : map.poses.axis) pointers.push_back(values.data());
    source.fill(0, source.count, pointers.data());
    map.description = "grid of";
    for (std::size_t i = 0; i < map.grid.size(); ++i)
      map.description += fmt::format("{} {}", i == 0 ? "" : " x", map.grid[i]);
    map.description += " poses";
  }
  const PoseSource poses = pose_source(map.poses);
  ErrorMapOptions options;
  options.remove_rigid_motion = true;
  options.threads = study.threads;
  options.progress = progress;
  map.against_truth = result.campaign.truth.has_value();
  ParameterCovariance covariance;
  covariance.covariance = machine_covariance(result.identification, identified.parameter_count());
  for (std::size_t p = 0; p < identified.parameter_count(); ++p) covariance.parameters.push_back(p);
  ErrorMapOptions with_uncertainty = options;
  with_uncertainty.covariance = &covariance;
  map.predicted = error_map(machine, identified, nullptr, poses, with_uncertainty);
  if (map.against_truth) {
    map.before = error_map(machine, *result.campaign.truth, nullptr, poses, options);
    map.after = error_map(machine, *result.campaign.truth, &identified, poses, options);
  } else {
    map.before = map.predicted;
  }
  return map;
}

}  // namespace abbe
