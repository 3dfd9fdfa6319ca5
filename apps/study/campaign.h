#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/study.h"
#include "abbe/instruments/tracker_observations.h"
#include "abbe/instruments/tracker_simulation.h"

namespace abbe {

/// One set-up of a study with its readings.
struct CampaignSetup {
  std::string name;
  TrackerSetup start;  ///< stations and reflectors as the identification starts with them
  TrackerSetup truth;  ///< simulation: as they really are
  TrackerReadings readings;
  TrackerReadings exact;                ///< simulation: the same readings without noise and outliers
  std::vector<std::uint32_t> outliers;  ///< simulation: readings made to outliers
  std::size_t hidden = 0;               ///< simulation: sights without a line of sight
};

/// All readings of a study, measured or simulated, and what is known about them.
struct Campaign {
  std::vector<CampaignSetup> setups;
  std::optional<ErrorSet> truth;      ///< simulation: the errors the machine really has
  std::vector<std::string> warnings;  ///< swapped reflectors, poses that the data do not determine
  std::vector<std::string> notes;     ///< what was done, for the report's assumptions

  std::size_t reading_count() const;
};

using ProgressCallback = std::function<void(std::size_t, std::size_t)>;

/// True errors of a simulated study: from its file, or drawn and scaled.
ErrorSet true_errors(const Study& study);

/// Reads or simulates all readings. Station poses are not yet looked for. @throws InputError
Campaign gather_readings(const Study& study, const ProgressCallback& progress = {});

/// Readings of the first set-up's instrument that are for validation only, from the study's held-out file. @throws
/// InputError
TrackerReadings read_held_out(const Study& study, const Campaign& campaign);

/// Finds the pose of every estimated station from the data and puts it into `start`; appends what it has to say.
void find_start_poses(const Machine& machine, Campaign& campaign);

}  // namespace abbe
