#include "abbe/controls/described_errors.h"

#include <cmath>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

/// Each takes three to four digits off: an error changes by parts in a thousand of the correction.
constexpr int kOwnSteps = 5;

/// Angles of Rx(a) Ry(b) Rz(c).
Eigen::Vector3d turns_of_rows(const Eigen::Matrix3d& r) {
  return {std::atan2(-r(1, 2), r(2, 2)), std::asin(r(0, 2)), std::atan2(-r(0, 1), r(0, 0))};
}

}  // namespace

DescribedErrors::DescribedErrors(const Machine& machine, const ErrorSet& errors, const DescribedAxis& axis)
    : machine_(machine), errors_(errors), axis_(axis), along_(axis.tilted() * axis.letter_direction) {}

DescribedErrors::Values DescribedErrors::at(double command) const {
  const Axis& axis = machine_.axes[axis_.axis];
  const RigidTransform to_origin = RigidTransform::translate(-axis_.origin);
  const RigidTransform from_origin = RigidTransform::translate(axis_.origin);
  const bool linear = axis.kind == AxisKind::linear;
  // N(q)^-1: a movement by +q along or about the tilted letter.
  const RigidTransform back =
      linear ? RigidTransform::translate(command * along_) : RigidTransform::rotate(rotation_about(along_, command));
  RigidTransform rows;
  double own = 0;
  for (int step = 0; step <= kOwnSteps; ++step) {
    RigidTransform moved = actual_motion(machine_, errors_, axis_.axis, command + own);
    if (axis.side == ChainSide::tool) moved = moved.inverse();
    rows = to_origin * moved * from_origin * back;
    if (step == kOwnSteps) break;
    own += (linear ? rows.translation : rotation_vector(rows.rotation)).dot(along_);
  }
  const Eigen::Vector3d turns = turns_of_rows(rows.rotation);
  return {own, rows.translation.x(), rows.translation.y(), rows.translation.z(), turns.x(), turns.y(), turns.z()};
}

std::vector<std::vector<double>> DescribedErrors::at(std::span<const double> positions) const {
  std::vector<std::vector<double>> values(kCount, std::vector<double>(positions.size()));
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const Values here = at(positions[k]);
    for (std::size_t c = 0; c < kCount; ++c) values[c][k] = here.at(c);
  }
  return values;
}

}  // namespace abbe
