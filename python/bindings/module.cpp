#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/report/version.h"
#include "bindings/bindings.h"
#include "bindings/files.h"
#include "bindings/numpy_arrays.h"
#include "bindings/shapes/shapes.h"

namespace abbe::python {
namespace {

NB_MODULE(_core, module) {
  // Objects that live as long as the process, such as those of a test or of a notebook, are no leaks.
  nb::set_leak_warnings(false);
  load_numpy();
  module.doc() = "The library of abbe; import abbe instead.";
  module.attr("__version__") = version_text();
  module.def(
      "set_threads",
      [](int threads) {
        if (threads < 0)
          throw InputError({.field = "threads"}, std::to_string(threads) + " is below zero", "0 or more");
        set_default_thread_count(threads);
      },
      nb::arg("threads"), "Number of threads that computations use; 0: one for each processor.");
  module.def("threads", &default_thread_count, "Number of threads that computations use.");
  module.def("write_text", &write_text, nb::arg("path"), nb::arg("text"), nb::arg("overwrite"),
             "Writes a file, whole or not at all.");
  bind_input_error(module);
  bind_states(module);
  bind_machine(module);
  bind_errors(module);
  bind_poses(module);
  bind_inverse(module);
  bind_compensation(module);
  bind_instruments(module);
  bind_studies(module);
  bind_study_results(module);
  bind_plans(module);
  bind_use_arguments(module);
  bind_frozen_errors(module);
  bind_frozen_compensation(module);
  bind_corrected_commands(module);
  bind_corrected_program(module);
  bind_control_tables(module);
  bind_kinematic_values(module);
  bind_maps(module);
  bind_verifications(module);
  bind_curves(module);
  bind_placements(module);
  bind_planned_paths(module);
  bind_clouds(module);
  bind_meshes(module);
  bind_evaluations(module);
  bind_ideal_shapes(module);
  bind_fits(module);
  bind_transforms(module);
  bind_registrations(module);
  bind_deviations(module);
  bind_scan_points(module);
  bind_planned_scans(module);
  bind_planned_measurements(module);
  bind_planned_probings(module);
  bind_imported_tables(module);
  bind_comparisons(module);
  bind_histories(module);
  bind_customer_reports(module);
}

}  // namespace
}  // namespace abbe::python
