#pragma once

#include <string>

#include "abbe/controls/lost_motion.h"

namespace abbe {

/// The lines of linuxcnc_backlash() for the ini file, complete lines; empty where there are none.
std::string linuxcnc_backlash_text(const Machine& machine, const ErrorSet& errors);

}  // namespace abbe
