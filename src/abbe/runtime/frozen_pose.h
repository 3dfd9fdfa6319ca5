#pragma once

#include <array>

#include "abbe/runtime/frozen_machine.h"

namespace abbe {

/// Commands of all axes with cosines and sines of the rotary ones.
struct FrozenCommands {
  std::array<double, kFrozenAxes> q;
  std::array<CosineSine, kFrozenAxes> turn;
};

/// Cosine and sine of small angles (series, to rounding); of others by the library.
CosineSine turn_of(double angle);

/// Cosine and sine of a sum.
inline CosineSine turned_on(const CosineSine& a, const CosineSine& b) {
  return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s};
}

/// Sets an axis and keeps its cosine and sine in step: by the small difference where there is one.
void move_axis(const FrozenAxis& axis, std::size_t i, double to, FrozenCommands& commands);

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
