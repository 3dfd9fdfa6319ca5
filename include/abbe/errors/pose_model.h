#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Poses of the functional point in the workpiece frame, with errors and without, of any number of commands.
///
/// The batch form of actual_pose.h, with the same results to rounding. Building a model allocates; poses() does not.
/// One model may be used by several threads at a time. Reversal values are not applied: no approach is known here.
/// Where the errors have an input state that the positions do not give, results are NaN and not covered.
class PoseModel {
 public:
  /// @throws std::invalid_argument for errors of first order (Composition::first_order), which have no such pose
  PoseModel(const Machine& machine, const ErrorSet& errors);

  const Machine& machine() const { return machine_; }
  const ErrorSet& errors() const { return errors_; }

  /// workpiece_from_tool with errors.
  /// @param positions  chain order, mm or rad
  /// @param point      out, [count] functional point, mm
  /// @param rotation   out, [count] or null: columns are the axes of the tool frame in the workpiece frame
  /// @param covered    out, [count] or null: 0 where a command lies outside the range of an error motion, or an
  ///                   input state of the errors is not given
  void poses(PositionArrays positions, PointArrays point, RotationArrays rotation = {},
             std::uint8_t* covered = nullptr) const;

  /// The same for the machine without errors.
  void nominal_poses(PositionArrays positions, PointArrays point, RotationArrays rotation = {}) const;

  /// Deviation of the pose, actual minus nominal, as tool_deviation().
  /// @param deviation  out, [6] pointers to [count] each: displacement x, y, z (mm), rotation vector x, y, z (rad)
  void deviations(PositionArrays positions, double* const* deviation, std::uint8_t* covered = nullptr) const;

  /// Derivative of the deviation by ErrorSet::parameters(), as tool_deviation().
  /// @param jacobian  out, [count][6][parameters], per mm or rad
  void jacobian(PositionArrays positions, double* jacobian) const;

  /// Derivative of the actual pose by the commands: twist, as tool_deviation().
  /// @param by_position  out, [count][6][axes], per mm or rad
  void jacobian_by_positions(PositionArrays positions, double* by_position) const;

 private:
  void differentiate(PositionArrays positions, double* by_parameter, double* by_position) const;

  Machine machine_;
  ErrorSet errors_;
  ChainPlan actual_, nominal_;
  Eigen::Vector3d actual_tip_, nominal_tip_;
};

}  // namespace abbe
