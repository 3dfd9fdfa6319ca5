#include "abbe/errors/reversal.h"

#include <algorithm>

namespace abbe {

std::size_t first_reversal(const ErrorSet& errors) {
  return errors.parameter_count() - 3 - errors.reversals.size();  // 3: of the tool offset, the last ones
}

double reversal_of(const ErrorSet& errors, std::size_t axis) {
  for (const Reversal& reversal : errors.reversals) {
    if (reversal.axis == axis) return reversal.value;
  }
  return 0;
}

ReversalShift::ReversalShift(const ErrorSet& errors) : first_(first_reversal(errors)) {
  for (const Reversal& reversal : errors.reversals) {
    axis_.push_back(reversal.axis);
    half_value_.resize(std::max(half_value_.size(), reversal.axis + 1), 0.0);
    half_value_[reversal.axis] = reversal.value / 2;
  }
}

void ReversalShift::set_parameters(std::span<const double> values) {
  for (std::size_t i = 0; i < axis_.size(); ++i) half_value_[axis_[i]] = values[first_ + i] / 2;
}

}  // namespace abbe
