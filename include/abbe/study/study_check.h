#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/study/campaign.h"

namespace abbe {

/// A study before anything is identified: its readings, and whether the nominal machine explains them.
struct StudyCheck {
  Campaign campaign;  ///< with start values

  /// False if readings of any place do not fit the nominal machine: see unexplained_readings().
  bool is_explained() const;
  /// Places whose readings can be compared with the nominal machine before anything is identified.
  std::size_t judged_places() const;
};

/// Reads or simulates the readings of a study and finds where instruments stood. Progress as gather_readings().
/// @throws InputError
/// @throws Stopped
StudyCheck check_study(const Study& study, const JobOptions& options = {});

/// For people; complete lines.
std::string study_check_text(const Study& study, const StudyCheck& check);
/// For programs.
nlohmann::ordered_json study_check_json(const Study& study, const StudyCheck& check);

}  // namespace abbe
