#include "abbe/machine/arm_axes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "abbe/geometry/rotation.h"
#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

/// Mean volume, with lengths in units of the arm's, below which axes count as dependent everywhere.
constexpr double kNoVolume = 1e-6;
/// Volumes that differ by less than this part count as equal.
constexpr double kEqualVolumes = 1e-6;

using ArmMatrix = Eigen::Matrix<double, 6, 6>;

/// Determinant of the first n rows and columns, by elimination.
double determinant(ArmMatrix m, Eigen::Index n) {
  double product = 1;
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index largest = k;
    for (Eigen::Index i = k + 1; i < n; ++i) {
      if (std::abs(m(i, k)) > std::abs(m(largest, k))) largest = i;
    }
    if (m(largest, k) == 0) return 0;
    if (largest != k) {
      m.row(largest).swap(m.row(k));
      product = -product;
    }
    product *= m(k, k);
    for (Eigen::Index i = k + 1; i < n; ++i) m.row(i) -= m(i, k) / m(k, k) * m.row(k);
  }
  return product;
}

/// Distance from the first to the last of the axes and the tool, from each to the next, with all axes at zero.
double reach(const Machine& machine) {
  double sum = 0;
  Eigen::Vector3d last = machine.tool_reference + machine.tool_offset;
  for (std::size_t i = machine.axes.size(); i-- > 0;) {
    if (machine.axes[i].kind != AxisKind::rotary) continue;
    sum += (machine.axes[i].point - last).norm();
    last = machine.axes[i].point;
  }
  return std::max(sum, 1e-9);
}

class ArmChoice {
 public:
  ArmChoice(const Machine& machine, const InversePlan& plan)
      : machine_(machine), plan_(plan), length_(reach(machine)) {}

  /// Mean volume of the working axes over poses; the other ones stand at their command.
  double volume(const std::array<std::size_t, 6>& working, std::size_t count, int poses) const {
    double sum = 0;
    for (int k = 0; k < poses; ++k) sum += volume_at(working, count, k);
    return sum / poses;
  }

 private:
  /// A position within travel; the numbers of one axis fill it evenly (additive recurrences with square roots).
  double command(std::size_t i, int pose) const {
    constexpr std::array<double, kMaxAxes> kRoot{0.4142, 0.7321, 0.2361, 0.6458, 0.3166, 0.6056, 0.1231, 0.3589,
                                                 0.7958, 0.3852, 0.5678, 0.0828, 0.4031, 0.5574, 0.8557, 0.2801};
    const Axis& axis = machine_.axes[i];
    const double part = std::fmod(0.37 + kRoot[i] * (pose + 1), 1.0);
    if (axis.endless) return 2 * std::numbers::pi * part;
    const PositionLimits travel = position_limits(machine_, i);
    return travel.from + part * (travel.to - travel.from);
  }

  double volume_at(const std::array<std::size_t, 6>& working, std::size_t count, int pose) const {
    std::array<Eigen::Vector3d, 6> direction, point;
    RigidTransform carried;
    std::size_t next = 0;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const Axis& axis = machine_.axes[i];
      const bool works = next < count && working[next] == i;
      const double displacement = chain_sign(axis) * (works ? command(i, pose) : plan_.command[i]);
      if (works) {
        direction[next] = carried.rotation * axis.direction;
        point[next++] = carried * axis.point;
      }
      if (axis.kind == AxisKind::linear) {
        carried.translation += displacement * (carried.rotation * axis.direction);
      } else {
        const Eigen::Matrix3d turn = rotation_about(axis.direction, displacement);
        carried = carried * RigidTransform{turn, axis.point - turn * axis.point};
      }
    }
    const Eigen::Vector3d tool = carried * (machine_.tool_reference + machine_.tool_offset);
    const Eigen::Vector3d along = carried.rotation * machine_.tool_direction;
    const Eigen::Vector3d first = along.unitOrthogonal(), second = along.cross(first);
    ArmMatrix by_axis = ArmMatrix::Zero();
    for (std::size_t k = 0; k < count; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      by_axis.col(column).head<3>() = direction[k].cross(tool - point[k]) / length_;
      by_axis.col(column).tail<3>() << first.dot(direction[k]), second.dot(direction[k]), along.dot(direction[k]);
    }
    return std::abs(determinant(by_axis, static_cast<Eigen::Index>(count)));
  }

  const Machine& machine_;
  const InversePlan& plan_;
  double length_;
};

std::size_t axes_needed(TargetKind kind) {
  return kind == TargetKind::full_pose ? 6 : kind == TargetKind::point_and_direction ? 5 : 3;
}

}  // namespace

void choose_arm_axes(const Machine& machine, TargetKind kind, InversePlan& plan) {
  const std::size_t needed = axes_needed(kind);
  std::vector<std::size_t> order;  // those to be held first of equals at the end
  for (std::size_t i = machine.axes.size(); i-- > 0;) {
    if (machine.axes[i].kind == AxisKind::rotary && !plan.held_by_option[i]) order.push_back(i);
  }
  if (order.size() < needed) return;
  constexpr std::size_t kFew = 1000;
  std::size_t subsets = 0;
  for (std::uint32_t held = 0; held < (1U << order.size()); ++held) {
    if (order.size() - static_cast<std::size_t>(std::popcount(held)) == needed) ++subsets;
  }
  const int poses = subsets > kFew ? 6 : 24;
  const ArmChoice choice(machine, plan);
  // Most setting axes held, then the largest volume.
  std::pair<int, double> best{-1, 0};
  std::array<std::size_t, 6> chosen{};
  for (std::uint32_t held = 0; held < (1U << order.size()); ++held) {
    if (order.size() - static_cast<std::size_t>(std::popcount(held)) != needed) continue;
    std::array<std::size_t, 6> working{};
    std::size_t count = 0;
    int settings = 0;
    for (std::size_t k = order.size(); k-- > 0;) {
      if ((held >> k & 1U) == 0) working[count++] = order[k];
      if ((held >> k & 1U) != 0 && machine.axes[order[k]].setting) ++settings;
    }
    const double volume = choice.volume(working, count, poses);
    if (!(volume > kNoVolume) || settings < best.first) continue;
    const bool larger = volume > best.second * (1 + kEqualVolumes);
    // Of equals the later one: more of the axes nearest the workpiece are held.
    const bool equal = volume > best.second * (1 - kEqualVolumes);
    if (settings > best.first || larger || equal) {
      best = {settings, settings > best.first ? volume : std::max(volume, best.second)};
      chosen = working;
    }
  }
  if (best.first < 0) return;
  plan.arm = chosen;
  plan.arm_count = needed;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    plan.held[i] = std::find(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(needed), i) ==
                   chosen.begin() + static_cast<std::ptrdiff_t>(needed);
  }
}

}  // namespace abbe
