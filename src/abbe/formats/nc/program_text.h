#pragma once

// Internal to formats: words and comments of NC programs.
#include <string>

#include "abbe/machine/machine.h"

namespace abbe {

/// Command of an axis as programs and tables state it: degrees or mm.
double in_degrees_or_mm(const Axis& axis, double command);

/// Fixed digits without a minus before zero.
std::string fixed_number(double value, int decimals);

/// A line with a comment in parentheses: what it may not hold becomes blanks.
std::string program_comment(std::string text);

}  // namespace abbe
