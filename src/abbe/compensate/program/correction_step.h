#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "abbe/compensate/bounded_least_squares.h"
#include "abbe/compensate/compensated_inverse.h"

namespace abbe {

inline constexpr std::size_t kCorrectionBlock = ChainPlan::kBlockSize;
inline constexpr std::size_t kMostCorrectionRows = 6;  ///< of the point and of the orientation

/// Poses of one block while they are worked on: positions in mm and rad, points in mm, in the workpiece frame.
struct CorrectionBlock {
  using Lanes = std::array<double, kCorrectionBlock>;

  std::size_t count = 0;
  alignas(128) std::array<Lanes, kMaxAxes> command;  // as they came
  std::array<Lanes, kMaxAxes> position;              // as they are by now
  std::array<Lanes, 3> point, goal_point;            // mm
  std::array<Lanes, 9> rotation, goal_rotation;      // row-major, of a full pose only
  std::array<Lanes, 3> direction, goal_direction;    // unit, of the tool; else
  std::array<Lanes, 3> across[2];                    // unit vectors at right angles to the goal's direction
  std::array<double, kMaxAxes * kMostCorrectionRows * kCorrectionBlock> by_command;
  // Where two axes turn and three reach, which is the rule: inverses of the derivative, row-major, and values that the
  // smallest singular values are surely not below (0: take the general way).
  std::array<Lanes, 4> turn_inverse;
  std::array<Lanes, 9> reach_inverse;
  Lanes turn_spread, reach_spread;
  std::array<std::uint8_t, kCorrectionBlock> covered, active;
  /// Axes that were kept at an end of their travel and work no more: their derivative is zero. Set only if any is.
  std::array<std::array<std::uint8_t, kCorrectionBlock>, kMaxAxes> at_end;
  bool any_at_end = false;
  bool point_only = false;  ///< arms: the orientation is left as it comes
  /// As PositionArrays::state, from the first pose of the block on.
  std::array<const double*, kMaxStates> state;
  std::size_t states = 0;
  std::span<const double* const> given_states() const { return {state.data(), states}; }
  std::array<CorrectionStatus, kCorrectionBlock> status;
  Lanes position_residual, orientation_residual;
};

inline Eigen::Index entry(std::size_t i) { return static_cast<Eigen::Index>(i); }

template <std::size_t N>
Eigen::Vector3d vector_at(const std::array<CorrectionBlock::Lanes, N>& lanes, std::size_t k) {
  return {lanes[0][k], lanes[1][k], lanes[2][k]};
}

/// Matrix of row-major elements.
Eigen::Matrix3d matrix_at(const std::array<CorrectionBlock::Lanes, 9>& lanes, std::size_t k);

/// Ends poses whose goals are no numbers.
void check_goals(CorrectionBlock& block, TargetKind target);
/// Vectors are read as a whole: numbers where there is no pose.
void fill_up(CorrectionBlock& block);

/// Newton steps of single poses of a block from what is missing and the derivative by the commands.
class CorrectionStep {
 public:
  /// @param kept  axes that keep their command
  CorrectionStep(const Machine& machine, const CorrectionOptions& options, const std::vector<HeldAxis>& kept);

  /// Rows of the derivative beyond the three of the point: 0, 2 (across the wanted direction) or 3.
  std::size_t orientation_rows() const { return orientation_rows_; }
  bool is_arm() const { return !arm_.empty(); }
  /// Two axes turn and three reach, or three reach a point alone: ChordSteps serve.
  bool is_straight() const { return straight_; }
  const std::vector<std::size_t>& turning() const { return turning_; }
  const std::vector<std::size_t>& reaching() const { return reaching_; }
  bool is_inverted() const { return is_inverted_; }  ///< as WorkingAxes

  /// Two directions at right angles to the wanted one, which all steps need.
  void find_across(CorrectionBlock& block) const;
  /// Prepares steps with the derivative CorrectionBlock::by_command[(axis * rows + row) * count + k].
  void take_derivative(CorrectionBlock& block) const;
  /// One step of one pose, or its end.
  void step(CorrectionBlock& block, std::size_t k) const;
  void state_residuals(CorrectionBlock& block, std::size_t k) const;
  static void finish(CorrectionBlock& block, std::size_t k, CorrectionStatus status);

 private:
  void state_residuals(CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing,
                       const Eigen::Vector3d& turn) const;
  void choose_axes(const std::vector<HeldAxis>& kept);
  Eigen::Vector3d orientation_error(const CorrectionBlock& block, std::size_t k) const;
  double derivative(const CorrectionBlock& block, std::size_t axis, std::size_t row, std::size_t k) const {
    return block.by_command[(axis * (3 + orientation_rows_) + row) * block.count + k];
  }
  static bool at_end(const CorrectionBlock& block, std::size_t axis, std::size_t k) {
    return block.any_at_end && block.at_end[axis][k] != 0;
  }
  void load_turns(const CorrectionBlock& block, std::size_t k, SmallMatrix& a, SmallVector& b,
                  SmallVector& turned) const;
  void load_shifts(const CorrectionBlock& block, std::size_t k, SmallMatrix& a, SmallVector& shifted,
                   SmallVector& scale) const;
  SmallVector missing_after(const CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing,
                            const SmallVector& by_turn) const;
  double part_that_can_be_followed(const CorrectionBlock& block, std::size_t k, const SmallMatrix& a,
                                   const SmallVector& rest) const;
  bool usual_step(CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing,
                  const Eigen::Vector3d& turn) const;
  void general_step(CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing) const;
  void arm_step(CorrectionBlock& block, std::size_t k, const Eigen::Vector3d& missing,
                const Eigen::Vector3d& turn) const;

  Machine machine_;
  CorrectionOptions options_;
  std::vector<std::size_t> turning_, reaching_;
  std::vector<std::size_t> arm_;  // of an arm, instead of both
  bool is_inverted_ = false;
  std::size_t orientation_rows_ = 0;
  bool usual_ = false;     // two turning and three linear axes, tool direction wanted
  bool straight_ = false;  // the same, or three linear axes alone
};

}  // namespace abbe
