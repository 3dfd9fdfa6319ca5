#include "abbe/study/instrument_campaign.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/instrument_file.h"
#include "abbe/formats/planned_poses.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

// A stream of its own, apart from those of the readings.
constexpr std::uint64_t kTruthStream = 1'000'000'007;

/// A pose of a file with what is measured there.
struct PlannedTargets {
  PoseList poses;
  std::vector<std::size_t> target;  ///< [poses]
};

/// The rows of a file in their order, each with its target, or with all of the plan where the file names none; repeated
/// as the plan says.
PlannedTargets planned_targets(const Machine& machine, const Setup& setup, const MeasurementPlan& plan) {
  const PlannedPoses planned = read_planned_poses(plan.file, machine, setup);
  PlannedTargets once;
  for (std::size_t k = 0; k < planned.poses.count(); ++k) {
    for (const std::size_t target : planned.target.empty() ? plan.targets : std::vector{planned.target[k]}) {
      once.poses.append(planned.poses.pose(k));
      once.target.push_back(target);
    }
  }
  PlannedTargets all;
  all.poses = repeated(once.poses, plan.repeats, plan.there_and_back);
  for (std::size_t r = 0; r < plan.repeats; ++r) {
    if (plan.there_and_back && r % 2 == 1) {
      all.target.insert(all.target.end(), once.target.rbegin(), once.target.rend());
    } else {
      all.target.insert(all.target.end(), once.target.begin(), once.target.end());
    }
  }
  return all;
}

/// Poses of a plan for one target; those with points that meet are items.
PoseList target_poses(const Machine& machine, const Setup& setup, const MeasurementPlan& plan, std::size_t target,
                      std::uint64_t seed) {
  const Instrument& device = *setup.device;
  if (plan.kind != PlanKind::circle && plan.kind != PlanKind::follow) return plan_poses(machine, plan, seed);
  const std::optional<MeetingPoints> points = device.meeting_points(target);
  if (!points) {
    throw std::invalid_argument(device.name() + " has no points that meet; use a plan of another kind");
  }
  const InstrumentItem& ends = device.items()[target];
  PoseList poses;
  if (plan.kind == PlanKind::circle) {
    std::vector<double> positions;
    for (const AxisRange& range : plan.axes) positions.push_back(range.from);
    poses = circle_plan(machine, positions, ends.from, ends.to, *points, plan.circle);
  } else {
    poses = follow_plan(machine, grid_plan(machine, plan.axes), ends.from, ends.to, *points, plan.displacement);
  }
  return repeated(poses, plan.repeats, plan.there_and_back);
}

/// The instrument as it really is.
std::shared_ptr<const Instrument> true_device(const Study& study, std::size_t setup) {
  const Instrument& device = *study.setups[setup].device;
  RandomStream random(study.seed, kTruthStream + setup);
  std::vector<double> values;
  for (const SetupQuantity& quantity : device.quantities()) {
    const double drawn = quantity.value + quantity.standard_uncertainty * random.normal();
    values.push_back(quantity.truth.value_or(quantity.knowledge == Knowledge::within ? drawn : quantity.value));
  }
  return device.with_values(values);
}

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

void simulate(const Study& study, std::size_t setup_index, const ErrorSet& truth, InstrumentCampaign& result) {
  const Setup& setup = study.setups[setup_index];
  const std::shared_ptr<const Instrument> device = true_device(study, setup_index);
  for (const SetupQuantity& quantity : device->quantities()) result.truth.push_back(quantity.value);
  for (std::size_t p = 0; p < setup.plans.size(); ++p) {
    const std::uint64_t seed = plan_seed(study, setup_index, p);
    // Poses are planned with what is known of the set-up, not with what it really is.
    InstrumentReadings plan = planned_readings(study.machine, setup, setup.plans[p], seed);
    if (approach_matters(study, truth)) plan.poses.approach = approach_in_order(plan.poses);
    InstrumentSimulationOptions options;
    options.seed = seed;
    options.noise_factor = study.simulation->noise ? 1 : 0;
    options.outlier_fraction = study.simulation->outliers.fraction;
    options.outlier_mm = study.simulation->outliers.size;
    const SimulatedInstrument simulated = simulate_instrument(study.machine, truth, device, plan, options);
    options.noise_factor = 0;
    options.outlier_fraction = 0;
    refuse_unreadable(study.machine, *device,
                      simulate_instrument(study.machine, ErrorSet{}, setup.device, plan, options).readings, setup.name,
                      "", "an instrument that meets what it measures at all poses of the plan");
    const std::filesystem::path errors_file = study.simulation->errors_file.value_or(setup.name);
    refuse_unreadable(study.machine, *device, simulated.readings, errors_file.string(),
                      fmt::format(" in set-up {} with the true errors", setup.name),
                      "errors, and true values of the set-up, with which the instrument still meets what it measures");
    const std::size_t offset = result.readings.count();
    for (const std::uint32_t outlier : simulated.outliers) {
      result.outliers.push_back(static_cast<std::uint32_t>(offset) + outlier);
    }
    result.readings.append(simulated.readings);
    result.exact.append(simulate_instrument(study.machine, truth, device, plan, options).readings);
  }
}

void read(const Study& study, const Setup& setup, InstrumentCampaign& result) {
  for (const SetupData& data : setup.data) {
    MeasurementOptions options;
    options.mapping = data.mapping;
    options.threads = study.threads;
    InstrumentReadings readings = read_instrument_readings(data.file, study.machine, *setup.device, options);
    if (!setup.noise_from_data) {
      readings.uncertainty.clear();
    } else if (readings.uncertainty.empty()) {
      throw InputError({.file = data.file.string()},
                       "the study takes the noise from the data, but the file states no uncertainties",
                       fmt::format("columns such as u_{}_{}", setup.device->components().front().name,
                                   setup.device->components().front().is_angle ? "arcsec" : "um"));
    }
    if (result.readings.count() > 0 && readings.time_s.empty() != result.readings.time_s.empty()) {
      throw InputError({.file = data.file.string()}, "the files of one set-up differ in their columns",
                       "time_s in all files of a set-up, or in none");
    }
    result.readings.append(readings);
  }
}

}  // namespace

std::string InstrumentCampaign::readings_text(const Machine& machine) const {
  return instrument_readings_text(machine, *device, readings);
}

ReadingFacts InstrumentCampaign::facts() const {
  ReadingFacts facts;
  facts.setup = name;
  facts.time_s = readings.time_s;
  facts.labels = {{"target", {}, readings.item}};
  for (const InstrumentItem& item : device->items()) facts.labels[0].names.push_back(item.name);
  facts.measured = readings.measured;
  facts.inputs = readings.inputs;
  facts.arm.assign(readings.measured.size(), 1.0);
  return facts;
}

void InstrumentCampaign::find_start(const Machine& machine, std::vector<std::string>& warnings,
                                    std::vector<std::string>&) {
  std::vector<std::string> said;
  start = device->start_values(machine, readings, said);
  for (const std::string& message : said) warnings.push_back(name + ": " + message);
}

std::unique_ptr<Observations> InstrumentCampaign::observe(const Machine& machine, const ErrorSet& errors,
                                                          const InstrumentReadings& from) const {
  return std::make_unique<InstrumentObservations>(machine, errors, start.empty() ? device : device->with_values(start),
                                                  from);
}

std::unique_ptr<Observations> InstrumentCampaign::observations(const Machine& machine, const ErrorSet& errors) const {
  return observe(machine, errors, readings);
}

std::unique_ptr<Observations> InstrumentCampaign::exact_observations(const Machine& machine,
                                                                     const ErrorSet& errors) const {
  return observe(machine, errors, exact);
}

std::vector<KnownUnknown> InstrumentCampaign::known_unknowns() const {
  std::vector<KnownUnknown> known;
  std::size_t unknown = 0;
  for (const SetupQuantity& quantity : device->quantities()) {
    if (quantity.knowledge == Knowledge::exact) continue;
    if (quantity.knowledge == Knowledge::within) {
      known.push_back({unknown, quantity.value, quantity.standard_uncertainty});
    }
    ++unknown;
  }
  return known;
}

std::vector<KnownUnknown> InstrumentCampaign::true_unknowns() const {
  std::vector<double> estimated;
  for (std::size_t q = 0; q < truth.size(); ++q) {
    if (device->quantities()[q].knowledge != Knowledge::exact) estimated.push_back(truth[q]);
  }
  std::vector<KnownUnknown> known = known_unknowns();
  for (KnownUnknown& one : known) one.value = estimated.at(one.unknown);
  return known;
}

InstrumentReadings planned_readings(const Machine& machine, const Setup& setup, const MeasurementPlan& plan,
                                    std::uint64_t seed) {
  const Instrument& device = *setup.device;
  InstrumentReadings readings;
  std::size_t target = 0;
  const auto append = [&](const std::vector<double>& pose) {
    const std::size_t item = device.item_at(machine, target, pose);
    for (const std::vector<double>& inputs : device.planned_inputs(item)) readings.append(pose, item, inputs);
  };
  try {
    // A file goes from row to row, whatever their targets; all other plans from target to target.
    if (plan.kind == PlanKind::poses) {
      const PlannedTargets planned = planned_targets(machine, setup, plan);
      for (std::size_t n = 0; n < planned.poses.count(); ++n) {
        target = planned.target[n];
        append(planned.poses.pose(n));
      }
      return readings;
    }
    for (const std::size_t one : plan.targets) {
      target = one;
      const PoseList poses = target_poses(machine, setup, plan, target, seed);
      for (std::size_t k = 0; k < poses.count(); ++k) append(poses.pose(k));
    }
  } catch (const std::invalid_argument& error) {
    throw InputError({.file = setup.name, .field = "plan"},
                     fmt::format("{}: {}", device.target_names()[target], error.what()),
                     "poses at which it can be measured, within the travel of the machine");
  }
  return readings;
}

std::shared_ptr<CampaignSetup> gather_instrument(const Study& study, std::size_t setup, const ErrorSet* truth) {
  auto result = std::make_unique<InstrumentCampaign>();
  result->device = study.setups[setup].device;
  if (truth != nullptr) {
    simulate(study, setup, *truth, *result);
  } else {
    read(study, study.setups[setup], *result);
  }
  return result;
}

}  // namespace abbe
