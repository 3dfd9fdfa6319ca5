#include "abbe/errors/reversal.h"

#include <algorithm>

namespace abbe {

ReversalShift::ReversalShift(const ErrorSet& errors) : first_(errors.parameter_count() - 3 - errors.reversals.size()) {
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
