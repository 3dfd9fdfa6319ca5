#include <nanobind/stl/string.h>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/report/version.h"
#include "bindings/bindings.h"

namespace abbe::python {
namespace {

NB_MODULE(_core, module) {
  module.doc() = "The library of abbe; import abbe instead.";
  module.attr("__version__") = version_text();
  module.def("set_threads", &set_default_thread_count, nb::arg("threads"),
             "Number of threads that computations use; 0: one for each processor.");
  module.def("threads", &default_thread_count, "Number of threads that computations use.");
  bind_input_error(module);
  bind_machine(module);
  bind_errors(module);
  bind_poses(module);
  bind_compensation(module);
}

}  // namespace
}  // namespace abbe::python
