#pragma once

// The parts of the module, one function each.
#include <nanobind/nanobind.h>

namespace abbe::python {

namespace nb = nanobind;

void bind_input_error(nb::module_& module);
void bind_states(nb::module_& module);
void bind_machine(nb::module_& module);
void bind_errors(nb::module_& module);
void bind_poses(nb::module_& module);
void bind_inverse(nb::module_& module);
void bind_compensation(nb::module_& module);
void bind_instruments(nb::module_& module);
void bind_studies(nb::module_& module);
void bind_study_checks(nb::module_& module);
void bind_study_results(nb::module_& module);
void bind_verified_readings(nb::module_& module);
void bind_location_distortion(nb::module_& module);
void bind_comparisons(nb::module_& module);
void bind_imported_tables(nb::module_& module);
void bind_plans(nb::module_& module);
void bind_use_arguments(nb::module_& module);
void bind_frozen_errors(nb::module_& module);
void bind_frozen_compensation(nb::module_& module);
void bind_corrected_commands(nb::module_& module);
void bind_corrected_program(nb::module_& module);
void bind_control_tables(nb::module_& module);
void bind_kinematic_values(nb::module_& module);
void bind_planned_measurements(nb::module_& module);
void bind_planned_probings(nb::module_& module);
void bind_maps(nb::module_& module);
void bind_verifications(nb::module_& module);
void bind_curves(nb::module_& module);
void bind_placements(nb::module_& module);
void bind_planned_paths(nb::module_& module);
void bind_evaluation_reports(nb::module_& module);
void bind_evaluations(nb::module_& module);
void bind_customer_reports(nb::module_& module);
void bind_histories(nb::module_& module);

}  // namespace abbe::python
