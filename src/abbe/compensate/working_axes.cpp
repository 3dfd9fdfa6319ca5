#include "abbe/compensate/working_axes.h"

#include <algorithm>

namespace abbe {
namespace {

std::size_t rows_of(TargetKind target) {
  return target == TargetKind::full_pose ? 3 : target == TargetKind::point_and_direction ? 2 : 0;
}

/// Axes that may work: all but those that are kept and those that are set for a job.
std::vector<std::size_t> free_axes(const Machine& machine, const std::vector<HeldAxis>& kept) {
  std::vector<std::size_t> axes;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool is_kept = std::any_of(kept.begin(), kept.end(), [&](const HeldAxis& axis) { return axis.axis == i; });
    if (!is_kept && !machine.axes[i].setting) axes.push_back(i);
  }
  return axes;
}

WorkingAxes of_arm(const Machine& machine, TargetKind target, const std::vector<HeldAxis>& kept,
                   const InversePlan& plan) {
  WorkingAxes working;
  working.is_inverted = true;
  working.orientation_rows = rows_of(target);
  const auto end = plan.arm.begin() + static_cast<std::ptrdiff_t>(plan.arm_count);
  const std::vector<std::size_t> free = free_axes(machine, kept);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool more = machine.axes[i].kind == AxisKind::rotary && std::find(free.begin(), free.end(), i) != free.end();
    if (more || std::find(plan.arm.begin(), end, i) != end) working.arm.push_back(i);
  }
  return working;
}

bool has_idle_rotary_axis(const Machine& machine, const WorkingAxes& working, const std::vector<std::size_t>& free) {
  return std::any_of(free.begin(), free.end(), [&](std::size_t i) {
    return machine.axes[i].kind == AxisKind::rotary &&
           std::find(working.turning.begin(), working.turning.end(), i) == working.turning.end() &&
           std::find(working.reaching.begin(), working.reaching.end(), i) == working.reaching.end();
  });
}

/// Whether a rotary axis that is at work turns with a linear axis that it is coupled to.
bool turns_with_linear_axes(const Machine& machine, const WorkingAxes& working) {
  return std::any_of(machine.couplings.begin(), machine.couplings.end(), [&](const AxisCoupling& coupling) {
    return machine.axes[coupling.axis].kind == AxisKind::rotary &&
           std::find(working.reaching.begin(), working.reaching.end(), coupling.of) != working.reaching.end();
  });
}

}  // namespace

WorkingAxes working_axes(const Machine& machine, TargetKind target, const std::vector<HeldAxis>& kept) {
  const std::vector<double> reference(machine.axes.size(), 0.0);
  InversePlan plan = make_inverse_plan(machine, target, kept, reference);
  if (plan.arm_count > 0) return of_arm(machine, target, kept, plan);
  if (plan.rotary_count == 0 && target != TargetKind::point) {
    plan = make_inverse_plan(machine, TargetKind::point, kept, reference);
  }
  WorkingAxes working;
  working.turning.assign(plan.rotary.begin(), plan.rotary.begin() + static_cast<std::ptrdiff_t>(plan.rotary_count));
  working.reaching.assign(plan.linear.begin(), plan.linear.begin() + static_cast<std::ptrdiff_t>(plan.linear_count));
  if (working.reaching.size() < 3 && plan.polar_count > 0) working.reaching.push_back(plan.polar[0]);
  if (working.turning.empty() || target == TargetKind::point) {
    working.turning.clear();
  } else {
    working.orientation_rows = rows_of(target);
  }
  const std::vector<std::size_t> free = free_axes(machine, kept);
  const bool together = working.reaching.size() < 3 && has_idle_rotary_axis(machine, working, free);
  if (together || turns_with_linear_axes(machine, working)) {
    working = {};
    working.arm = free;
    working.orientation_rows = rows_of(target);
  }
  return working;
}

TargetKind pose_target(const Machine& machine, const std::vector<HeldAxis>& kept) {
  const WorkingAxes whole = working_axes(machine, TargetKind::full_pose, kept);
  if (whole.is_inverted) return TargetKind::full_pose;
  const WorkingAxes part = working_axes(machine, TargetKind::point_and_direction, kept);
  if (part.arm.empty() || part.is_inverted) return TargetKind::point_and_direction;
  // With three linear axes it is a machine tool, one of whose rotary axes is coupled to a linear one.
  const auto linear = std::count_if(part.arm.begin(), part.arm.end(),
                                    [&](std::size_t i) { return machine.axes[i].kind == AxisKind::linear; });
  return linear < 3 ? TargetKind::full_pose : TargetKind::point_and_direction;
}

}  // namespace abbe
