#pragma once

#include <vector>

#include "abbe/errors/error_set.h"

namespace abbe {

/// Standard uncertainties that the errors state of themselves, in the order of ErrorSet::parameters(); mm or rad, 0
/// where none is stated and of the tool offset error.
std::vector<double> stated_uncertainties(const ErrorSet& errors);

}  // namespace abbe
