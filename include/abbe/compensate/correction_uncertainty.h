#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "abbe/errors/error_set.h"

namespace abbe {

/// Standard uncertainties of values that are functions of the errors, from the covariance of the errors' parameters:
/// sqrt(g' C g) to first order, g by differences over one standard uncertainty of each parameter.
///
/// @param covariance  [p, p] of ErrorSet::parameters(), mm and rad; parameters with variance 0 are taken as known
/// @param values      a fixed number of values for a set of errors
/// Source: JCGM 100:2008, 5.2.2 and 5.1.3 note 2.
std::vector<double> propagated_uncertainty(const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                           const std::function<std::vector<double>(const ErrorSet&)>& values);

/// Covariance from the standard uncertainties that the errors state themselves, without correlation; 0 x 0 if they
/// state none.
Eigen::MatrixXd stated_variances(const ErrorSet& errors);

}  // namespace abbe
