#include "abbe/study/identification/simulated_setup.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_errors.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/identification/identified_expansions.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/planning/planned_readings.h"

namespace abbe {
namespace {

// Streams of their own, apart from those of the readings and of the other errors.
constexpr std::uint64_t kTruthStream = 1'000'000'007;
constexpr std::uint64_t kReversalStream = 1'000'000'009;
constexpr std::uint64_t kDriftStream = 1'000'000'021;

/// A dial along its face, a beam past its mirror: nothing can be read there.
/// @param place  file or set-up to be named
/// @param with   the machine on which: "", " with the true errors of the simulation"
void refuse_unreadable(const Machine& machine, const Instrument& device, const InstrumentReadings& readings,
                       const std::string& place, const std::string& with, const std::string& expected) {
  for (std::size_t c = 0; c < readings.measured.size(); ++c) {
    for (std::size_t k = 0; k < readings.count(); ++k) {
      if (std::isfinite(readings.measured[c][k])) continue;
      std::string pose;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        pose += fmt::format("{}{} = {:.6g} {}", i > 0 ? ", " : "", axis.name,
                            readings.poses.axis[i][k] / position_unit(axis), position_suffix(axis));
      }
      throw InputError({.file = place, .field = device.components()[c].name},
                       fmt::format("reads nothing at {} ({}){}", pose, device.items()[readings.item[k]].name, with),
                       expected);
    }
  }
}

/// @throws InputError where poses of a set-up do not give a state that the true errors use
void require_planned_states(const Machine& machine, const ErrorSet& errors, const PoseList& poses,
                            const std::string& setup) {
  const std::size_t missing = missing_state(machine, errors, poses);
  if (missing == kNoState) return;
  const MachineState& state = machine.states[missing];
  throw InputError({.field = setup},
                   fmt::format("the true errors depend on {}, which is not given at all poses", state.name),
                   fmt::format("poses from a file with a column {0}, or with time_s and channels that have {0}",
                               state_column(state)));
}

/// The plans of a set-up. Poses are planned with what is known of the set-up, not with what it really is.
std::vector<PlannedReadings> plans_of(const Study& study, std::size_t setup_index, const ChannelUse& channels) {
  const Setup& setup = study.setups[setup_index];
  std::vector<PlannedReadings> plans;
  for (std::size_t p = 0; p < setup.plans.size(); ++p) {
    plans.push_back(planned_readings(study.machine, setup, setup.plans[p], plan_seed(study, setup_index, p), channels));
  }
  return plans;
}

/// Lets a set-up drift over all of its plans, which then have one clock.
void add_true_drift(const Study& study, std::size_t setup_index, std::vector<PlannedReadings>& plans,
                    CampaignSetup& result) {
  std::vector<double> all;
  for (PlannedReadings& planned : plans) {
    std::vector<double>& times = planned.readings.time_s;
    const double interval = study.simulation->interval_s, after = all.empty() ? 0 : all.back() + interval;
    for (std::size_t k = times.size(); k < planned.readings.count(); ++k) {
      times.push_back(after + interval * static_cast<double>(k));
    }
    all.insert(all.end(), times.begin(), times.end());
  }
  RandomStream random(study.seed, kDriftStream + setup_index);
  result.true_drift = true_drift(*study.setups[setup_index].drift, *result.truth, all, random);
  for (PlannedReadings& planned : plans) planned.readings.drift = result.true_drift;
}

}  // namespace

ErrorSet true_errors(const Study& study) {
  const Simulation& simulation = *study.simulation;
  if (simulation.errors) return *simulation.errors;
  if (simulation.errors_file) {
    return read_errors(*simulation.errors_file, study.machine, StatesOfErrors::allowed).errors;
  }
  const ErrorGenerator& generator = *simulation.generator;
  RandomErrorOptions options;
  options.seed = generator.seed;
  options.linear_order = generator.linear_order;
  options.rotary_harmonics = generator.rotary_order;
  options.rotary_order = generator.rotary_order;
  options.locations = generator.location_errors;
  ErrorSet errors = random_errors(study.machine, options);
  VolumetricTarget target;
  target.measure = generator.mean_volumetric ? VolumetricMeasure::mean : VolumetricMeasure::maximum;
  target.value_um = 1e3 * (generator.mean_volumetric ? *generator.mean_volumetric : *generator.maximum_volumetric);
  scale_errors(study.machine, errors, target);
  for (std::size_t axis = 0; axis < study.machine.axes.size(); ++axis) {
    const bool rotary = study.machine.axes[axis].kind == AxisKind::rotary;
    const double size = rotary ? generator.rotary_reversal : generator.reversal;
    // Lost motion: the axis stays behind.
    RandomStream random(generator.seed, kReversalStream + axis);
    if (size > 0) errors.reversals.push_back({axis, -size * random.uniform(0.5, 1.5), 0});
  }
  add_true_expansions(study, generator.seed, errors);
  return errors;
}

void simulate_setup(const Study& study, std::size_t setup_index, const ErrorSet& truth, const JobOptions& job,
                    const ChannelUse& channels, CampaignSetup& result) {
  const Setup& setup = study.setups[setup_index];
  RandomStream random(study.seed, kTruthStream + setup_index);
  result.truth = setup.device->truth(random);
  std::vector<PlannedReadings> plans = plans_of(study, setup_index, channels);
  if (setup.drift && setup.drift->truth) add_true_drift(study, setup_index, plans, result);
  for (std::size_t p = 0; p < plans.size(); ++p) {
    const std::uint64_t seed = plan_seed(study, setup_index, p);
    PlannedReadings& planned = plans[p];
    InstrumentReadings& plan = planned.readings;
    if (approach_matters(study, truth)) plan.poses.approach = approach_in_order(plan.poses);
    require_planned_states(study.machine, truth, plan.poses, setup.name);
    InstrumentSimulationOptions options;
    options.seed = seed;
    options.noise_factor = study.simulation->noise ? 1 : 0;
    options.outlier_fraction = study.simulation->outliers.fraction;
    options.outlier_mm = study.simulation->outliers.size;
    options.readings_per_pose = planned.per_pose;
    options.interval_s = study.simulation->interval_s;
    options.threads = study.threads;
    options.progress = stoppable_progress(job);
    const SimulatedInstrument simulated = result.truth->simulate(study.machine, truth, plan, options);
    options.noise_factor = 0;
    options.outlier_fraction = 0;
    options.progress = stoppable_progress({.stop = job.stop});
    if (setup.device->may_miss()) {
      refuse_unreadable(study.machine, *result.truth,
                        setup.device->simulate(study.machine, ErrorSet{}, plan, options).readings, setup.name, "",
                        "an instrument that meets what it measures at all poses of the plan");
      const auto& of_file = study.simulation->errors_file;
      const std::string errors_file = of_file ? of_file->string() : setup.name;
      refuse_unreadable(
          study.machine, *result.truth, simulated.readings, errors_file,
          fmt::format(" in set-up {} with the true errors", setup.name),
          "errors, and true values of the set-up, with which the instrument still meets what it measures");
    }
    const std::size_t offset = result.readings.count();
    for (const std::uint32_t outlier : simulated.outliers) {
      result.outliers.push_back(static_cast<std::uint32_t>(offset) + outlier);
    }
    result.hidden += simulated.hidden;
    const bool same_clock = channels.from != nullptr || result.true_drift != nullptr;
    result.readings.append(simulated.readings, same_clock);
    result.exact.append(result.truth->simulate(study.machine, truth, plan, options).readings, same_clock);
  }
  result.readings.drift = result.exact.drift = nullptr;  // what is identified does not know it
}

}  // namespace abbe
