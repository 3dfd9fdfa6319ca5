#include "abbe/study/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/errors/error_states.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/identification/simulated_setup.h"
#include "abbe/study/identification/streamed_identification.h"

namespace abbe {
namespace {

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

InstrumentFile read_file(const Study& study, const Setup& setup, const std::shared_ptr<const Instrument>& device,
                         const SetupData& data, const ChannelUse& channels) {
  MeasurementOptions options;
  options.channels = channels;
  options.mapping = data.mapping;
  options.threads = study.threads;
  return read_readings_file(instrument_form(setup.instrument).readings, data.file, study.machine, device, setup.name,
                            setup.noise_from_data, options);
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
      result.shards = shards_too_large(study, setup, options);
      if (result.shards) {
        take_shards(result, campaign.warnings);
      } else {
        read_setup_files(study, setup, options.stop, use, result);
      }
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
