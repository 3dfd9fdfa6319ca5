#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "abbe/compensate/program/program_move.h"
#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/compensate/program/word_axes.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/machine/machine.h"

namespace abbe::test {

/// A machine with errors whose axes are carried by a driver with a gap: an axis stays until its side of the gap comes.
class MachineWithPlay {
 public:
  MachineWithPlay(const Machine& machine, const ErrorSet& errors, const WordAxes& words)
      : machine_(machine), errors_(errors), words_(words), gap_(machine.axes.size(), 0.0) {
    // Lost motion is a negative reversal value (ISO 230-2).
    for (const Reversal& reversal : errors.reversals) gap_[reversal.axis] = -reversal.value;
    errors_.reversals.clear();
  }

  /// Axis commands of the control's own kinematics.
  std::vector<double> commands(const ProgramMove& move, const WordValues& words) const {
    Machine machine = machine_;
    machine.tool_offset -= Eigen::Vector3d(move.tool_length[0], move.tool_length[1], move.tool_length[2]);
    return commanded_axes(machine, words_, move.coordinates, words);
  }

  /// The drives go there; axes follow as far as they are carried.
  void drive(const std::vector<double>& commands) {
    if (actual_.empty()) actual_ = commands;
    for (std::size_t i = 0; i < commands.size(); ++i) {
      actual_[i] = std::clamp(actual_[i], commands[i] - 0.5 * gap_[i], commands[i] + 0.5 * gap_[i]);
    }
  }

  RigidTransform nominal(const ProgramMove& move, const WordValues& words) const {
    return pose(move, commands(move, words), ErrorSet{});
  }
  RigidTransform actual(const ProgramMove& move) const { return pose(move, actual_, errors_); }
  const std::vector<double>& axes() const { return actual_; }
  const Eigen::Vector3d& tool_direction() const { return machine_.tool_direction; }

 private:
  RigidTransform pose(const ProgramMove& move, const std::vector<double>& axes, const ErrorSet& errors) const {
    Machine machine = machine_;
    machine.tool_offset -= Eigen::Vector3d(move.tool_length[0], move.tool_length[1], move.tool_length[2]);
    return actual_workpiece_from_tool(machine, errors, axes);
  }

  Machine machine_;
  ErrorSet errors_;
  WordAxes words_;
  std::vector<double> gap_, actual_;
};

}  // namespace abbe::test
