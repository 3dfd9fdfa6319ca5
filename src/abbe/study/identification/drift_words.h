#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/study/study_result.h"

namespace abbe {

/// How far one motion of a place has drifted since the first reading, at some times.
struct FoundDrift {
  std::string place;  ///< "S1"
  std::string setup;
  int component = 0;             ///< as in DriftingPlace
  std::vector<double> time_s;    ///< since the first reading
  std::vector<double> value;     ///< mm or rad
  std::vector<double> expanded;  ///< k = 2
  bool is_angle() const { return component >= 3; }
};

/// Of every place and motion that drifts: at the knots of its walk, or at seven times.
std::vector<FoundDrift> found_drifts(const StudyResult& result);

/// What straight lines between the knots of a walk leave out at most, as standard deviation: sigma sqrt(step)/2 in the
/// middle between two knots, mm or rad; 0 without a walk, or where every reading has a knot.
double walk_between_knots(const CampaignSetup& setup, const DriftingPlace& place, double intensity);

/// Nothing where no set-up drifts.
std::string drift_text(const StudyResult& result);
nlohmann::ordered_json drift_json(const StudyResult& result);

}  // namespace abbe
