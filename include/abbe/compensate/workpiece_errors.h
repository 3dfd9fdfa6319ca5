#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A workpiece that is not at its reference temperature as errors of the machine that works on it.
///
/// A machine without errors is wrong on such a workpiece: at 20 degC the point that the tool reached will be elsewhere.
/// With e = alpha (T - T0) and g = e/(1 + e) the tool has the displacement -g (p - fixed) against the workpiece, p its
/// nominal point: a machine with that error that is corrected brings the tool to fixed + (1 + e) (p - fixed) exactly.
/// The displacement is a sum over the links of the chain from the fixed point to the tool, each along its own body, so
/// that error motions make it up without a remainder on machines of any kind: linear axes have one in proportion to
/// their position, links between rotary axes are constant ones, and the link from the fixed point to a rotary table is
/// one of the first harmonic of that table. All of them share g. Derivation: docs/conventions.md.
class WorkpieceErrors {
 public:
  /// @param factor  temperature less its reference, K
  WorkpieceErrors(const Machine& machine, const WorkpieceExpansion& expansion, double factor);

  /// Errors with the workpiece's behind their error motions. Composition as in ISO 230 only.
  ErrorSet with(const ErrorSet& errors) const;

  /// Covariance of the parameters of with(), from that of the errors; what the workpiece brings is independent of it.
  /// @param covariance   [p, p] of ErrorSet::parameters(); 0 x 0: none
  /// @param tool_length  X, Y, Z of the tool length offset in force, mm: axis positions are larger by it
  /// @returns 0 x 0 if nothing is stated of either
  Eigen::MatrixXd covariance_with(const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                  const std::array<double, 3>& tool_length = {}) const;

  /// As ProgramCorrectionOptions: a tool that is longer by a tool length offset moves the point by this share of it.
  double tool_length_share() const { return -shrinkage_; }

 private:
  double shrinkage_ = 0;    ///< g
  double uncertainty_ = 0;  ///< of g, standard
  ErrorSet of_unit_;        ///< of g = 1: error motions and a tool offset error
};

}  // namespace abbe
