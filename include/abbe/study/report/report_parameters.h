#pragma once

#include <nlohmann/json_fwd.hpp>

#include "abbe/study/study_result.h"

namespace abbe {

/// Curves of the identified error motions with their 95 % band, and the truth in the same gauge where it is known.
/// @param truth  may be null
nlohmann::ordered_json report_error_motions(const Machine& machine, const Identification& identification,
                                            const ErrorSet* truth);

/// Identified location errors.
nlohmann::ordered_json report_location_errors(const Machine& machine, const Identification& identification,
                                              const ErrorSet* truth);

/// In um/m, as people state them, or among the lengths and angles in mm and mrad, as in JSON.
enum class ScalesIn { um_per_m, mm_and_mrad };

/// Columns of the table of all estimated parameters.
/// @param scales_in  how scales of set-ups, which are pure numbers, are written
nlohmann::ordered_json report_parameters(const Machine& machine, const StudyResult& result, const ErrorSet* truth,
                                         ScalesIn scales_in);

}  // namespace abbe
