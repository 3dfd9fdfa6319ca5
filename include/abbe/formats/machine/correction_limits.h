#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "abbe/errors/error_set.h"

// Limits that every kind of correction shares. Messages name a field by the option that sets it.

namespace abbe {

/// Limit above which corrections are refused, in its own unit; infinite if there is none.
/// @param option  "--limit-um"
/// @param unit    "um"
/// @throws InputError unless it is a finite number above zero: a limit that cannot be understood is not "no limit"
double refusal_limit(const char* option, const std::optional<double>& limit, const char* unit);

/// When tables and kinematic values are refused: --limit-um, --limit-urad and --least-reduction-percent.
/// @param limit_mm, limit_rad  largest change; none: any
/// @param least_reduction      share of the error, 0 to 1. @throws InputError
void check_refusal(const std::optional<double>& limit_mm, const std::optional<double>& limit_rad,
                   double least_reduction);

/// How far rotary axes may turn near a singularity, rad. @throws InputError unless it is above 0 and at most 10 deg
void check_largest_turn(double largest_turn);

/// What --leave-out-below-uncertainty needs: a factor of 0 (leave out nothing) to 1000, and stated uncertainties.
/// @param covariance  of the errors' parameters; 0 x 0: what the errors state themselves counts
/// @param file        name of the errors file. @throws InputError
void check_leave_out(double factor, const ErrorSet& errors, const Eigen::MatrixXd& covariance, const std::string& file);

}  // namespace abbe
