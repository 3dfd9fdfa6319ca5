#pragma once

#include <span>
#include <string>

#include "abbe/machine/machine.h"

namespace abbe {

/// "C 30 deg, X 1.5 mm" of commands in chain order, [axes], in mm and rad; those behind the last axis are passed over.
/// @param number  how fmt writes the numbers, in mm and degrees
std::string position_words(const Machine& machine, std::span<const double> commands, const char* number = "{:.6g}");

}  // namespace abbe
