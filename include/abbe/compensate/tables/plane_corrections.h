#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "abbe/compensate/program/command_correction.h"
#include "abbe/compensate/tables/correction_lattice.h"

namespace abbe {

/// Every two of these, each pair in the given order: {0, 1}, {0, 2}, {1, 2}.
std::vector<std::array<std::size_t, 2>> axis_pairs(const std::vector<std::size_t>& axes);

/// One of several tables over two axes each, whose sum corrects two or three axes: what it holds, as finely as one
/// likes. Of the commands only those of its pair are looked at.
///
/// With c(q) the correction of LatticeFunction, F_ij what it is while axes i and j move and all others stand at the
/// reference, F_i the same for one axis and F_0 for none, the tables are
///     two axes:    F_12
///     three axes:  F_12,  F_13 - F_1,  F_23 - F_2 - F_3 + F_0
/// so that every term of one axis is in one table only and the sum is c wherever c is a sum of functions of two axes
/// each (an expansion about planes through one point, second order of "cut-HDMR", Rabitz and Alis, J. Math. Chem. 25
/// (1999) 197). To first order in the errors this is all of the shift of the functional point that three linear axes
/// cause: an angle of one axis times the lever that another one changes.
class PlaneCorrection final : public CommandCorrection {
 public:
  /// @param options  LatticeOptions::inputs are all two or three axes
  /// @param pair     index into axis_pairs(inputs)
  PlaneCorrection(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options, std::size_t pair);
  void evaluate(const PoseList& commands, PoseList& correction) const override;

 private:
  struct Term {
    double sign = 1;
    std::unique_ptr<LatticeFunction> function;
  };
  std::vector<Term> terms_;
};

/// What several corrections add up to.
class CorrectionSum final : public CommandCorrection {
 public:
  explicit CorrectionSum(std::vector<std::unique_ptr<CommandCorrection>> parts) : parts_(std::move(parts)) {}
  void evaluate(const PoseList& commands, PoseList& correction) const override;

 private:
  std::vector<std::unique_ptr<CommandCorrection>> parts_;
};

}  // namespace abbe
