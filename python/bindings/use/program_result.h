#pragma once

#include <optional>
#include <string>

#include "abbe/report/words/program_words.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// A corrected program, and what its report needs.
struct ProgramResult {
  Machine machine;
  CorrectedProgram corrected;
  std::string program_file, output;  ///< names; no output: a dry run
  std::optional<std::string> text;   ///< of the corrected program; none: refused, or in a file
  double tolerance_um = 1, leave_out_factor = 0;
};

void bind_program_result(nb::module_& module);

}  // namespace abbe::python
