#pragma once

#include <string>

#include "abbe/errors/error_set.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/machine/machine.h"

namespace abbe::python {

/// Errors of one machine, as an errors file has them: what `abbe.Errors` of Python is.
struct MachineErrors {
  Machine machine;
  ErrorsFile file;

  const ErrorSet& set() const { return file.errors; }
};

}  // namespace abbe::python
