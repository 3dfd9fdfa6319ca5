#pragma once

#include "abbe/formats/files/results_folder.h"
#include "liu/results.h"

namespace abbe {

/// Files of the study: machine, errors of Table 3 and as calibrated, readings of the clamping; of every part, with the
/// shifts of Table 3 in micrometres, its mesh, path (CSV and program), coverage, data for pages, and the measured
/// points with their deviations before and after compensation.
void write_liu_study(const LiuResults& results, ResultsFolder& out);

}  // namespace abbe
