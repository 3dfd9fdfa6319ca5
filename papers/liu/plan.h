#pragma once

#include "abbe/errors/poses.h"
#include "abbe/plan/scans/scan_plan.h"
#include "liu/parts.h"

namespace abbe {

/// What stands below a part and turns with it, workpiece frame: the table of C, radius 30 mm (Table 2), 36 mm below the
/// middle of the chuck, and a stalk of 2.5 mm up to the part.
/// @param lowest  mm, y of the lowest point of the part
TriangleMesh liu_stage(double lowest);

/// Paths over a part for the scanner of the paper: probe of Table 2, points and lines 1 mm apart.
/// @param workpiece_from_part  where it is clamped, as found by the calibration of the clamping
ScanPlan liu_plan(const Machine& machine, const LiuPart& part, const RigidTransform& workpiece_from_part);
ScanPlanOptions liu_plan_options(const LiuPart& part, const RigidTransform& workpiece_from_part);

/// Commands of a plan at which it measures.
PoseList measuring_positions(const ScanPlan& plan);

}  // namespace abbe
