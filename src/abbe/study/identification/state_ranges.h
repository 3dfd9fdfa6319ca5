#pragma once

#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/study/study_result.h"

namespace abbe {

/// Values of the measured and lag states on which the identified errors depend, over all readings that were used.
std::vector<CoveredState> covered_states(const Study& study, const StudyResult& result);

/// Time from the first to the last reading, s: the longest of a set-up; 0 where readings have no times.
double covered_time_s(const StudyResult& result);

}  // namespace abbe
