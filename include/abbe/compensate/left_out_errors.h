#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

struct LeftOutReversal {
  std::size_t axis = 0;
  double times = 0;  ///< how many of its standard uncertainties the reversal value is
};
/// Reversal values smaller than `factor` times their own standard uncertainty are set to zero. Those without a stated
/// uncertainty stay.
/// @param covariance  as parameter_covariance() gives it
std::vector<LeftOutReversal> leave_out_uncertain_reversals(ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                                           double factor);

/// What was left out of a set of errors.
struct LeftOutErrors {
  std::vector<std::string> names;
  std::vector<std::string> kept;  ///< small against their own uncertainty, but not together with others
  double largest_shift = 0;       ///< mm, of the functional point by what is left out, over the travel
  std::vector<double> where;      ///< [axes] commands there, mm or rad; empty where nothing is left out
};

/// Error motions (all terms of one component of one axis together), location errors and reversal values that are
/// smaller than `factor` times their own standard uncertainty everywhere on the known travel are set to zero and named.
/// Those without a stated uncertainty stay.
///
/// Together they must be small as well: parameters that hang together (correlations, or many that add up) may be large
/// against the uncertainty of the correction although each alone is small against its own. At poses all over the travel
/// (its corners and 200 more) the shift of the functional point that all of them make, and the turn of the tool's
/// direction where there are rotary axes, is compared with the standard uncertainty of the whole correction in that
/// direction. Where it is not below `factor` times that, the error goes back which adds most to it at the worst pose,
/// until it is below at all poses.
///
/// @param covariance  as parameter_covariance() gives it
/// @param tools       functional points from the gauge point for these poses, mm; empty: that of the machine
LeftOutErrors leave_out_uncertain(const Machine& machine, ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                  double factor, const std::vector<Eigen::Vector3d>& tools = {});

}  // namespace abbe
