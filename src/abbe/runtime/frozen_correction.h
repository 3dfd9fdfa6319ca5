#pragma once

#include "abbe/runtime/frozen_pose.h"

namespace abbe {

/// What was found between nominal commands q0 and actual ones q. Both directions solve the same equations,
///
///   q - q0 = bounded solution of  [nominal derivative at q0] (q - q0) = [nominal pose at q0] - [actual pose at q],
///
/// once for q and once for q0, so that they are inverse to each other. Method: docs/runtime.md.
struct FrozenResult {
  int result = 0;      ///< ABBE_...
  int iterations = 0;  ///< evaluations of the actual pose, or of the nominal one
};

/// @param nominal   commands of all axes
/// @param view      of them, with all axes where they are
/// @param goal      point in the workpiece frame, mm
/// @param actual    in: commands to start from; out
FrozenResult solve_actual(const abbe_runtime& machine, const FrozenCommands& nominal, const NominalView& view,
                          const Triple& goal, const Triple& tool, double enable, FrozenCommands& actual);

/// @param nominal  in: commands to start from; out
/// @param point    out: where the actual tool is, workpiece frame, mm
FrozenResult solve_nominal(const abbe_runtime& machine, const FrozenCommands& actual, const Triple& tool, double enable,
                           FrozenCommands& nominal, Triple& point);

/// Commands of the three axes that are solved from the point.
/// @param view  with solved axes at zero
/// @return false if they lie in one plane
bool solve_point(const abbe_runtime& machine, const NominalView& view, const Triple& point, FrozenCommands& commands);

}  // namespace abbe
