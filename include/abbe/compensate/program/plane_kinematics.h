#pragma once

#include <array>
#include <string>

#include "abbe/compensate/program/program_move.h"

namespace abbe {

/// What tilted planes of a program (G68.2, G53.1) need from the machine: the interface that formats uses.
class PlaneKinematics {
 public:
  virtual ~PlaneKinematics() = default;

  /// Why the machine has no tilted planes; empty if it has.
  virtual const std::string& problem() const = 0;

  /// Positions of X, Y, Z that bring the tool to a place on the workpiece, with the rotary axes where they are.
  ///
  /// @param at_zero  rotary words at which X, Y, Z of `words` are positions that reach this place, rad; others unused
  /// @param tool     tool length offset in force, which is in these positions, mm
  /// @param words    in: X, Y, Z with the rotary axes as `at_zero` says, and where the other axes stand; out: X, Y, Z
  ///                 with the rotary axes where they stand; mm, rad
  virtual void turn_with_workpiece(const WordValues& at_zero, const std::array<double, 3>& tool,
                                   WordValues& words) const = 0;

  /// Turns the rotary axes so that the tool, from its point to the spindle, lies along a direction.
  ///
  /// @param direction  `axes`: in directions of positive X, Y, Z words with the rotary axes as `at_zero` says;
  ///                   `tool_centre`: in the workpiece frame
  /// @param words      in: where the axes stand; out: the rotary ones turned; mm, rad
  /// @returns why that is not possible, or an empty text
  virtual std::string turn_tool(ProgramCoordinates coordinates, const std::array<double, 3>& direction,
                                const WordValues& at_zero, WordValues& words) const = 0;
};

}  // namespace abbe
