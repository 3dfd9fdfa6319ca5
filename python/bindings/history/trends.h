#pragma once

#include "bindings/bindings.h"

namespace abbe::python {

/// Classes of the trends of a machine's errors.
void bind_trends(nb::module_& module);

}  // namespace abbe::python
