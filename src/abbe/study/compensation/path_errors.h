#pragma once

// Internal to study: errors that change along a tool path.
#include "abbe/study/compensation/planned_path.h"

namespace abbe {

/// Errors of a machine on a path.
struct ErrorsOfPath {
  ErrorSet constant;               ///< location errors without a state, tool offset error: the geometry of the machine
  std::vector<std::string> along;  ///< names of the others: error motions, and errors whose states follow the path
};
ErrorsOfPath errors_of_path(const Machine& machine, const ErrorSet& errors);

/// Corrects the commands of a path that was planned with the constant errors, so that the actual tool is where that
/// path has it, with all errors and their states at every pose. Fills commands, miss and deviation between the poses,
/// or the reason why the path must not be used.
/// @param machine  nominal, with the workpiece in place
/// @param zero     [axes] zero position errors of the calibrated machine
void correct_along_path(const PathRequest& request, const Machine& machine, const std::vector<double>& zero,
                        const Curve& curve, PlannedPath& planned);

}  // namespace abbe
