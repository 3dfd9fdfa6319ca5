#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/formats/study/study.h"
#include "abbe/identify/identify.h"
#include "abbe/study/campaign.h"
#include "abbe/study/identification/sensor_selection.h"

namespace abbe {

/// How well readings of blocks of time are predicted by the others with some of the sensors.
struct HeldOutSensors {
  std::vector<std::size_t> sensors;  ///< indices into RankedSensors::names
  double rms = 0;                    ///< of the held-out residuals, standard uncertainties; root of a mean over blocks
  double standard_error = 0;         ///< of the mean square
  double length_rms = 0;             ///< mm, of lengths of the residuals; 0: the instruments measure none
  std::vector<std::string> terms;    ///< with states, that are in the model
};

/// Which measured states the readings need, by blocks of time that are held out. Terms that may be left out are chosen
/// anew for every set of sensors; terms without one of their sensors are not in the model.
struct RankedSensors {
  bool done = false;  ///< false: the model without terms with states could not be identified
  IdentifyStatus status = IdentifyStatus::not_run;
  std::vector<std::string> names;       ///< "column_degC"
  std::vector<HeldOutSensors> forward;  ///< none, then one more at a time, the best first
  std::vector<HeldOutSensors> without;  ///< all but one, the one that is missed most first
  std::size_t enough = 0;  ///< index into forward: the smallest number within a standard error of the smallest error
  std::size_t blocks = 0;  ///< that all sets of sensors predict
  std::vector<std::string> courses;   ///< names of what SensorLikeness counts
  std::vector<SensorLikeness> alike;  ///< courses that cannot be told apart, or do not change
};

/// @param problem  of the study with all terms; observations stand where they stood afterwards
/// @throws InputError where readings have no times
RankedSensors rank_sensors(const Study& study, const Campaign& campaign, const Problem& problem,
                           const IdentifyOptions& options);

std::string ranked_sensors_text(const RankedSensors& ranked);
/// What is enough, and what remains with each number of sensors: a sentence for the report.
std::string ranked_sensors_sentence(const RankedSensors& ranked);
nlohmann::ordered_json ranked_sensors_json(const RankedSensors& ranked);

}  // namespace abbe
