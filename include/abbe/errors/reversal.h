#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"

namespace abbe {

/// Index of the first reversal value among ErrorSet::parameters(); of none, where it would stand.
std::size_t first_reversal(const ErrorSet& errors);

/// Reversal value of an axis, mm or rad; 0 where the errors have none.
double reversal_of(const ErrorSet& errors, std::size_t axis);

/// Reversal at the poses of a list: a change of the commands before the chain is evaluated (see Reversal).
///
/// The derivative of anything by the reversal value of an axis is therefore half the approach times the derivative by
/// that axis's command.
class ReversalShift {
 public:
  static constexpr std::size_t npos = static_cast<std::size_t>(-1);

  ReversalShift() = default;
  /// Present values are those of the errors.
  explicit ReversalShift(const ErrorSet& errors);

  /// @param values  in the order of ErrorSet::parameters()
  void set_parameters(std::span<const double> values);

  /// False where no command changes whatever the values are: no reversal in the errors, or no approach known.
  bool acts_on(const PoseList& poses) const { return !axis_.empty() && !poses.approach.empty(); }

  /// What is added to the command of an axis, mm or rad.
  double shift(const PoseList& poses, std::size_t axis, std::size_t pose) const {
    return axis < half_value_.size() && !poses.approach.empty() ? half_value_[axis] * poses.approach[axis][pose] : 0;
  }

  /// Axis whose reversal value a parameter is; npos for all other parameters.
  std::size_t axis_of(std::size_t parameter) const {
    return parameter >= first_ && parameter - first_ < axis_.size() ? axis_[parameter - first_] : npos;
  }

 private:
  std::size_t first_ = 0;           ///< index of the first reversal among the parameters
  std::vector<std::size_t> axis_;   ///< [reversals]
  std::vector<double> half_value_;  ///< [axes up to the last one with a reversal] B / 2, mm or rad
};

}  // namespace abbe
