#pragma once

// What tables and kinematic values for controls say in the same way.
#include <string>
#include <vector>

#include "abbe/report/evaluations/partial_errors.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// Adds figures of what is left of the errors, and the reasons not to use them.
/// @tparam Result  with `machine`, `made` and `partial`
/// @param what     "tables", "values"  @param without  "without tables"  @param with  "with these tables"
template <class Result>
void add_carried_figures(nb::class_<Result>& bound, const std::string& what, const std::string& without,
                         const std::string& with) {
  bound.def_ro("machine", &Result::machine)
      .def_prop_ro(
          "refused",
          [](const Result& r) {
            std::vector<std::string> reasons;
            for (const std::string& reason : r.made.refused) reasons.push_back(argument_words(reason));
            return reasons;
          },
          ("Why the " + what + " must not be used, a sentence each.").c_str())
      .def_prop_ro(
          "says_no", [](const Result& r) { return r.made.says_no(); },
          ("Whether there are no " + what + " to be used.").c_str())
      .def_prop_ro(
          "settings", [](const Result& r) { return r.made.settings; }, "What has to be set at the control.")
      .def_prop_ro(
          "errors", [](const Result& r) { return r.made.errors; }, "What becomes of every error alone.")
      .def_ro("partial", &Result::partial, "What the errors do not state.")
      .def_prop_ro(
          "positions_mm_rad", [](const Result& r) { return copied_poses(r.made.poses); },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"),
          "[n, axes] commands at which before, after and ideal are stated.")
      .def_prop_ro(
          "grid", [](const Result& r) { return r.made.grid; }, "Positions per axis of positions_mm_rad.")
      .def_prop_ro(
          "before", [](const Result& r) { return r.made.before; }, ("Deviations " + without + ".").c_str())
      .def_prop_ro(
          "after", [](const Result& r) { return r.made.after; }, ("Deviations " + with + ".").c_str())
      .def_prop_ro(
          "ideal", [](const Result& r) { return r.made.ideal; }, "Deviations with the best that the axes can do.")
      .def_prop_ro("ideal_not_reached", [](const Result& r) { return r.made.ideal_not_reached; })
      .def_prop_ro(
          "volumetric_mm", [](const Result& r) { return r.made.volumetric; },
          "Volumetric error that the errors predict over the stated grid.");
}

}  // namespace abbe::python
