#pragma once

#include "study/job.h"

namespace abbe {

/// The result of a study for people, on stdout: verdict, key figures, gauge, warnings.
void print_study(const Study& study, const StudyResult& result);

}  // namespace abbe
