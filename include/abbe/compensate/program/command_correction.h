#pragma once

#include <cstddef>
#include <vector>

#include "abbe/errors/poses.h"

namespace abbe {

/// What a control adds to the commands of its axes, as a function of the commands and of the direction in
/// which they are reached.
class CommandCorrection {
 public:
  virtual ~CommandCorrection() = default;

  /// @param commands    [axes][count], chain order, mm or rad
  /// @param correction  [axes][count], written: added to the command, mm or rad
  virtual void evaluate(const PoseList& commands, PoseList& correction) const = 0;

  /// True if the correction is another one after another approach (PoseList::approach).
  virtual bool knows_directions() const { return false; }
};

/// Nothing is added: the control before its tables are loaded.
class NoCorrection final : public CommandCorrection {
 public:
  void evaluate(const PoseList& commands, PoseList& correction) const override {
    correction.axis.assign(commands.axis.size(), std::vector<double>(commands.count(), 0.0));
  }
};

}  // namespace abbe
