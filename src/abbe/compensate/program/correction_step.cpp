#include "abbe/compensate/program/correction_step.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/compensate/working_axes.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

constexpr double kStandingTurn = 1e-13;         // rad; a step below this is rounding
constexpr double kStandingLimitedTurn = 1e-10;  // rad; the same of an arm whose turn is bounded, which settles slowly
constexpr double kArmLever = 1e3;               // mm; a turn of 1 mrad counts as 1 mm of a linear axis of an arm
constexpr double kStandingPart = 0.1;           // of the tolerance: a step of the point below this gains nothing
constexpr double kSmallSine = 1e-3;             // below, the first two terms of its series give the angle to rounding
constexpr double kWellSpread = 1e-3;  // determinant against the squares above which an inverse keeps its digits

constexpr std::size_t kWidestVector = 8;  // numbers

}  // namespace

Eigen::Matrix3d matrix_at(const std::array<CorrectionBlock::Lanes, 9>& lanes, std::size_t k) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = lanes[static_cast<std::size_t>(i)][k];
  return m;
}

void fill_up(CorrectionBlock& block) {
  for (std::size_t k = block.count; k < std::min(kCorrectionBlock, block.count + kWidestVector); ++k) {
    for (CorrectionBlock::Lanes& lanes : block.position) lanes[k] = 0;
    for (auto* three : {&block.point, &block.goal_point, &block.direction, &block.goal_direction}) {
      for (CorrectionBlock::Lanes& lanes : *three) lanes[k] = 0;
    }
    block.position_residual[k] = block.orientation_residual[k] = 0;
  }
}

void check_goals(CorrectionBlock& block, TargetKind target) {
  // A difference of a number to itself is zero, of anything else it is no number.
  CorrectionBlock::Lanes none{};
  const auto note = [&](const CorrectionBlock::Lanes& lanes) {
    for (std::size_t k = 0; k < block.count; ++k) none[k] += lanes[k] - lanes[k];
  };
  for (const CorrectionBlock::Lanes& lanes : block.goal_point) note(lanes);
  if (target == TargetKind::full_pose) {
    for (const CorrectionBlock::Lanes& lanes : block.goal_rotation) note(lanes);
  } else {
    for (const CorrectionBlock::Lanes& lanes : block.goal_direction) note(lanes);
  }
  for (std::size_t k = 0; k < block.count; ++k) {
    if (none[k] != 0 || std::isnan(none[k])) CorrectionStep::finish(block, k, CorrectionStatus::not_finite);
  }
}

void CorrectionStep::find_across(CorrectionBlock& block) const {
  for (std::size_t k = 0; k < block.count; ++k) {
    Eigen::Vector3d direction = vector_at(block.goal_direction, k);
    if (options_.target == TargetKind::full_pose)
      direction = matrix_at(block.goal_rotation, k) * machine_.tool_direction;
    if (!direction.allFinite()) direction = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d first = direction.unitOrthogonal();
    const Eigen::Vector3d second = direction.cross(first);
    for (std::size_t i = 0; i < 3; ++i) {
      block.across[0][i][k] = first[entry(i)];
      block.across[1][i][k] = second[entry(i)];
    }
  }
}

CorrectionStep::CorrectionStep(const Machine& machine, const CorrectionOptions& options,
                               const std::vector<HeldAxis>& kept)
    : machine_(machine), options_(options) {
  choose_axes(kept);
}

void CorrectionStep::choose_axes(const std::vector<HeldAxis>& kept) {
  WorkingAxes working = working_axes(machine_, options_.target, kept);
  turning_ = std::move(working.turning);
  reaching_ = std::move(working.reaching);
  arm_ = std::move(working.arm);
  is_inverted_ = working.is_inverted;
  orientation_rows_ = working.orientation_rows;
  usual_ = orientation_rows_ == 2 && turning_.size() == 2 && reaching_.size() == 3;
  straight_ = usual_ || (orientation_rows_ == 0 && turning_.empty() && reaching_.size() == 3 && arm_.empty() &&
                         options_.target != TargetKind::full_pose);
  for (const std::size_t axis : reaching_) {
    const bool linear = machine_.axes[axis].kind == AxisKind::linear;
    usual_ = usual_ && linear;
    straight_ = straight_ && linear;
  }
  straight_ = straight_ && machine_.couplings.empty();
}

/// Rotation vector that turns the tool to where it is wanted: about its length the shortest, for a direction.
Eigen::Vector3d CorrectionStep::orientation_error(const CorrectionBlock& block, std::size_t k) const {
  if (options_.target == TargetKind::full_pose) {
    return rotation_vector(matrix_at(block.goal_rotation, k) * matrix_at(block.rotation, k).transpose());
  }
  const Eigen::Vector3d direction = vector_at(block.direction, k);
  const Eigen::Vector3d goal = vector_at(block.goal_direction, k);
  const Eigen::Vector3d axis = direction.cross(goal);
  const double square = axis.squaredNorm(), cosine = direction.dot(goal);
  if (cosine > 0 && square < kSmallSine * kSmallSine) return axis * (1 + square / 6);
  const double sine = std::sqrt(square), angle = std::atan2(sine, cosine);
  return sine > 0 ? Eigen::Vector3d(axis * (angle / sine)) : Eigen::Vector3d(angle * vector_at(block.across[0], k));
}

void CorrectionStep::take_derivative(CorrectionBlock& block) const {
  if (!usual_) return;
  for (std::size_t k = 0; k < block.count; ++k) {
    const auto turn = [&](std::size_t row, std::size_t c) { return derivative(block, turning_[c], 3 + row, k); };
    const double turns = turn(0, 0) * turn(1, 1) - turn(0, 1) * turn(1, 0);
    double square = 0;
    for (std::size_t r = 0; r < 2; ++r) square += turn(r, 0) * turn(r, 0) + turn(r, 1) * turn(r, 1);
    block.turn_spread[k] = std::abs(turns) > kWellSpread * square ? std::abs(turns) / std::sqrt(square) : 0;
    block.turn_inverse[0][k] = turn(1, 1) / turns;
    block.turn_inverse[1][k] = -turn(0, 1) / turns;
    block.turn_inverse[2][k] = -turn(1, 0) / turns;
    block.turn_inverse[3][k] = turn(0, 0) / turns;
    double a[3][3];
    square = 0;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        a[r][c] = derivative(block, reaching_[c], r, k);
        square += 0.5 * a[r][c] * a[r][c];
      }
    }
    double cofactor[3][3];
    for (std::size_t r = 0; r < 3; ++r) {
      const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3;
      for (std::size_t c = 0; c < 3; ++c)
        cofactor[r][c] = a[r1][(c + 1) % 3] * a[r2][(c + 2) % 3] - a[r1][(c + 2) % 3] * a[r2][(c + 1) % 3];
    }
    const double determinant = a[0][0] * cofactor[0][0] + a[0][1] * cofactor[0][1] + a[0][2] * cofactor[0][2];
    block.reach_spread[k] =
        std::abs(determinant) > kWellSpread * square * std::sqrt(square) ? std::abs(determinant) / square : 0;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) block.reach_inverse[3 * r + c][k] = cofactor[c][r] / determinant;
    }
  }
}

void CorrectionStep::finish(CorrectionBlock& block, std::size_t k, CorrectionStatus status) {
  block.status[k] = status;
  block.active[k] = 0;
}

void CorrectionStep::state_residuals(CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing,
                                     const Eigen::Vector3d& turn) const {
  block.position_residual[k] = missing.norm();
  block.orientation_residual[k] = options_.target == TargetKind::point ? 0 : turn.norm();
}

void CorrectionStep::state_residuals(CorrectionBlock& block, std::size_t k) const {
  state_residuals(block, k, vector_at(block.goal_point, k) - vector_at(block.point, k), orientation_error(block, k));
}

/// Orientation by the turning axes, what is missing of it, and how far they have turned.
void CorrectionStep::load_turns(const CorrectionBlock& block, std::size_t k, SmallMatrix& a, SmallVector& b,
                                SmallVector& turned) const {
  const Eigen::Vector3d turn = orientation_error(block, k);
  a.resize(entry(orientation_rows_), entry(turning_.size()));
  b.resize(entry(orientation_rows_));
  turned.resize(entry(turning_.size()));
  for (std::size_t r = 0; r < orientation_rows_; ++r) {
    b[entry(r)] = orientation_rows_ == 2 ? turn.dot(vector_at(block.across[r], k)) : turn[entry(r)];
    for (std::size_t c = 0; c < turning_.size(); ++c) a(entry(r), entry(c)) = derivative(block, turning_[c], 3 + r, k);
  }
  for (std::size_t c = 0; c < turning_.size(); ++c)
    turned[entry(c)] =
        at_end(block, turning_[c], k) ? 0 : block.position[turning_[c]][k] - block.command[turning_[c]][k];
}

/// Point by the reaching axes, and how far they have gone. The rotary axis of a polar machine counts in units that
/// make its bound that of turns.
void CorrectionStep::load_shifts(const CorrectionBlock& block, std::size_t k, SmallMatrix& a, SmallVector& shifted,
                                 SmallVector& scale) const {
  a.resize(3, entry(reaching_.size()));
  shifted.resize(entry(reaching_.size()));
  scale.resize(entry(reaching_.size()));
  for (std::size_t c = 0; c < reaching_.size(); ++c) {
    const std::size_t axis = reaching_[c];
    const double unit =
        machine_.axes[axis].kind == AxisKind::rotary ? options_.largest_turn / options_.largest_shift : 1;
    scale[entry(c)] = unit;
    shifted[entry(c)] = at_end(block, axis, k) ? 0 : (block.position[axis][k] - block.command[axis][k]) / unit;
    for (std::size_t r = 0; r < 3; ++r) a(entry(r), entry(c)) = unit * derivative(block, axis, r, k);
  }
}

/// What is missing of the point once the turning axes have gone on.
SmallVector CorrectionStep::missing_after(const CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing,
                                          const SmallVector& by_turn) const {
  SmallVector rest = missing;
  for (std::size_t c = 0; c < turning_.size(); ++c) {
    for (std::size_t r = 0; r < 3; ++r) rest[entry(r)] -= derivative(block, turning_[c], r, k) * by_turn[entry(c)];
  }
  return rest;
}

/// 1, and less where linear axes are so nearly dependent that they could not follow a turn with the point: the point
/// comes first.
double CorrectionStep::part_that_can_be_followed(const CorrectionBlock& block, std::size_t k, const SmallMatrix& a,
                                                 const SmallVector& rest) const {
  if (a.cols() < 3) return 1;
  for (const std::size_t axis : reaching_) {
    if (at_end(block, axis, k)) return 1;  // the point is missed all the same
  }
  const double square = a.squaredNorm() / 2;  // above the product of the two larger singular values
  const double smallest = std::abs(Eigen::Matrix3d(a).determinant()) / square;
  const double needed = rest.norm() / options_.largest_shift;
  return needed > 0 ? std::clamp(smallest / needed - 1, 0.0, 1.0) : 1.0;
}

/// The step where the derivative is far from singular; false if it is not.
bool CorrectionStep::usual_step(CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing,
                                const Eigen::Vector3d& turn) const {
  const double b0 = turn.dot(vector_at(block.across[0], k)), b1 = turn.dot(vector_at(block.across[1], k));
  const double step[2] = {block.turn_inverse[0][k] * b0 + block.turn_inverse[1][k] * b1,
                          block.turn_inverse[2][k] * b0 + block.turn_inverse[3][k] * b1};
  double whole[2] = {b0, b1};
  Eigen::Vector3d rest = missing, shift = Eigen::Vector3d::Zero();
  for (std::size_t c = 0; c < 2; ++c) {
    const double turned = block.position[turning_[c]][k] - block.command[turning_[c]][k];
    for (std::size_t r = 0; r < 2; ++r) whole[r] += derivative(block, turning_[c], 3 + r, k) * turned;
    for (std::size_t r = 0; r < 3; ++r) rest[entry(r)] -= derivative(block, turning_[c], r, k) * step[c];
  }
  if (!(block.turn_spread[k] * options_.largest_turn > std::hypot(whole[0], whole[1]))) return false;
  Eigen::Vector3d all = rest;
  for (std::size_t c = 0; c < 3; ++c) {
    const double shifted = block.position[reaching_[c]][k] - block.command[reaching_[c]][k];
    for (std::size_t r = 0; r < 3; ++r) {
      all[entry(r)] += derivative(block, reaching_[c], r, k) * shifted;
      shift[entry(c)] += block.reach_inverse[3 * c + r][k] * rest[entry(r)];
    }
  }
  if (!(block.reach_spread[k] * options_.largest_shift > 2 * all.norm())) return false;
  if (std::hypot(step[0], step[1]) <= kStandingTurn && rest.norm() <= kStandingPart * options_.position_tolerance) {
    const bool at_point = missing.norm() <= options_.position_tolerance;
    finish(block, k, at_point ? CorrectionStatus::orientation_left : CorrectionStatus::position_left);
    return true;
  }
  for (std::size_t c = 0; c < 2; ++c) block.position[turning_[c]][k] += step[c];
  for (std::size_t c = 0; c < 3; ++c) block.position[reaching_[c]][k] += shift[entry(c)];
  return true;
}

void CorrectionStep::general_step(CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing) const {
  const bool at_point = missing.norm() <= options_.position_tolerance;
  bool turn_bounded = false, shift_bounded = false;
  SmallMatrix a;
  SmallVector b, turned, shifted;
  load_turns(block, k, a, b, turned);
  b += a * turned;
  SmallVector by_turn = bounded_least_squares(a, b, options_.largest_turn, turn_bounded);
  SmallVector scale;
  load_shifts(block, k, a, shifted, scale);
  const double part =
      part_that_can_be_followed(block, k, a, missing_after(block, k, missing, by_turn - turned) + a * shifted);
  turn_bounded = turn_bounded || part < 1;
  by_turn = part * by_turn - turned;
  const SmallVector rest = missing_after(block, k, missing, by_turn) + a * shifted;
  const SmallVector by_reach = bounded_least_squares(a, rest, options_.largest_shift, shift_bounded) - shifted;
  // How far the step moves the point, mm: below the tolerance nothing more is to be gained.
  const double moves = (a * by_reach).norm();
  if (by_turn.norm() <= kStandingTurn && moves <= kStandingPart * options_.position_tolerance) {
    if (!at_point) {
      finish(block, k, CorrectionStatus::position_left);
    } else {
      finish(block, k, turn_bounded ? CorrectionStatus::turn_limited : CorrectionStatus::orientation_left);
    }
    return;
  }
  for (std::size_t c = 0; c < turning_.size(); ++c) block.position[turning_[c]][k] += by_turn[entry(c)];
  for (std::size_t c = 0; c < reaching_.size(); ++c)
    block.position[reaching_[c]][k] += scale[entry(c)] * by_reach[entry(c)];
}

/// Step of an arm, whose axes take point and orientation together; where they cannot, the point comes first.
void CorrectionStep::arm_step(CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing,
                              const Eigen::Vector3d& turn) const {
  const std::size_t turns = block.point_only ? 0 : orientation_rows_;
  ArmMatrix a(entry(3 + turns), entry(arm_.size()));
  ArmVector b(entry(3 + turns)), turned(entry(arm_.size()));
  b.head<3>() = missing;
  for (std::size_t r = 0; r < turns; ++r)
    b[entry(3 + r)] = turns == 2 ? turn.dot(vector_at(block.across[r], k)) : turn[entry(r)];
  const auto unit = [&](std::size_t axis) { return machine_.axes[axis].kind == AxisKind::linear ? kArmLever : 1; };
  for (std::size_t c = 0; c < arm_.size(); ++c) {
    const std::size_t axis = arm_[c];
    for (std::size_t r = 0; r < 3 + turns; ++r) a(entry(r), entry(c)) = unit(axis) * derivative(block, axis, r, k);
    turned[entry(c)] = at_end(block, axis, k) ? 0 : (block.position[axis][k] - block.command[axis][k]) / unit(axis);
  }
  bool shift_bounded = false, turn_bounded = false;
  const ArmVector step =
      bounded_in_order(a, b + a * turned, options_.largest_turn, shift_bounded, turn_bounded) - turned;
  const double moves = (a.topRows(3) * step).norm();
  if (step.norm() <= kStandingTurn ||
      (turn_bounded && step.norm() <= kStandingLimitedTurn && moves <= kStandingPart * options_.position_tolerance)) {
    const bool at_point = missing.norm() <= options_.position_tolerance;
    if (!at_point) {
      finish(block, k, CorrectionStatus::position_left);
    } else {
      finish(block, k, turn_bounded ? CorrectionStatus::turn_limited : CorrectionStatus::orientation_left);
    }
    return;
  }
  for (std::size_t c = 0; c < arm_.size(); ++c) {
    if (!at_end(block, arm_[c], k)) block.position[arm_[c]][k] += unit(arm_[c]) * step[entry(c)];
  }
}

/// One step of one pose, or its end.
void CorrectionStep::step(CorrectionBlock& block, std::size_t k) const {
  const Eigen::Vector3d missing = vector_at(block.goal_point, k) - vector_at(block.point, k);
  const Eigen::Vector3d turn = orientation_error(block, k);
  state_residuals(block, k, missing, turn);
  const bool at_point = block.position_residual[k] <= options_.position_tolerance;
  if (at_point && (orientation_rows_ == 0 || block.orientation_residual[k] <= options_.orientation_tolerance)) {
    finish(block, k, CorrectionStatus::reached);
    return;
  }
  if (at_point && block.point_only) {
    finish(block, k, CorrectionStatus::turn_limited);
    return;
  }
  if (!arm_.empty()) {
    arm_step(block, k, missing, turn);
    return;
  }
  if (usual_ && usual_step(block, k, missing, turn)) return;
  general_step(block, k, missing);
}

}  // namespace abbe
