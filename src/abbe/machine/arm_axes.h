#pragma once

#include "abbe/machine/inverse_plan.h"

namespace abbe {

/// Chooses the rotary axes of a jointed arm that serve a target together, if there are enough of them.
///
/// Axes beyond those needed are held: those marked Axis::setting first, then those whose holding leaves the others the
/// largest volume |det J|, on the average over poses all over travel; of equals, those nearest the workpiece. All
/// linear axes are held. Nothing changes where the rest could not move in all directions that count.
void choose_arm_axes(const Machine& machine, TargetKind kind, InversePlan& plan);

}  // namespace abbe
