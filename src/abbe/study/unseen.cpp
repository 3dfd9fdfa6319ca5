#include "abbe/study/unseen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/identify/identify.h"
#include "abbe/identify/prediction.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/tracker_start.h"
#include "abbe/study/instrument_campaign.h"
#include "abbe/study/job.h"
#include "abbe/study/predicted_readings.h"
#include "abbe/study/random_poses.h"
#include "abbe/study/tracker_campaign.h"
#include "abbe/verify/compensated_poses.h"
#include "abbe/verify/determined_part.h"
#include "abbe/verify/error_map.h"

namespace abbe {
namespace {

/// What is added up over the set-ups.
struct Tally {
  UnseenPoses& unseen;
  std::size_t within = 0, coordinates = 0;
  double noise_square = 0;  ///< sum of squares of residuals over stated uncertainties
  std::size_t noise_count = 0;

  void add(const PredictedReadings& prediction) {
    unseen.after.insert(unseen.after.end(), prediction.error.begin(), prediction.error.end());
    for (const double u : prediction.uncertainty) unseen.expanded_uncertainty.push_back(2 * u);
    within += prediction.within;
    coordinates += prediction.coordinates;
  }
  /// @param observations  at the identified values, weighted with the uncertainties that are stated for the readings
  void add_against_noise(const Observations& observations) {
    for (const double residual : residuals_by_reading(observations)) noise_square += residual * residual;
    noise_count += observations.reading_count() * static_cast<std::size_t>(observations.rows());
  }
};

/// @param observations  readings that were held out, weighted as stated; takes them to the estimates
void add_coverage(const StudyResult& result, std::size_t s, Observations& observations, Tally& tally) {
  if (!result.weighed || tally.unseen.against_truth) return;
  const Identification& identified = result.identification;
  observations.set_parameters(identified.errors.parameters(), identified.setup[s]);
  if (!tally.unseen.readings) tally.unseen.readings.emplace();
  tally.unseen.readings->add(reading_coverage(observations, identified, s, result.weighed->components.variance));
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
  part.poses.approach.resize(all.poses.approach.size());
  for (std::size_t k = 0; k < all.count(); ++k) {
    if ((use.empty() || use[k] != 0) != used) continue;
    for (std::size_t i = 0; i < all.poses.axis.size(); ++i) part.poses.axis[i].push_back(all.poses.axis[i][k]);
    for (std::size_t i = 0; i < all.poses.approach.size(); ++i)
      part.poses.approach[i].push_back(all.poses.approach[i][k]);
    part.station.push_back(all.station[k]);
    part.reflector.push_back(all.reflector[k]);
    for (std::size_t i = 0; i < 3; ++i) part.measured[i].push_back(all.measured[i][k]);
    if (!all.point_name.empty()) part.point_name.push_back(all.point_name[k]);
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

std::vector<AxisRange> known_ranges(const Study& study, const StudyResult& result) {
  std::vector<const ErrorSet*> errors = {&result.identification.errors};
  if (result.campaign.truth) errors.push_back(&*result.campaign.truth);
  return unseen_ranges(study.machine, errors);
}

/// @param readings  of a tracker that took no part in the fit
void add_tracker(const Study& study, const StudyResult& result, std::size_t s, const TrackerCampaign& setup,
                 TrackerReadings readings, Tally& tally) {
  const ErrorSet& identified = result.identification.errors;
  const bool simulated = tally.unseen.against_truth;
  const std::vector<double> before = nominal_errors(study.machine, simulated ? setup.truth : setup.start, readings);
  tally.unseen.before.insert(tally.unseen.before.end(), before.begin(), before.end());
  if (!simulated) {
    TrackerObservations as_stated(study.machine, identified, setup.start, readings);
    as_stated.set_parameters(identified.parameters(), result.identification.setup[s]);
    tally.add_against_noise(as_stated);
  }
  tally.unseen.fitted_before += 6 * setup.start.stations.size();
  // The observations carry the identified poses and offsets; build them as the fit did, so that the unknowns
  // correspond.
  if (result.weighed) {
    TrackerObservations stated(study.machine, identified, setup.start, readings);
    add_coverage(result, s, stated, tally);
  }
  TrackerSetup weighed = setup.start;
  weigh_in_micrometres(weighed, readings);
  TrackerObservations observations(study.machine, identified, weighed, std::move(readings));
  observations.set_parameters(identified.parameters(), result.identification.setup[s]);
  tally.add(predict_readings(observations, result.identification, s));
}

TrackerReadings unseen_tracker_readings(const Study& study, const StudyResult& result, std::size_t s,
                                        const TrackerCampaign& setup, std::size_t poses) {
  TrackerSimulationOptions options;
  options.noise_factor = 0;
  options.line_of_sight = false;
  options.choice = SightChoice::cycle;
  options.threads = study.threads;
  const PoseList list = random_plan(study.machine, known_ranges(study, result), poses, unseen_seed(study.seed) + s);
  return simulate_tracker(study.machine, *result.campaign.truth, setup.truth, list, options).readings;
}

/// Distances of the nominal machine from readings, the set-up's unknowns fitted to all readings that were used.
std::vector<double> nominal_deviations(const Study& study, const StudyResult& result, std::size_t s,
                                       const InstrumentReadings& held_out) {
  const InstrumentCampaign& setup = dynamic_cast<const InstrumentCampaign&>(*result.campaign.setups[s]);
  const std::unique_ptr<Observations> all = setup.observations(study.machine, ErrorSet{});
  Problem problem = estimate_everything(study.machine, ErrorSet{}, {borrowed(*all)});
  problem.machine_parameters.clear();
  problem.observations[0].use = result.model.problem.observations[s].use;
  for (const KnownUnknown& known : setup.known_unknowns()) {
    problem.priors.push_back({{0, known.unknown}, known.value, known.standard_uncertainty});
  }
  if (!all->unknowns().empty()) identify(problem, identify_options(study));
  InstrumentObservations apart(
      study.machine, ErrorSet{},
      setup.device->with_values(dynamic_cast<const InstrumentObservations&>(*all).quantity_values()), held_out);
  std::vector<double> lengths;
  for (std::size_t k = 0; k < apart.reading_count(); ++k) append_length(apart, k, lengths);
  return lengths;
}

/// Readings of an instrument that were held out of the fit.
void add_instrument(const Study& study, const StudyResult& result, std::size_t s, const InstrumentCampaign& setup,
                    Tally& tally) {
  const std::vector<std::uint8_t>& use = result.model.problem.observations[s].use;
  std::vector<std::size_t> held_out;
  for (std::size_t k = 0; k < use.size(); ++k) {
    if (use[k] == 0) held_out.push_back(k);
  }
  const std::vector<ReadingComponent>& components = setup.device->components();
  const bool has_length = std::any_of(components.begin(), components.end(),
                                      [](const ReadingComponent& component) { return !component.is_angle; });
  if (held_out.empty() || !has_length) return;
  InstrumentReadings readings = setup.readings.subset(held_out);
  const std::vector<double> before = nominal_deviations(study, result, s, readings);
  tally.unseen.before.insert(tally.unseen.before.end(), before.begin(), before.end());
  {
    InstrumentObservations as_stated(study.machine, result.identification.errors, setup.device, readings);
    as_stated.set_parameters(result.identification.errors.parameters(), result.identification.setup[s]);
    tally.add_against_noise(as_stated);
    if (result.weighed) add_coverage(result, s, as_stated, tally);
  }
  readings.uncertainty.assign(components.size(), std::vector<double>(readings.count(), 1e-3));
  InstrumentObservations observations(study.machine, result.identification.errors, setup.device, std::move(readings));
  observations.set_parameters(result.identification.errors.parameters(), result.identification.setup[s]);
  tally.add(predict_readings(observations, result.identification, s));
}

ParameterCovariance covariance_of_errors(const StudyResult& result) {
  const std::size_t count = result.identification.errors.parameter_count();
  ParameterCovariance covariance;
  covariance.covariance = machine_covariance(result.identification, count);
  for (std::size_t p = 0; p < count; ++p) covariance.parameters.push_back(p);
  return covariance;
}

/// Directions that the gauge fixes, as far as they are errors of the machine: [machine parameters, constraints].
Eigen::MatrixXd unseen_directions(const Identification& identification) {
  const std::vector<GaugeConstraint>& constraints = identification.gauge.constraints;
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(identification.errors.parameter_count()),
                                                     static_cast<Eigen::Index>(constraints.size()));
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    for (std::size_t p = 0; p < identification.parameters.size(); ++p) {
      const ParameterId& id = identification.parameters[p].id;
      if (!id.is_machine()) continue;
      directions(static_cast<Eigen::Index>(id.index), static_cast<Eigen::Index>(i)) =
          constraints[i].direction[static_cast<Eigen::Index>(p)];
    }
  }
  return directions;
}

/// Whether the truth is compared with the identified errors at the given sides of approach.
/// @param deviation  of the mean of both directions; its displacement becomes that of the sides where that is found
bool compare_with_truth(const Study& study, const StudyResult& result, const PoseList& commands, ErrorMap& deviation,
                        Eigen::Matrix3Xd& before) {
  const ErrorSet &truth = *result.campaign.truth, &identified = result.identification.errors;
  std::vector<std::uint8_t> covered = deviation.covered;
  const Eigen::Matrix3Xd after = errors_at_commands(study.machine, truth, identified, commands, covered);
  before = errors_at_commands(study.machine, truth, ErrorSet{}, commands, covered);
  if (after.cols() == 0 || before.cols() == 0) return false;
  deviation.covered = covered;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto row = after.row(static_cast<Eigen::Index>(d));
    deviation.displacement[d].assign(row.begin(), row.end());
  }
  return true;
}

/// The volumetric error at random poses against the truth, and which of the unseen directions it depends on.
/// @param statistics  false: the directions alone
void add_volumetric(const Study& study, const StudyResult& result, std::size_t poses, bool statistics, Tally& tally) {
  UnseenPoses& unseen = tally.unseen;
  const ErrorSet& identified = result.identification.errors;
  const bool simulated = unseen.against_truth;
  const ErrorSet& actual = simulated ? *result.campaign.truth : identified;
  const bool both_directions = !identified.reversals.empty() || !actual.reversals.empty();
  PoseList list =
      random_unseen_poses(study.machine, known_ranges(study, result), poses, unseen_seed(study.seed), both_directions);
  ErrorMapOptions options;
  options.orientation = false;
  options.remove_rigid_motion = true;
  options.threads = study.threads;
  const PoseSource source = pose_source(list);
  const ErrorMap mean_before = error_map(study.machine, actual, nullptr, source, options);
  ErrorMap deviation = error_map(study.machine, actual, &identified, source, options);
  for (std::size_t k = 0; k < deviation.count(); ++k) deviation.covered[k] &= mean_before.covered[k];
  Eigen::Matrix3Xd before;
  const bool at_commands = simulated && compare_with_truth(study, result, list, deviation, before);
  // Poses that do not say how the workpiece is turned, such as those of a rotary table alone: to first order, for the
  // mean of both directions, and so is what is predicted.
  if (simulated && !at_commands) list.approach.clear();
  const DeterminedPart part = determined_part(study.machine, identified, covariance_of_errors(result),
                                              unseen_directions(result.identification), list, deviation);
  for (const std::size_t direction : part.open_directions) {
    const GaugeConstraint& constraint = result.identification.gauge.constraints[direction];
    unseen.open.push_back(constraint.words);
    unseen.open_constraints.push_back(direction);
  }
  unseen.open_known = true;
  unseen.open_rank = part.open_rank;
  if (!simulated) return;
  double open_square = 0;
  std::size_t covered = 0;
  for (std::size_t k = 0; k < deviation.count(); ++k) {
    if (deviation.covered[k] == 0) continue;
    ++covered;
    for (std::size_t d = 0; d < 3; ++d) open_square += part.open[d][k] * part.open[d][k];
    if (!statistics) continue;
    double variance = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      const double u = part.uncertainty[d][k];
      variance += u * u;
      tally.within += std::abs(part.displacement[d][k]) <= 2 * u ? 1U : 0U;
      ++tally.coordinates;
    }
    unseen.before.push_back(at_commands ? before.col(static_cast<Eigen::Index>(k)).norm() : mean_before.norm[k]);
    unseen.after.push_back(
        std::hypot(deviation.displacement[0][k], deviation.displacement[1][k], deviation.displacement[2][k]));
    unseen.expanded_uncertainty.push_back(2 * std::sqrt(variance));
  }
  if (covered > 0) unseen.open_rms = std::sqrt(open_square / static_cast<double>(covered));
}

}  // namespace

UnseenPoses evaluate_unseen(const Study& study, const StudyResult& result, std::size_t poses) {
  UnseenPoses unseen;
  unseen.against_truth = result.campaign.truth.has_value();
  Tally tally{unseen};
  const std::vector<std::shared_ptr<CampaignSetup>>& setups = result.campaign.setups;
  const bool trackers_only = std::none_of(study.setups.begin(), study.setups.end(),
                                          [](const Setup& setup) { return setup.device != nullptr; });
  add_volumetric(study, result, poses, !trackers_only, tally);
  for (std::size_t s = 0; s < setups.size() && (!unseen.against_truth || trackers_only); ++s) {
    if (const auto* tracker = dynamic_cast<const TrackerCampaign*>(setups[s].get())) {
      TrackerReadings readings;
      if (unseen.against_truth) {
        readings = unseen_tracker_readings(study, result, s, *tracker, poses);
      } else if (study.identification->held_out_file) {
        if (s > 0) continue;
        readings = read_held_out(study, *tracker);
      } else {
        readings = select(tracker->readings, result.model.problem.observations[s].use, false);
      }
      if (readings.count() > 0) add_tracker(study, result, s, *tracker, std::move(readings), tally);
    } else {
      add_instrument(study, result, s, dynamic_cast<const InstrumentCampaign&>(*setups[s]), tally);
    }
  }
  unseen.numbers = tally.coordinates;
  unseen.coverage =
      tally.coordinates > 0 ? static_cast<double>(tally.within) / static_cast<double>(tally.coordinates) : 0;
  if (tally.noise_count > 0) {
    unseen.times_noise = std::sqrt(tally.noise_square / static_cast<double>(tally.noise_count));
  }
  unseen.quantity = !unseen.against_truth ? UnseenQuantity::held_out_residual
                    : trackers_only       ? UnseenQuantity::error_at_reflectors
                                          : UnseenQuantity::volumetric_error;
  unseen.before_statistics = sample_statistics(unseen.before);
  unseen.after_statistics = sample_statistics(unseen.after);
  unseen.uncertainty_statistics = sample_statistics(unseen.expanded_uncertainty);
  unseen.description =
      unseen.against_truth
          ? fmt::format("{} random poses that were not measured (seed {}), against the simulated truth",
                        unseen.after.size(), unseen_seed(study.seed))
          : fmt::format("{} readings held out of the fit", unseen.after.size());
  return unseen;
}

const char* quantity_name(UnseenQuantity quantity) {
  switch (quantity) {
    case UnseenQuantity::error_at_reflectors:
      return "true error at the reflectors";
    case UnseenQuantity::held_out_residual:
      return "residual of held-out readings";
    default:
      return "true volumetric error";
  }
}

std::string open_directions_text(const UnseenPoses& unseen) {
  std::string text = fmt::format(
      "the readings leave the volumetric error open in {} direction{}, beyond the choice of the workpiece datum; what "
      "is "
      "assumed there decides it: ",
      unseen.open_rank, unseen.open_rank == 1 ? "" : "s");
  for (std::size_t i = 0; i < unseen.open.size(); ++i) text += (i > 0 ? ", " : "") + unseen.open[i];
  if (unseen.against_truth) {
    text += fmt::format(". {:.3g} um (root mean square) of the volumetric error lie there", 1e3 * unseen.open_rms);
  }
  return text + ". Predicted uncertainties do not include it.";
}

}  // namespace abbe
