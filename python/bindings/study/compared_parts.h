#pragma once

#include "bindings/bindings.h"

namespace abbe::python {

/// Classes of pairs of campaigns, their errors and curves.
void bind_compared_parts(nb::module_& module);

}  // namespace abbe::python
