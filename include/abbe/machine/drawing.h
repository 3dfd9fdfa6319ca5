#pragma once

#include <string>

#include "abbe/machine/machine.h"

namespace abbe {

/// The machine as a text drawing for a terminal: the chain from the workpiece down to the tool, one line per axis.
///
/// Per axis: linear (box) or rotary (circle), name, how what it carries moves at a positive command (arrow and
/// direction; a primed axis moves it the other way), a point on a rotary axis, travel. UTF-8, lines end in "\n", at
/// most 80 columns; lengths in mm, angles in deg. Deterministic. Numbers are rounded for reading: this is no file
/// format.
std::string draw_machine(const Machine& machine);

}  // namespace abbe
