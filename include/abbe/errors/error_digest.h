#pragma once

#include "abbe/errors/error_set.h"
#include "abbe/geometry/digest.h"

namespace abbe {

/// Adds everything by which two machines, or two sets of errors, can differ in what is computed from them.
void add_to(Digest& digest, const Machine& machine);
void add_to(Digest& digest, const ErrorSet& errors);

}  // namespace abbe
