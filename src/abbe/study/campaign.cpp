#include "abbe/study/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_errors.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/planned_readings.h"
#include "abbe/study/setup_drifts.h"

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

/// States of the true errors and of those that are identified: 1 or 0, [states of the machine].
std::vector<std::uint8_t> states_in_study(const Study& study, const ErrorSet* truth) {
  ErrorSet errors = truth != nullptr ? *truth : ErrorSet{};
  if (study.identification) {
    for (const IdentifiedMotion& one : study.identification->motions) errors.motions.emplace_back().state = one.state;
    for (const IdentifiedLocation& one : study.identification->locations) {
      errors.locations.emplace_back().state = one.state;
    }
  }
  return used_states(study.machine, errors);
}

/// Says where the assumed start of a lag matters to errors that the study is about.
void warn_of_starts(const Study& study, const ErrorSet* truth, const std::string& setup,
                    const std::vector<UncertainStart>& starts, std::vector<std::string>& warnings) {
  const std::vector<std::uint8_t> used = states_in_study(study, truth);
  for (std::size_t j = 0; j < used.size(); ++j) {
    const UncertainStart* worst = nullptr;  // of several files the one that begins first
    for (const UncertainStart& start : starts) {
      if (start.state != j || used[j] == 0) continue;
      if (worst == nullptr || start.first_reading_s < worst->first_reading_s) worst = &start;
    }
    if (worst != nullptr) warnings.push_back(setup + ": " + uncertain_start_words(study.machine, *worst));
  }
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
      const std::filesystem::path errors_file = study.simulation->errors_file.value_or(setup.name);
      refuse_unreadable(
          study.machine, *result.truth, simulated.readings, errors_file.string(),
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

InstrumentFile read_file(const Study& study, const Setup& setup, const std::shared_ptr<const Instrument>& device,
                         const SetupData& data, const ChannelUse& channels) {
  MeasurementOptions options;
  options.channels = channels;
  options.mapping = data.mapping;
  options.threads = study.threads;
  return instrument_form(setup.instrument)
      .readings.read(data.file, study.machine, device, setup.name, setup.noise_from_data, options);
}

bool same_kind(const InstrumentReadings& a, const InstrumentReadings& b) {
  return a.uncertainty.empty() == b.uncertainty.empty() && a.covariance.empty() == b.covariance.empty();
}

bool same_components(const Instrument& a, const Instrument& b) {
  return std::equal(a.components().begin(), a.components().end(), b.components().begin(), b.components().end(),
                    [](const ReadingComponent& one, const ReadingComponent& other) { return one.name == other.name; });
}

/// Readings that somebody has already, with states by their times.
InstrumentFile take_readings(const Study& study, const Setup& setup, const std::shared_ptr<const Instrument>& device,
                             const InstrumentReadings& readings, const ChannelUse& channels) {
  InstrumentFile file = given_readings(readings, study.machine, device, setup.name, setup.noise_from_data);
  if (channels.from != nullptr) {
    channels.from->give(study.machine, file.readings.time_s, {setup.name, "time_s", {}, "reading"}, file.readings.poses,
                        channels.starts);
  }
  return file;
}

void read_setup_files(const Study& study, const Setup& setup, const std::stop_token& stop, const ChannelUse& channels,
                      CampaignSetup& result) {
  for (const SetupData& data : setup.data) {
    stop_if_asked(stop);
    InstrumentFile file = data.readings ? take_readings(study, setup, result.device, *data.readings, channels)
                                        : read_file(study, setup, result.device, data, channels);
    if (result.readings.count() > 0) {
      const auto refuse = [&](const char* expected) {
        throw InputError({.file = data.file.string()}, "the files of one set-up differ in their columns", expected);
      };
      if (!same_kind(file.readings, result.readings) || !same_components(*file.device, *result.device)) {
        refuse("the same kind of reading and of uncertainty in all files of a set-up");
      }
      if (file.readings.time_s.empty() != result.readings.time_s.empty()) {
        refuse("time_s in all files of a set-up, or in none");
      }
    }
    result.device = file.device;
    result.readings.append(file.readings, channels.from != nullptr);
    result.contradictions.insert(result.contradictions.end(), file.contradictions.begin(), file.contradictions.end());
  }
}

}  // namespace

std::vector<KnownUnknown> known_unknowns_of(const Instrument& device) {
  std::vector<KnownUnknown> known;
  std::size_t unknown = 0;
  for (const SetupQuantity& quantity : device.quantities()) {
    if (quantity.knowledge == Knowledge::exact) continue;
    if (quantity.knowledge == Knowledge::within) {
      known.push_back({unknown, quantity.value, quantity.standard_uncertainty});
    }
    ++unknown;
  }
  return known;
}

std::string CampaignSetup::readings_text(const Machine& machine) const {
  return instrument_form(instrument).readings.text(machine, *device, readings);
}

ReadingFacts CampaignSetup::facts() const {
  ReadingFacts facts;
  facts.setup = name;
  facts.time_s = readings.time_s;
  for (ItemLabel& label : device->item_labels()) {
    ReadingLabel& of = facts.labels.emplace_back(ReadingLabel{std::move(label.kind), std::move(label.names), {}});
    for (const std::uint16_t item : readings.item) of.of_reading.push_back(label.of_item[item]);
  }
  facts.measured = readings.measured;
  facts.inputs = readings.inputs;
  facts.arm = device->deviation_arms(readings);
  return facts;
}

std::unique_ptr<Observations> CampaignSetup::observations(const Machine& machine, const ErrorSet& errors) const {
  return start->observations(machine, errors, readings);
}

std::unique_ptr<Observations> CampaignSetup::exact_observations(const Machine& machine, const ErrorSet& errors) const {
  return start->observations(machine, errors, exact);
}

std::vector<KnownUnknown> CampaignSetup::known_unknowns() const { return known_unknowns_of(*device); }

std::vector<KnownUnknown> CampaignSetup::true_unknowns() const {
  std::vector<double> estimated;
  for (std::size_t q = 0; q < device->quantities().size(); ++q) {
    if (device->quantities()[q].knowledge != Knowledge::exact) estimated.push_back(truth->quantities()[q].value);
  }
  std::vector<KnownUnknown> known = known_unknowns();
  for (KnownUnknown& one : known) one.value = estimated.at(one.unknown);
  return known;
}

std::size_t Campaign::reading_count() const {
  std::size_t count = 0;
  for (const CampaignSetup& setup : setups) count += setup.reading_count();
  return count;
}

bool Campaign::is_explained() const {
  return std::all_of(setups.begin(), setups.end(),
                     [](const CampaignSetup& setup) { return setup.unexplained.empty(); });
}

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
  return errors;
}

bool approach_matters(const Study& study, const ErrorSet& truth) {
  if (!truth.reversals.empty()) return true;
  if (study.identification && !study.identification->reversals.empty()) return true;
  const std::vector<std::uint8_t> used = states_in_study(study, &truth);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] != 0 && study.machine.states[j].kind == StateKind::approach) return true;
  }
  return false;
}

Campaign gather_readings(const Study& study, const JobOptions& options) {
  Campaign campaign;
  if (study.simulation) campaign.truth = true_errors(study);
  for (std::size_t i = 0; i < study.setups.size(); ++i) {
    stop_if_asked(options.stop);
    const Setup& setup = study.setups[i];
    CampaignSetup result;
    result.name = setup.name;
    result.instrument = setup.instrument;
    result.device = setup.device;
    result.drift = setup.drift;
    const StateChannels channels = read_channels(study.machine, study.channels, setup.channels);
    std::vector<UncertainStart> starts;
    const ChannelUse use = channels.empty() ? ChannelUse{} : ChannelUse{&channels, &starts};
    if (campaign.truth) {
      simulate_setup(study, i, *campaign.truth, options, use, result);
    } else {
      read_setup_files(study, setup, options.stop, use, result);
    }
    warn_of_starts(study, campaign.truth ? &*campaign.truth : nullptr, setup.name, starts, campaign.warnings);
    result.start = result.device;
    if (result.hidden > 0) {
      campaign.notes.push_back(
          fmt::format("{}: {} readings left out for lack of a line of sight", setup.name, result.hidden));
    }
    if (result.reading_count() == 0) {
      throw InputError({.file = setup.name}, "the set-up has no readings", "at least one reading");
    }
    campaign.setups.push_back(std::move(result));
  }
  return campaign;
}

InstrumentReadings read_held_out(const Study& study, const Campaign& campaign) {
  const Setup& setup = study.setups.front();
  const std::shared_ptr<const Instrument>& device = campaign.setups.front().start;
  SetupData data;
  if (!setup.data.empty()) data.mapping = setup.data.front().mapping;
  data.file = *study.identification->held_out_file;
  const StateChannels channels = read_channels(study.machine, study.channels, setup.channels);
  const ChannelUse use{channels.empty() ? nullptr : &channels, nullptr};
  const InstrumentFile file = read_file(study, setup, device, data, use);  // contradictions: told of what is fitted
  const std::vector<std::string> known = device->target_names(), named = file.device->target_names();
  if (named.size() > known.size()) {
    const std::string word = device->target_word();
    throw InputError({.file = data.file.string(), .field = word},
                     fmt::format("{} '{}' was not measured", word, named.back()),
                     fmt::format("{}s of set-up '{}'", word, setup.name));
  }
  InstrumentReadings readings = file.readings;
  take_drift_of(campaign.setups.front(), data.file.string(), readings);
  return readings;
}

void find_start_values(const Machine& machine, Campaign& campaign) {
  for (CampaignSetup& setup : campaign.setups) {
    const auto tell = [&](const std::string& message) { campaign.warnings.push_back(setup.name + ": " + message); };
    for (const std::string& message : setup.contradictions) tell(message);
    StartedInstrument started = setup.device->started(machine, setup.readings);
    for (const std::string& message : started.warnings) tell(message);
    JudgedReadings judged = judge_readings(machine, *setup.device, setup.readings, started);
    setup.judged_places = judged.places;
    setup.unexplained = std::move(judged.unexplained);
    for (const UnexplainedReadings& place : setup.unexplained) tell(place.words());
    setup.start = std::move(started.instrument);
    if (!setup.drift) continue;
    setup.readings.drift = assumed_drift(*setup.drift, *setup.start, setup.readings, setup.name);
    setup.exact.drift = setup.readings.drift;
  }
}

}  // namespace abbe
