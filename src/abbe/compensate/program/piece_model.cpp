// What bounds of pieces need to know of a machine and its errors.
#include <algorithm>
#include <cmath>

#include "abbe/compensate/program/piece_bound.h"
#include "abbe/machine/inverse_plan.h"

namespace abbe {

PieceBounder::LineError PieceBounder::line_error(const Machine& machine, const ErrorSet& errors, std::size_t axis,
                                                 std::size_t state) {
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero(), shift = Eigen::Vector3d::Zero();
  double zero_position = 0;
  for (const LocationError& location : errors.locations) {
    if (location.axis != axis || location.state != state) continue;
    const LocationEffect effect = location_effect(machine.axes[axis], location.component);
    zero_position += location.value * effect.zero_position;
    tilt += location.value * effect.tilt;
    shift += location.value * effect.shift;
  }
  return {tilt.lpNorm<1>(), shift.norm(), std::abs(zero_position)};
}

void PieceBounder::add_states(const Machine& machine, const ErrorSet& errors) {
  const auto note = [&](std::size_t axis, std::size_t state) {
    std::vector<StateErrors>& known = axes_[axis].with_state;
    const bool is_known =
        std::any_of(known.begin(), known.end(), [&](const StateErrors& one) { return one.state == state; });
    if (state == kNoState || is_known) return;
    known.push_back({state, AxisErrorCells(machine, errors, axis, state), line_error(machine, errors, axis, state)});
  };
  for (const ErrorMotion& motion : errors.motions) note(motion.axis, motion.state);
  for (const LocationError& location : errors.locations) note(location.axis, location.state);
}

PieceBounder::PieceBounder(const Machine& machine, const ErrorSet& errors, const std::array<std::size_t, 3>& point_axes)
    : machine_(machine),
      factors_(machine, errors),
      tool_error_(errors.tool_offset_error.norm()),
      point_axes_(point_axes) {
  std::sort(point_axes_.begin(), point_axes_.end());
  const std::size_t n = machine.axes.size();
  for (std::size_t i = 0; i < n; ++i) {
    axes_.emplace_back(machine, errors, i);
    axes_.back().line = line_error(machine, errors, i, kNoState);
  }
  add_states(machine, errors);
  for (std::size_t i = n; i-- > 0;) {
    if (axes_[i].rotary || (i + 1 < n && !axes_[i + 1].rotary)) continue;
    axes_[i].run_begins = true;
    Eigen::MatrixXd directions(3, 0);
    for (std::size_t k = i + 1; k-- > 0 && !axes_[k].rotary;) {
      axes_[i].run.push_back(k);
      directions.conservativeResize(3, directions.cols() + 1);
      directions.rightCols(1) = machine.axes[k].direction;
      axes_[i].bends = axes_[i].bends || is_point_axis(k);
    }
    // Gershgorin's bound of the largest singular value.
    axes_[i].run_stretch = std::sqrt((directions.transpose() * directions).rowwise().lpNorm<1>().maxCoeff());
  }
  set_point_axes();
}

void PieceBounder::set_point_axes() {
  Eigen::Matrix3d directions;
  for (std::size_t i = 0; i < 3; ++i) {
    if (point_axes_[i] >= axes_.size() || axes_[point_axes_[i]].rotary) return;
    directions.col(static_cast<Eigen::Index>(i)) = machine_.axes[point_axes_[i]].direction;
  }
  for (std::size_t i = point_axes_[0]; i < point_axes_[2]; ++i) {
    if (axes_[i].rotary) return;
  }
  if (std::abs(directions.determinant()) < 1e-6) return;
  const Eigen::Matrix3d normal = directions.transpose() * directions;
  // Gershgorin's bound of 1 / (smallest singular value).
  point_condition_ = std::sqrt(normal.inverse().rowwise().lpNorm<1>().maxCoeff());
  has_point_axes_ = true;
}

}  // namespace abbe
