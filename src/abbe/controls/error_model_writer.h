#pragma once

#include <string>
#include <vector>

#include "abbe/controls/table_format.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Errors that a control with a kinematic model gets: those of wanted axes, without what was left out. No tool offset
/// error.
ErrorSet wanted_errors(const Machine& machine, const ErrorSet& errors, const WriterRequest& request);

/// Name, nodes, step, the largest correction, and some forty places at which the uncertainty is looked at. `values`,
/// units and the error of interpolation are the caller's.
/// @param corrections  [positions]
WrittenTable summary_of(std::string name, const std::vector<double>& positions, const std::vector<double>& corrections);

/// The same of a location error, which is one number.
WrittenTable summary_of(const Machine& machine, const LocationError& location);

}  // namespace abbe
