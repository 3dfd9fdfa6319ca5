#pragma once

#include "abbe/runtime/freeze.h"

namespace abbe {

/// Loads the bytes of a frozen compensation and compares its calls with the full model at poses all over travel and map
/// and at three tool lengths; fills in what FrozenCompensation says of them, or a problem.
void freeze_check(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                  FrozenCompensation& result);

}  // namespace abbe
