#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/formats/study/study.h"
#include "abbe/identify/trust/reading_facts.h"
#include "abbe/instruments/instrument.h"
#include "abbe/study/identification/unexplained_readings.h"
#include "abbe/study/job_options.h"

namespace abbe {

using ProgressCallback = std::function<void(std::size_t, std::size_t)>;

class ReadingShards;

/// What was known of a set-up's unknown before the measurement.
struct KnownUnknown {
  std::size_t unknown = 0;          ///< index into Observations::unknowns()
  double value = 0;                 ///< mm or rad
  double standard_uncertainty = 0;  ///< mm or rad, > 0
};

/// What is known beforehand of the unknowns of an instrument's set-up.
std::vector<KnownUnknown> known_unknowns_of(const Instrument& device);

/// One set-up of a study with its readings.
struct CampaignSetup {
  std::string name;
  std::string instrument;                       ///< as Setup::instrument
  std::shared_ptr<const Instrument> device;     ///< as the study and the files of readings state it
  std::shared_ptr<const Instrument> start;      ///< as the identification starts: `device` until find_start_values()
  std::shared_ptr<const Instrument> truth;      ///< simulation: as it really is
  InstrumentReadings readings;                  ///< with `shards`: the part that is kept
  std::shared_ptr<const ReadingShards> shards;  ///< all readings, where they are more than a study keeps
  InstrumentReadings exact;                     ///< simulation: the same readings without noise and outliers
  std::vector<std::uint32_t> outliers;          ///< simulation: readings made to outliers
  std::size_t hidden = 0;                       ///< simulation: sights left out for lack of a line of sight
  std::vector<std::string> contradictions;      ///< in words, where a file of readings and the study differ
  std::size_t judged_places = 0;   ///< by find_start_values(): from where readings can be compared with the machine
  std::optional<DriftPlan> drift;  ///< as Setup::drift; find_start_values() puts it into the readings
  std::shared_ptr<const SetupDrift> true_drift;  ///< simulation
  std::vector<UnexplainedReadings> unexplained;  ///< by find_start_values(): the nominal machine does not explain them

  const PoseList& poses() const { return readings.poses; }
  std::size_t reading_count() const { return readings.count(); }

  /// The readings as a measurement file.
  std::string readings_text(const Machine& machine) const;

  /// What else is known of the readings, to look for patterns in them.
  ReadingFacts facts() const;

  /// The readings as residuals of these errors; the unknowns stand at their start.
  std::unique_ptr<Observations> observations(const Machine& machine, const ErrorSet& errors) const;
  /// The same for what an instrument without noise would have read; simulation only.
  std::unique_ptr<Observations> exact_observations(const Machine& machine, const ErrorSet& errors) const;

  std::vector<KnownUnknown> known_unknowns() const;
  /// The same unknowns with their true values; simulation only.
  std::vector<KnownUnknown> true_unknowns() const;
};

/// All readings of a study, measured or simulated, and what is known about them.
struct Campaign {
  std::vector<CampaignSetup> setups;
  std::optional<ErrorSet> truth;      ///< simulation: the errors the machine really has
  std::vector<std::string> warnings;  ///< swapped reflectors, poses that the data do not determine
  std::vector<std::string> notes;     ///< what was done, for the report's assumptions

  std::size_t reading_count() const;
  /// After find_start_values(): false if the readings of any station do not fit the nominal machine.
  bool is_explained() const;
};

/// True errors of a simulated study: from its file, or drawn and scaled.
ErrorSet true_errors(const Study& study);

/// True if readings need the direction of approach: some axis has a reversal value, or one is identified.
bool approach_matters(const Study& study, const ErrorSet& truth);

/// Reads or simulates all readings. Start values are not yet looked for.
/// @param options  progress in poses of a plan that is simulated, from one thread at a time; a file is read whole
///   before a stop is looked at
/// @throws InputError
/// @throws Stopped
Campaign gather_readings(const Study& study, const JobOptions& options = {});

/// Readings of the first set-up's instrument that are for validation only, from the study's held-out file.
/// @throws InputError
InstrumentReadings read_held_out(const Study& study, const Campaign& campaign);

/// Finds the start values of every set-up; appends remarks for the user.
void find_start_values(const Machine& machine, Campaign& campaign);

}  // namespace abbe
