#pragma once

#include "abbe/study/verification/verification.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// Traces and what tools leave on test pieces.
void bind_piece_parts(nb::module_& module);

}  // namespace abbe::python
