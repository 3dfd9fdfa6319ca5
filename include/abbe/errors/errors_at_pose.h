#pragma once

#include <span>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Errors of a machine that stands at one pose, for what is constant: terms with states that follow from commands
/// become terms without a state, as they are there. A side of approach is not known: the mean of both, zero.
///
/// @param commands  [axes] in chain order, mm or rad
/// @throws std::invalid_argument naming a measured or lag state: at_state() first
ErrorSet at_pose(const Machine& machine, const ErrorSet& errors, std::span<const double> commands);

}  // namespace abbe
