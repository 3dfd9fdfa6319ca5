#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/formats/study.h"
#include "abbe/identify/reading_facts.h"
#include "abbe/instruments/observations.h"

namespace abbe {

using ProgressCallback = std::function<void(std::size_t, std::size_t)>;

/// What was known of a set-up's unknown before the measurement.
struct KnownUnknown {
  std::size_t unknown = 0;          ///< index into Observations::unknowns()
  double value = 0;                 ///< mm or rad
  double standard_uncertainty = 0;  ///< mm or rad, > 0
};

/// One set-up of a study with its readings: what the steps of a study need to know of an instrument, whatever it is.
class CampaignSetup {
 public:
  virtual ~CampaignSetup() = default;

  std::string name;
  std::vector<std::uint32_t> outliers;  ///< simulation: readings made to outliers
  std::size_t hidden = 0;               ///< simulation: sights left out for lack of a line of sight

  virtual const PoseList& poses() const = 0;
  virtual const std::vector<double>& time_s() const = 0;
  /// [readings] names of the points in the input, or empty.
  virtual const std::vector<std::string>& points() const = 0;
  std::size_t reading_count() const { return poses().count(); }

  /// The readings as a measurement file.
  virtual std::string readings_text(const Machine& machine) const = 0;

  /// What else is known of the readings, to look for patterns in them.
  virtual ReadingFacts facts() const = 0;

  /// Finds from the data what has to be known roughly before an identification can start.
  virtual void find_start(const Machine& machine, std::vector<std::string>& warnings,
                          std::vector<std::string>& notes) = 0;

  /// The readings as residuals of these errors; the unknowns stand at their start.
  virtual std::unique_ptr<Observations> observations(const Machine& machine, const ErrorSet& errors) const = 0;
  /// The same for what an instrument without noise would have read; simulation only.
  virtual std::unique_ptr<Observations> exact_observations(const Machine& machine, const ErrorSet& errors) const = 0;

  virtual std::vector<KnownUnknown> known_unknowns() const = 0;
  /// The same unknowns with what they really are; simulation only.
  virtual std::vector<KnownUnknown> true_unknowns() const = 0;
};

/// All readings of a study, measured or simulated, and what is known about them.
struct Campaign {
  std::vector<std::shared_ptr<CampaignSetup>> setups;
  std::optional<ErrorSet> truth;      ///< simulation: the errors the machine really has
  std::vector<std::string> warnings;  ///< swapped reflectors, poses that the data do not determine
  std::vector<std::string> notes;     ///< what was done, for the report's assumptions

  std::size_t reading_count() const;
};

/// True errors of a simulated study: from its file, or drawn and scaled.
ErrorSet true_errors(const Study& study);

/// True if readings are to say from which side the axes came: some axis has a reversal value, or one is identified.
bool approach_matters(const Study& study, const ErrorSet& truth);

/// Seed of one plan: every plan of every set-up has numbers of its own, whatever stands beside it in the study.
std::uint64_t plan_seed(const Study& study, std::size_t setup, std::size_t plan);

/// Poses of a plan of one of the kinds grid, line, random, spiral and step diagonal, repeated as it says.
PoseList plan_poses(const Machine& machine, const MeasurementPlan& plan, std::uint64_t seed);

/// Reads or simulates all readings. Start values are not yet looked for. @throws InputError
Campaign gather_readings(const Study& study, const ProgressCallback& progress = {});

/// Finds what every set-up needs to start with; appends what there is to say.
void find_start_values(const Machine& machine, Campaign& campaign);

}  // namespace abbe
