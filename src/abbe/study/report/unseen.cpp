#include "abbe/study/report/unseen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/errors/error_states.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/study/identification/predicted_readings.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/identification/setups_problem.h"
#include "abbe/study/identification/time_blocks.h"
#include "abbe/study/random_poses.h"
#include "abbe/study/report/open_directions.h"
#include "abbe/study/study_steps.h"
#include "abbe/verify/compensated_poses.h"
#include "abbe/verify/error_map.h"
#include "abbe/verify/parts/determined_part.h"

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

/// Lengths of measured - modelled, mm, of the readings that have one.
std::vector<double> known_lengths(const Observations& observations) {
  std::vector<double> lengths = lengths_by_reading(observations);
  std::erase(lengths, -1.0);
  return lengths;
}

/// Distances of the nominal machine from readings, the numbers of the set-up fitted to these readings.
std::vector<double> refitted_nominal_errors(const Machine& machine, const Instrument& device,
                                            const InstrumentReadings& readings) {
  InstrumentReadings standing = readings;
  standing.drift = nullptr;
  const std::unique_ptr<Observations> observations =
      device.started(machine, standing).instrument->observations(machine, ErrorSet{}, standing);
  return known_lengths(*observations);
}

/// Distances of the nominal machine from readings, the set-up's unknowns fitted to all readings that were used.
std::vector<double> nominal_errors(const Study& study, const StudyResult& result, std::size_t s,
                                   const InstrumentReadings& readings) {
  const CampaignSetup& setup = result.campaign.setups[s];
  Problem problem =
      setups_problem(study.machine, ErrorSet{}, {&setup, 1}, {&result.model.problem.observations[s].use, 1});
  const Observations& all = *problem.observations[0].observations;
  if (!all.unknowns().empty()) identify(problem, identify_options(study));
  const std::unique_ptr<Observations> apart = setup.start->observations(study.machine, ErrorSet{}, readings);
  apart->set_parameters(ErrorSet{}.parameters(), all.unknown_values());
  return known_lengths(*apart);
}

/// @param readings  that took no part in the fit
void add_readings(const Study& study, const StudyResult& result, std::size_t s, const InstrumentReadings& readings,
                  Tally& tally) {
  const CampaignSetup& setup = result.campaign.setups[s];
  const std::vector<ReadingComponent>& components = setup.device->components();
  const bool has_length = std::any_of(components.begin(), components.end(),
                                      [](const ReadingComponent& component) { return !component.is_angle; });
  if (readings.count() == 0 || !has_length) return;
  const ErrorSet& identified = result.identification.errors;
  const bool simulated = tally.unseen.against_truth;
  // Points against the truth are compared by their coordinates, whatever the instrument reads.
  const std::shared_ptr<const Instrument> start = simulated ? setup.start->in_coordinates() : setup.start;
  const std::size_t fitted = start->fitted_by_start();
  const std::vector<double> before =
      fitted > 0 ? refitted_nominal_errors(study.machine, simulated ? *setup.truth->in_coordinates() : *start, readings)
                 : nominal_errors(study, result, s, readings);
  tally.unseen.before.insert(tally.unseen.before.end(), before.begin(), before.end());
  tally.unseen.fitted_before += fitted;
  // As the fit had them, so that the unknowns correspond.
  const std::unique_ptr<Observations> as_stated = start->observations(study.machine, identified, readings);
  as_stated->set_parameters(identified.parameters(), result.identification.setup[s]);
  if (!simulated) tally.add_against_noise(*as_stated);
  if (result.weighed) add_coverage(result, s, *as_stated, tally);
  const std::unique_ptr<Observations> in_um = start->observations_in_um(study.machine, identified, readings);
  in_um->set_parameters(identified.parameters(), result.identification.setup[s]);
  tally.add(predict_readings(*in_um, result.identification, s));
}

/// What an instrument that sees points would read at random poses, each from one of its stations on one of its targets.
InstrumentReadings unseen_points(const Study& study, const StudyResult& result, std::size_t s, std::size_t poses) {
  const std::shared_ptr<const Instrument> truth = result.campaign.setups[s].truth->in_coordinates();
  const PoseList list =
      random_plan(study.machine, ranges_of_known_errors(study, result), poses, unseen_seed(study.seed) + s);
  InstrumentReadings plan;
  for (std::size_t k = 0; k < list.count(); ++k) plan.append(list.pose(k), k % truth->items().size());
  stand_at_references(study.machine, plan.poses);
  InstrumentSimulationOptions options;
  options.noise_factor = 0;
  options.line_of_sight = false;
  options.threads = study.threads;
  InstrumentReadings readings = truth->simulate(study.machine, *result.campaign.truth, plan, options).readings;
  stand_at_start_of_drift(result.campaign.setups[s], readings);
  return readings;
}

InstrumentReadings held_out_readings(const Study& study, const StudyResult& result, std::size_t s) {
  if (study.identification->held_out_file) {
    return s == 0 ? read_held_out(study, result.campaign) : InstrumentReadings{};
  }
  const std::vector<std::uint8_t>& use = result.model.problem.observations[s].use;
  std::vector<std::size_t> held_out;
  for (std::size_t k = 0; k < use.size(); ++k) {
    if (use[k] == 0) held_out.push_back(k);
  }
  return result.campaign.setups[s].readings.subset(held_out);
}

ParameterCovariance covariance_of_errors(const StudyResult& result) {
  const std::size_t count = result.identification.errors.parameter_count();
  ParameterCovariance covariance;
  covariance.covariance = machine_covariance(result.identification, count);
  for (std::size_t p = 0; p < count; ++p) covariance.parameters.push_back(p);
  return covariance;
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
  const ErrorSet &identified = result.identification.errors, &actual = *result.campaign.truth;
  PoseList list = poses_not_measured(study, result, poses, !identified.reversals.empty() || !actual.reversals.empty());
  const ErrorMapOptions options = unseen_map_options(study);
  const PoseSource source = pose_source(list);
  const ErrorMap mean_before = error_map(study.machine, actual, nullptr, source, options);
  ErrorMap deviation = error_map(study.machine, actual, &identified, source, options);
  for (std::size_t k = 0; k < deviation.count(); ++k) deviation.covered[k] &= mean_before.covered[k];
  Eigen::Matrix3Xd before;
  const bool at_commands = compare_with_truth(study, result, list, deviation, before);
  // Poses that do not say how the workpiece is turned, such as those of a rotary table alone: to first order, for the
  // mean of both directions, and so is what is predicted.
  if (!at_commands) list.approach.clear();
  const DeterminedPart part = determined_part(study.machine, identified, covariance_of_errors(result),
                                              unseen_directions(result.identification), list, deviation);
  tell_open_directions(result, {part.open_directions, part.open_rank}, unseen);
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
  const std::vector<CampaignSetup>& setups = result.campaign.setups;
  const bool points_only = std::all_of(setups.begin(), setups.end(),
                                       [](const CampaignSetup& setup) { return setup.device->measures_points(); });
  if (unseen.against_truth) {
    add_volumetric(study, result, poses, !points_only, tally);
  } else {
    find_open_directions(study, result, poses, unseen);
  }
  for (std::size_t s = 0; s < setups.size() && (!unseen.against_truth || points_only); ++s) {
    add_readings(study, result, s,
                 unseen.against_truth ? unseen_points(study, result, s, poses) : held_out_readings(study, result, s),
                 tally);
  }
  unseen.numbers = tally.coordinates;
  unseen.coverage =
      tally.coordinates > 0 ? static_cast<double>(tally.within) / static_cast<double>(tally.coordinates) : 0;
  if (tally.noise_count > 0) {
    unseen.times_noise = std::sqrt(tally.noise_square / static_cast<double>(tally.noise_count));
  }
  unseen.quantity = !unseen.against_truth ? UnseenQuantity::held_out_residual
                    : points_only         ? UnseenQuantity::error_at_reflectors
                                          : UnseenQuantity::volumetric_error;
  const bool in_blocks = !study.identification->held_out_file &&
                         std::any_of(setups.begin(), setups.end(), [&](const CampaignSetup& setup) {
                           return is_time_series(study.machine, result.identification.errors, setup);
                         });
  unseen.before_statistics = sample_statistics(unseen.before);
  unseen.after_statistics = sample_statistics(unseen.after);
  unseen.uncertainty_statistics = sample_statistics(unseen.expanded_uncertainty);
  unseen.description =
      unseen.against_truth
          ? fmt::format("{} random poses that were not measured (seed {}), against the simulated truth",
                        unseen.after.size(), unseen_seed(study.seed))
          : fmt::format("{} readings held out of the fit{}", unseen.after.size(),
                        in_blocks ? ", in blocks without a break in time" : "");
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
