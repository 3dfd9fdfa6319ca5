#pragma once

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_format.h"
#include "abbe/controls/table_text.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// Tables with what their report needs.
struct TableResult {
  Machine machine;
  ControlTables made;
  PartialErrors partial;
};

/// Formats, figures of tables, deviations.
void bind_table_parts(nb::module_& module);

}  // namespace abbe::python
