#pragma once

#include <array>

#include "abbe/runtime/frozen_machine.h"

namespace abbe {

/// Positions of all axes (commands, where no axis is coupled) with cosines and sines of the rotary ones. What
/// iterations move is kept beside the command that came in: in the sum of both, after many turns, the steps that are
/// looked for would be lost in rounding.
struct FrozenCommands {
  std::array<double, kFrozenAxes> q;        ///< as given, mm or rad
  std::array<double, kFrozenAxes> in_turn;  ///< rotary: q less whole turns, from -pi to pi; linear: q
  std::array<double, kFrozenAxes> by;       ///< moved from there by so much
  std::array<CosineSine, kFrozenAxes> turn;

  double at(std::size_t i) const { return q[i] + by[i]; }
};

/// An angle of up to 1e6 rad less the nearest whole number of turns, rounded once.
double less_whole_turns(double angle);

/// Sets an axis to a command that came in.
void set_axis(const FrozenAxis& axis, std::size_t i, double to, FrozenCommands& commands);

/// Cosine and sine of small angles (series, to rounding); of others by the library.
CosineSine turn_of(double angle);

/// Cosine and sine of a sum.
inline CosineSine turned_on(const CosineSine& a, const CosineSine& b) {
  return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s};
}

/// Moves an axis from where it stands in `from`, which is not moved itself, with its cosine and sine.
void move_axis(const FrozenAxis& axis, std::size_t i, const FrozenCommands& from, double by, FrozenCommands& commands);

/// The axes of a machine without errors, seen from the workpiece.
struct NominalView {
  Triple point;      ///< functional point, mm; axes that are solved from the point stand at zero
  Triple direction;  ///< of the tool, unit
  /// Direction in which a positive command of an axis moves (turns) the tool side against the workpiece side.
  std::array<Triple, kFrozenAxes> column;
  std::array<Triple, kFrozenAxes> origin;  ///< rotary: a point on the axis; solved axes stand at zero
};

/// @param solve_later  true: solved axes stand at zero; false: all axes where they are
NominalView nominal_view(const abbe_runtime& machine, const FrozenCommands& commands, const Triple& tool,
                         bool solve_later);

/// Where the ACTUAL tool is, in the workpiece frame.
struct ActualTool {
  Triple point;      ///< mm
  Triple direction;  ///< unit
};
/// @param enable  part of the errors, 0 to 1
ActualTool actual_tool(const abbe_runtime& machine, const FrozenCommands& commands, const Triple& tool, double enable);

}  // namespace abbe
