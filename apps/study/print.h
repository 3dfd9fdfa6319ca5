#pragma once

#include "study/job.h"

namespace abbe {

/// The result of a study for people, on stdout: verdict, key figures, identified values, gauge, warnings.
/// @param all_values  every identified value and every outlier; else the first of them
void print_study(const Study& study, const StudyResult& result, bool all_values = false);

}  // namespace abbe
