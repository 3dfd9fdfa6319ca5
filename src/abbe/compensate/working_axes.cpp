#include "abbe/compensate/working_axes.h"

namespace abbe {

WorkingAxes working_axes(const Machine& machine, TargetKind target, const std::vector<HeldAxis>& kept) {
  const std::vector<double> reference(machine.axes.size(), 0.0);
  InversePlan plan = make_inverse_plan(machine, target, kept, reference);
  WorkingAxes working;
  if (plan.arm_count > 0) {
    working.arm.assign(plan.arm.begin(), plan.arm.begin() + static_cast<std::ptrdiff_t>(plan.arm_count));
    working.orientation_rows = plan.arm_count - 3;
    return working;
  }
  if (plan.rotary_count == 0 && target != TargetKind::point) {
    plan = make_inverse_plan(machine, TargetKind::point, kept, reference);
  }
  working.turning.assign(plan.rotary.begin(), plan.rotary.begin() + static_cast<std::ptrdiff_t>(plan.rotary_count));
  working.reaching.assign(plan.linear.begin(), plan.linear.begin() + static_cast<std::ptrdiff_t>(plan.linear_count));
  if (working.reaching.size() < 3 && plan.polar_count > 0) working.reaching.push_back(plan.polar[0]);
  if (working.turning.empty() || target == TargetKind::point) {
    working.turning.clear();
  } else {
    working.orientation_rows = target == TargetKind::full_pose ? 3 : 2;
  }
  return working;
}

}  // namespace abbe
