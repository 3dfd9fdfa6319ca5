#pragma once

// Internal to study: the conventions for what changes no pose.
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/identify/gauge.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Equations that fix the combinations of errors that change no pose of the tool in the workpiece, except for one rigid
/// motion of the workpiece and one of the tool, as docs/conventions.md has them, over the ranges of the errors.
///
/// Errors with a state take no part: how they share a state is no matter of the datum.
///
/// The combinations are the null space of the derivatives of 200 or more poses at errors of zero.
/// @param structure  which errors there are; their values do not count
/// @returns functionals and directions over all parameters of the errors, [m]; none if the errors of an axis have no
///   range in common
std::vector<GaugeConstraint> pose_conventions(const Machine& machine, const ErrorSet& structure);

}  // namespace abbe
