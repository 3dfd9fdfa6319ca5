#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "abbe/errors/chain_plan.h"

namespace abbe::chain {

/// Positions of the axes at a block of commands of a machine with coupled axes; arrays of the states as they came.
class CoupledPositions {
 public:
  /// @param couplings  of the machine, in any order
  /// @param count      at most ChainPlan::kBlockSize
  CoupledPositions(const std::vector<AxisCoupling>& couplings, const PositionArrays& commands, std::size_t first,
                   std::size_t count)
      : axes_(commands.axis.size()), states_(commands.state.size()), count_(count) {
    for (std::size_t i = 0; i < axes_; ++i) axis_[i] = commands.axis[i] + first;
    for (std::size_t j = 0; j < states_; ++j) {
      state_[j] = commands.state[j] == nullptr ? nullptr : commands.state[j] + first;
    }
    for (const AxisCoupling& coupling : couplings) {
      double* const moved = position_[coupling.axis].data();
      const double* const of = commands.axis[coupling.of] + first;
      if (axis_[coupling.axis] != moved) {
        std::copy_n(axis_[coupling.axis], count, moved);
        axis_[coupling.axis] = moved;
      }
      for (std::size_t k = 0; k < count; ++k) moved[k] += coupling.ratio * of[k];
    }
  }
  CoupledPositions(const CoupledPositions&) = delete;
  CoupledPositions& operator=(const CoupledPositions&) = delete;

  PositionArrays arrays() const { return {{axis_.data(), axes_}, count_, {state_.data(), states_}}; }

 private:
  std::size_t axes_, states_, count_;
  std::array<const double*, kMaxAxes> axis_;
  std::array<const double*, kMaxStates> state_;
  std::array<std::array<double, ChainPlan::kBlockSize>, kMaxAxes> position_;
};

/// Derivatives by positions become those by commands: by_position[(axis * rows + row) * count + k].
/// @param couplings  as couplings_in_order() gives them
/// @param size       rows times count
inline void hand_to_commands(const std::vector<AxisCoupling>& couplings, std::size_t size, double* by_position) {
  for (const AxisCoupling& coupling : couplings) {
    double* const of = by_position + coupling.of * size;
    const double* const axis = by_position + coupling.axis * size;
    for (std::size_t k = 0; k < size; ++k) of[k] += coupling.ratio * axis[k];
  }
}

}  // namespace abbe::chain
