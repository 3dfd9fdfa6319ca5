#pragma once

// Internal to formats: covariance of all parameters beside an errors file.
#include <Eigen/Core>
#include <string>
#include <string_view>

#include "abbe/errors/error_set.h"

namespace abbe {

/// @returns [p, p], mm and rad @throws InputError unless it is a symmetric matrix of exactly these parameters
Eigen::MatrixXd parse_covariance(std::string_view text, const std::string& file, const Machine& machine,
                                 const ErrorSet& errors);

}  // namespace abbe
