#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "abbe/compensate/program/program_report.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Standard uncertainties of a correction, from those of the errors; to first order (JCGM 100:2008, 5.1.2 and 5.2.2).
struct PlaceUncertainty {
  bool stated = false;  ///< false: the errors file states none
  /// mm, of the functional point, along its deviation; in the direction in which it is largest where that is zero
  double point = 0;
  bool axes_known = false;              ///< false where the commands do not follow from the deviation: singular
  std::array<double, kMaxAxes> axis{};  ///< of the corrected commands, mm or rad; 0 of axes that take no correction
};

/// Covariance of ErrorSet::parameters(), [p, p]: as given or, where that is 0 x 0, from the standard uncertainties that
/// the errors state themselves, uncorrelated. All zero if they state none.
Eigen::MatrixXd parameter_covariance(const ErrorSet& errors, const Eigen::MatrixXd& covariance);

/// Uncertainty of the correction at one place of a program.
/// @param covariance  as parameter_covariance() gives it
/// @param moved       [axes] true for those that a word moves
/// @param given       values of measured states, as tool_deviation() takes them
PlaceUncertainty uncertainty_at(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                const ProgramPlace& place, const std::vector<bool>& moved,
                                std::span<const double> given = {});

}  // namespace abbe
