#pragma once

// The parts of the module, one function each.
#include <nanobind/nanobind.h>

namespace abbe::python {

namespace nb = nanobind;

void bind_input_error(nb::module_& module);
void bind_machine(nb::module_& module);
void bind_errors(nb::module_& module);
void bind_poses(nb::module_& module);
void bind_compensation(nb::module_& module);
void bind_instruments(nb::module_& module);
void bind_studies(nb::module_& module);
void bind_study_results(nb::module_& module);
void bind_plans(nb::module_& module);

}  // namespace abbe::python
