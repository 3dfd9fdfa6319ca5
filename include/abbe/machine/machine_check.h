#pragma once

#include <string>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// One thing wrong with a machine, in words, and where.
struct MachineProblem {
  std::string axis;     ///< name of the axis concerned; empty: the machine as a whole
  std::string field;    ///< "direction", "travel", "point", "name", "side", "primed", "tool_direction", ...
  std::string message;  ///< "direction (0, 0, 2) has length 2, must be 1"

  std::string text() const;  ///< "axis C: direction ..."
};

/// Everything that makes a machine unusable; empty if it is sound.
///
/// Names (ISO 841 letter with optional number, unique), kinds that fit the letter, finite numbers, unit directions (to
/// 1e-9), travel_min <= travel_max within 10 km or 20,000 rad, at least one axis, workpiece-side axes before tool-side
/// ones, primes on the workpiece side only, a proper rotation in bed_from_workpiece; states as MachineState wants them.
std::vector<MachineProblem> find_problems(const Machine& machine);

/// What is allowed and seldom meant, in words: linear axes in one line or one plane (to 1e-3 rad) wherever the rotary
/// axes between them stand.
std::vector<std::string> find_remarks(const Machine& machine);

}  // namespace abbe
