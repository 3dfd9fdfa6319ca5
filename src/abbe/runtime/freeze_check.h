#pragma once

#include "abbe/runtime/freeze.h"

namespace abbe {

/// Largest corrections at poses all over travel and map and at three tool lengths, and uphill from there:
/// FrozenCompensation's largest_correction, with where, and largest_correction_turn; or a problem. The bytes are read
/// for the ranges alone.
void survey_corrections(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                        FrozenCompensation& result);

/// Loads the bytes of a frozen compensation, largest corrections included, and compares its calls with the full model
/// at the same poses; fills in what else FrozenCompensation says of them, or a problem.
void freeze_check(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                  FrozenCompensation& result);

}  // namespace abbe
