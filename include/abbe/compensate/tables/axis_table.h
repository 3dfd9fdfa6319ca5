#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "abbe/compensate/program/command_correction.h"

namespace abbe {

/// Correction of the command of one axis as a function of the command of one axis: a straight line between nodes.
struct AxisTable {
  std::size_t input = 0;          ///< axis whose command is looked up
  std::size_t output = 0;         ///< axis whose command is corrected
  std::vector<double> positions;  ///< [n] increasing commands of `input`, mm or rad, n >= 1
  std::vector<double> forward;    ///< [n] added to the command of `output` where `input` moves upwards, mm or rad
  std::vector<double> reverse;    ///< [n] the same where it moves downwards
  /// The table repeats itself after positions.back() - positions.front(); else the end values hold outside.
  bool modulo = false;
  bool operator==(const AxisTable&) const = default;

  /// Correction at a command of `input`.
  /// @param approach  +1 or -1, the sign of its last motion; 0: not known, the mean of both directions
  double at(double position, int approach = 0) const;
};

/// Tables of a control that adds up what they say; every one is looked up at the command, before any correction.
class AxisTableCorrection final : public CommandCorrection {
 public:
  explicit AxisTableCorrection(std::vector<AxisTable> tables) : tables_(std::move(tables)) {}
  void evaluate(const PoseList& commands, PoseList& correction) const override;
  bool knows_directions() const override;

 private:
  std::vector<AxisTable> tables_;
};

/// Largest magnitude in a table, both directions; mm or rad.
double largest_correction(const AxisTable& table);

}  // namespace abbe
