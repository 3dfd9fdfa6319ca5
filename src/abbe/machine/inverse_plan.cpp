#include "abbe/machine/inverse_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "abbe/geometry/rotation.h"
#include "abbe/machine/arm_axes.h"

namespace abbe {
namespace {

/// Sine of the angle below which two directions count as parallel when axes are chosen.
constexpr double kParallel = 1e-6;

bool parallel(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.cross(b).norm() < kParallel; }

/// Axes of one kind that may work, those to be held first at the front: setting axes, then from the workpiece on.
std::vector<std::size_t> by_readiness_to_be_held(const Machine& machine, const InversePlan& plan, AxisKind kind) {
  std::vector<std::size_t> order;
  for (const bool setting : {true, false}) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const Axis& axis = machine.axes[i];
      if (axis.kind == kind && axis.setting == setting && !plan.held[i]) order.push_back(i);
    }
  }
  return order;
}

/// Fills direction and held_rotation for the rotary axes chosen so far.
void fold_held_axes(const Machine& machine, InversePlan& plan) {
  plan.held_rotation.setIdentity();
  std::size_t next = 0;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    if (axis.kind != AxisKind::rotary) continue;
    if (next < plan.rotary_count && plan.rotary[next] == i) {
      plan.direction[next++] = plan.held_rotation * axis.direction;
    } else {
      plan.held_rotation = plan.held_rotation * rotation_about(axis.direction, chain_sign(axis) * plan.command[i]);
    }
  }
}

/// Whether the chosen rotary axes turn what they must, each independently of its neighbour.
bool chosen_axes_can(const Machine& machine, const InversePlan& plan, TargetKind kind) {
  for (std::size_t k = 0; k + 1 < plan.rotary_count; ++k) {
    if (parallel(plan.direction[k], plan.direction[k + 1])) return false;
  }
  if (kind == TargetKind::full_pose || plan.rotary_count == 0) return true;
  return !parallel(plan.direction[plan.rotary_count - 1], plan.held_rotation * machine.tool_direction);
}

/// Chooses as many rotary axes as the target needs, or as can work.
void choose_rotary(const Machine& machine, TargetKind kind, InversePlan& plan) {
  const std::vector<std::size_t> order = by_readiness_to_be_held(machine, plan, AxisKind::rotary);
  const std::uint32_t all = 1U << order.size();
  std::size_t count = std::min(plan.rotary_wanted, order.size());
  for (;; --count) {
    // Bit k: order[k] is held. The lowest numbers with the right count of bits come first, so count down from the
    // front.
    std::uint32_t best = 0;
    bool found = false;
    for (std::uint32_t held = 0; held < all; ++held) {
      if (order.size() - static_cast<std::size_t>(std::popcount(held)) != count) continue;
      plan.rotary_count = 0;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        for (std::size_t k = 0; k < order.size(); ++k) {
          if (order[k] == i && (held >> k & 1U) == 0) plan.rotary[plan.rotary_count++] = i;
        }
      }
      fold_held_axes(machine, plan);
      if (!chosen_axes_can(machine, plan, kind)) continue;
      best = held;
      found = true;
      break;
    }
    if (found || count == 0) {
      for (std::size_t k = 0; k < order.size(); ++k) plan.held[order[k]] = (best >> k & 1U) != 0;
      return;
    }
  }
}

/// Chooses up to three linear axes that are independent where the rotary axes stand anywhere.
void choose_linear(const Machine& machine, InversePlan& plan) {
  // Directions at angles without special relation: only what is dependent everywhere is dependent here.
  std::array<Eigen::Vector3d, kMaxAxes> seen;
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    seen[i] = turned * axis.direction;
    const bool moves = axis.kind == AxisKind::rotary && !plan.held[i];
    const double angle = moves ? 0.7 + 0.9 * static_cast<double>(i) : chain_sign(axis) * plan.command[i];
    if (axis.kind == AxisKind::rotary) turned = turned * rotation_about(axis.direction, angle);
  }
  const std::vector<std::size_t> order = by_readiness_to_be_held(machine, plan, AxisKind::linear);
  std::array<Eigen::Vector3d, 3> span;  // orthonormal basis of the directions chosen
  std::size_t rank = 0;
  for (std::size_t k = order.size(); k-- > 0;) {
    Eigen::Vector3d rest = seen[order[k]];
    for (std::size_t j = 0; j < rank; ++j) rest -= rest.dot(span[j]) * span[j];
    const bool chosen = rank < 3 && rest.norm() > kParallel;
    if (chosen) span[rank++] = rest.normalized();
    plan.held[order[k]] = !chosen;
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind == AxisKind::linear && !plan.held[i]) plan.linear[plan.linear_count++] = i;
  }
}

/// Finds rotary axes that may serve the position because the target does not care about their turn.
void choose_polar(const Machine& machine, TargetKind kind, std::span<const HeldAxis> held, InversePlan& plan) {
  if (plan.linear_count >= 3 || kind == TargetKind::full_pose) return;
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    if (axis.kind != AxisKind::rotary || !plan.held[i]) continue;
    const Eigen::Vector3d direction = turned * axis.direction;
    turned = turned * rotation_about(axis.direction, chain_sign(axis) * plan.command[i]);
    bool named = axis.setting;
    for (const HeldAxis& fixed : held) named = named || fixed.axis == i;
    // With other rotary axes at work its direction against the tool's is not constant.
    const bool harmless = kind == TargetKind::point ||
                          (plan.rotary_count == 0 && parallel(direction, plan.held_rotation * machine.tool_direction));
    if (!named && harmless) plan.polar[plan.polar_count++] = i;
  }
}

}  // namespace

double chain_sign(const Axis& axis) { return axis.side == ChainSide::workpiece ? -axis.sense() : axis.sense(); }

InversePlan make_inverse_plan(const Machine& machine, TargetKind kind, std::span<const HeldAxis> held,
                              std::span<const double> reference) {
  InversePlan plan;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) plan.command[i] = reference[i];
  for (const HeldAxis& axis : held) {
    plan.held[axis.axis] = plan.held_by_option[axis.axis] = true;
    plan.command[axis.axis] = axis.position;
  }
  plan.rotary_wanted = kind == TargetKind::full_pose ? 3 : kind == TargetKind::point_and_direction ? 2 : 0;
  choose_rotary(machine, kind, plan);
  choose_linear(machine, plan);
  choose_polar(machine, kind, held, plan);
  const bool suffices =
      plan.rotary_count == plan.rotary_wanted && plan.linear_count + std::min<std::size_t>(plan.polar_count, 1) >= 3;
  if (!suffices) choose_arm_axes(machine, kind, plan);
  return plan;
}

}  // namespace abbe
