#pragma once

#include <string>

#include "abbe/controls/lost_motion.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// "-12 um", "35 urad".
std::string reversal_size(const Machine& machine, std::size_t axis, double value);

/// The lines of linuxcnc_backlash() for the ini file; nothing where there are none.
void print_linuxcnc_backlash(const Machine& machine, const ErrorSet& errors);

}  // namespace abbe
