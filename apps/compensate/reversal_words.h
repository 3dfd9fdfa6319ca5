#pragma once

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Says on stderr which reversal values the errors have, as corrections so far are the means of both directions.
void warn_of_reversals(const Machine& machine, const ErrorSet& errors);

}  // namespace abbe
