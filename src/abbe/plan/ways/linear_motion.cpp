#include "abbe/plan/ways/linear_motion.h"

#include <Eigen/LU>
#include <cmath>

#include "abbe/machine/coupling.h"

namespace abbe {

std::optional<std::vector<double>> moved_linearly(const Machine& machine, const std::vector<double>& pose,
                                                  const Eigen::Vector3d& displacement) {
  const std::vector<double> positions = positions_of_commands(machine, pose);
  // Motion of the tool over the workpiece per mm of each linear axis.
  std::vector<Eigen::Vector3d> motion(pose.size(), Eigen::Vector3d::Zero());
  // A direction that no axis has gets this instead of zero, so that the matrix can be inverted.
  constexpr double kNoAxis = 1e-12;
  Eigen::Matrix3d all = kNoAxis * Eigen::Matrix3d::Identity();
  const auto take = [&](std::size_t i, Eigen::Matrix3d& turned) {
    const Axis& axis = machine.axes[i];
    if (axis.kind == AxisKind::rotary) {
      turned = turned * nominal_motion(axis, positions[i]).rotation;
    } else if (!axis.setting) {
      motion[i] = (axis.side == ChainSide::tool ? 1 : -1) * axis.sense() * (turned * axis.direction);
      all += motion[i] * motion[i].transpose();
    }
  };
  const std::size_t workpiece_side = machine.workpiece_axis_count();
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  for (std::size_t i = workpiece_side; i-- > 0;) take(i, turned);
  turned = Eigen::Matrix3d::Identity();
  for (std::size_t i = workpiece_side; i < machine.axes.size(); ++i) take(i, turned);

  const Eigen::Vector3d share = all.inverse() * displacement;
  Eigen::Vector3d reached = Eigen::Vector3d::Zero();
  std::vector<double> moved = positions;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const double length = motion[i].dot(share);
    // What rounding leaves of an axis across the way is no motion.
    if (std::abs(length) < 1e-12 * displacement.norm()) continue;
    moved[i] += length;
    reached += length * motion[i];
  }
  if ((reached - displacement).norm() > 1e-6 * displacement.norm()) return std::nullopt;
  if (machine.couplings.empty()) return moved;
  std::vector<double> commands(pose.size());
  commands_of_positions(machine, moved.data(), commands.data());
  return commands;
}

}  // namespace abbe
