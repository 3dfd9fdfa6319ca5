#pragma once

#include <string>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// "-12 um", "35 urad".
std::string reversal_size(const Machine& machine, std::size_t axis, double value);

/// Says on stderr which reversal values the errors have, where corrections are the means of both directions.
void warn_of_reversals(const Machine& machine, const ErrorSet& errors);

}  // namespace abbe
