#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "abbe/compensate/program/command_correction.h"

namespace abbe {

/// A control that adds corrections in whole units only, rounded to the nearest one.
class WholeUnitCorrection final : public CommandCorrection {
 public:
  /// @param unit  mm or rad, of all axes that are corrected
  WholeUnitCorrection(std::unique_ptr<CommandCorrection> wanted, double unit)
      : wanted_(std::move(wanted)), unit_(unit) {}
  void evaluate(const PoseList& commands, PoseList& correction) const override {
    wanted_->evaluate(commands, correction);
    for (std::vector<double>& values : correction.axis) {
      for (double& value : values) value = unit_ * std::round(value / unit_);
    }
  }
  bool knows_directions() const override { return wanted_->knows_directions(); }

 private:
  std::unique_ptr<CommandCorrection> wanted_;
  double unit_;
};

}  // namespace abbe
