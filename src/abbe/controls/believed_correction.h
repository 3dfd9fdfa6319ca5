#pragma once

#include "abbe/compensate/program/command_correction.h"
#include "abbe/controls/kinematic_format.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What a control with a transformation of five axes adds to commands of the nominal machine: its linear axes bring the
/// functional point of the machine that it believes in to where the program has it, which is where the nominal machine
/// has it at these commands; its rotary axes stand where they are commanded, less their zero positions.
///
/// The point of the workpiece is an affine function of the commands of the linear axes, so that one step is exact.
/// Fewer than three linear axes take what they can (least squares), more than three the shortest way. Travel limits do
/// not count.
class BelievedCorrection final : public CommandCorrection {
 public:
  BelievedCorrection(Machine nominal, BelievedMachine believed);
  void evaluate(const PoseList& commands, PoseList& correction) const override;

 private:
  Machine nominal_;
  BelievedMachine believed_;
};

}  // namespace abbe
