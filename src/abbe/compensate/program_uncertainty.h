#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "abbe/compensate/program_report.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Standard uncertainties of a correction, from those of the errors; to first order (JCGM 100:2008, 5.1.2 and 5.2.2).
struct PlaceUncertainty {
  bool stated = false;                  ///< false: the errors file states none
  double point = 0;                     ///< mm, of the functional point, along its deviation
  bool axes_known = false;              ///< false where the commands do not follow from the deviation: singular
  std::array<double, kMaxAxes> axis{};  ///< of the corrected commands, mm or rad
};

/// Covariance of ErrorSet::parameters(), [p, p]: as given or, where that is 0 x 0, from the standard uncertainties that
/// the errors state themselves, uncorrelated. All zero if they state none.
Eigen::MatrixXd parameter_covariance(const ErrorSet& errors, const Eigen::MatrixXd& covariance);

/// Uncertainty of the correction at one place of a program.
/// @param covariance  as parameter_covariance() gives it
/// @param moved       [axes] true for those that a word moves
PlaceUncertainty uncertainty_at(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                const ProgramPlace& place, const std::vector<bool>& moved);

struct LeftOutReversal {
  std::size_t axis = 0;
  double times = 0;  ///< how many of its standard uncertainties the reversal value is
};
/// Reversal values smaller than `factor` times their own standard uncertainty are set to zero. Those without a stated
/// uncertainty stay.
/// @param covariance  as parameter_covariance() gives it
std::vector<LeftOutReversal> leave_out_uncertain_reversals(ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                                           double factor);

/// Error motions (all terms of one component of one axis together), location errors and reversal values that are
/// smaller than `factor` times their own standard uncertainty everywhere on the travel: set to zero, and named. Those
/// without a stated uncertainty stay.
/// @param covariance  as parameter_covariance() gives it
std::vector<std::string> leave_out_uncertain(const Machine& machine, ErrorSet& errors,
                                             const Eigen::MatrixXd& covariance, double factor);

}  // namespace abbe
