#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/machine/path.h"

namespace abbe {

/// A point of a curve that a tool (a beam) follows on the workpiece.
struct CurvePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< mm, workpiece frame
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< from the functional point to the spindle (source)
  double feed = 0;                                       ///< mm/s along the curve on the way here
  bool working = true;                                   ///< the tool works (the beam is on) on the way here
  double dwell = 0;                                      ///< s, waits here working: piercing
  std::vector<double> indexed;                           ///< [Curve::indexed] commands, mm or rad
};

/// A curve with the axes that are set beforehand: where their commands change a new region begins.
struct Curve {
  std::vector<CurvePoint> points;
  std::vector<std::size_t> indexed;  ///< axes of the machine
};

/// Points of a curve, one behind the other, between which the tool works.
struct WorkingRun {
  std::size_t first = 0, last = 0;  ///< of Curve::points; last > first
};

/// The parts of a curve that the tool leaves on the workpiece, in order.
///
/// It does not work on the way to a point that says so, nor to the first one of a region (plan_tool_path() retracts
/// there). A point where it only dwells is no part.
std::vector<WorkingRun> working_runs(const Curve& curve);

struct ToolPathOptions {
  PathOptions path;      ///< held axes, start, weights; indexed axes are added to those held
  double retract = 0;    ///< mm along the direction, before the first and behind the last point of each region; 0: none
  double tolerance = 0;  ///< mm; poses are inserted until the tool stays so near to the straight lines between the
                         ///< points; 0: none inserted
  std::size_t largest_count = 1000000;  ///< poses at most
};

/// One move of all axes to a pose.
struct ToolPathStep {
  static constexpr std::size_t kNoPoint = static_cast<std::size_t>(-1);
  std::array<double, kMaxAxes> command{};  ///< chain order, mm or rad
  bool working = false;                    ///< else a rapid move
  double length = 0;                       ///< mm along the curve, of a move with the tool at work
  double feed = 0;                         ///< mm/s
  double dwell = 0;                        ///< s
  std::size_t point = kNoPoint;            ///< of the curve; none: inserted, or a retracted pose
  std::size_t region = 0;
  int branch = 0;
};

enum class ToolPathStatus {
  not_run,
  followed,
  jumps_while_working,  ///< the axes jump on a move on which the tool works; such steps are listed
  outside_travel,       ///< at `failed_point`
  not_reached,
  start_undecided,  ///< as PathStatus::start_undecided; the message names the axes
  too_many_poses,   ///< the tolerance needs more than largest_count
  no_retract,       ///< several regions and no retract distance
  invalid_options
};

struct ToolPath {
  ToolPathStatus status = ToolPathStatus::not_run;
  std::string message;  ///< in words, where the status is not followed
  std::vector<ToolPathStep> steps;
  std::vector<PathJump> jumps;             ///< `pose` counts in steps
  std::vector<std::size_t> working_jumps;  ///< steps
  std::size_t regions = 0, inserted = 0;
  double largest_deviation = 0;  ///< mm, of the tool from the straight lines while it works, axes interpolated linearly
  double working_length = 0;     ///< mm
  double working_time = 0;       ///< s, at the feeds, with the dwells; without acceleration
  std::size_t failed_point = 0;
};

/// Axis commands for a curve on a machine, region by region, by continuity (follow_path()).
///
/// All axes run linearly between two poses, so the tool leaves the straight line between them; with a tolerance poses
/// are put in at half way (the direction half way too) until it does not. Deviation: of the tool at a quarter, a half
/// and three quarters of the move from the chord.
ToolPath plan_tool_path(const Machine& machine, const Curve& curve, const ToolPathOptions& options = {});

}  // namespace abbe
