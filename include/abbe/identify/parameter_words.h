#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/identify/problem.h"

namespace abbe {

/// An error motion or a location error in the words of ISO 230-1:2012 (linear axes) and ISO 230-7:2015 (rotary axes):
/// "straightness error motion of X in Z", "axis average line of C: position in X".
std::string error_words(const Machine& machine, std::size_t axis, Component component, bool is_location);

/// What estimated parameters are, each error once, in their order: "EZX: straightness error motion of X in Z; unknowns
/// of the set-up of bar". What goes beyond `most` is counted.
/// @param which  entries of the vector of estimates
std::string parameter_words(const Problem& problem, const std::vector<EstimatedParameter>& parameters,
                            const std::vector<std::size_t>& which, std::size_t most = 4);

/// The entries of a direction that are named for it: from the largest amount down to a share of that; amounts that are
/// equal but for rounding keep their order.
/// @param direction  [parameters] in units that make the entries comparable
std::vector<std::size_t> largest_entries(const Eigen::VectorXd& direction, double share);

}  // namespace abbe
