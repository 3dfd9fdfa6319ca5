#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/text/json_text.h"
#include "abbe/study/planning/plan_page.h"
#include "abbe/study/planning/plan_text.h"
#include "bindings/arrays.h"
#include "bindings/files.h"
#include "bindings/study/study_objects.h"
#include "bindings/tables.h"

namespace abbe::python {
namespace {

/// What one set-up reads of the plan, in the order in which it is taken.
PythonReadings readings_of_plan(const PlanOutcome& outcome, const std::string& name) {
  const Study& study = *outcome.study;
  for (std::size_t s = 0; s < study.setups.size(); ++s) {
    const Setup& setup = study.setups[s];
    if (setup.name != name) continue;
    InstrumentReadings readings;
    readings.inputs.resize(setup.device->inputs().size());
    std::vector<std::vector<double>> states;
    for (std::size_t k = 0; k < outcome.plan.readings.size(); ++k) {
      const CandidateReading& reading = outcome.plan.readings[k];
      if (reading.setup != s) continue;
      readings.append(reading.pose, reading.item, reading.inputs);
      if (!outcome.plan.reading_states.empty()) states.push_back(outcome.plan.reading_states[k]);
    }
    give_states(states, readings.poses);
    if (readings.count() == 0) readings.poses.axis.resize(study.machine.axes.size());
    return {{setup.name, setup.instrument, setup.device->as_planned(), study.machine}, std::move(readings)};
  }
  throw nb::key_error(fmt::format("no set-up '{}' in the study", name).c_str());
}

}  // namespace

void bind_plans(nb::module_& module) {
  nb::class_<PlanOutcome> bound(module, "StudyPlan", "Readings to take, and what they would be worth.");
  add_tables(bound, "plan_frame", "plan_html");
  bound
      .def_prop_ro(
          "machine", [](const PlanOutcome& o) { return o.study->machine; }, "A copy of the machine.")
      .def_prop_ro(
          "done", [](const PlanOutcome& o) { return o.plan.plan.status == PlanningStatus::done; },
          "Whether there is a plan; text() says why not.")
      .def("__len__", [](const PlanOutcome& o) { return o.plan.readings.size(); })
      .def_prop_ro(
          "positions_mm_rad",
          [](const PlanOutcome& o) {
            const std::size_t axes = o.study->machine.axes.size(), count = o.plan.readings.size();
            Columns<double> positions(axes, count);
            for (std::size_t k = 0; k < count; ++k) {
              for (std::size_t i = 0; i < axes; ++i) positions[i][k] = o.plan.readings[k].pose[i];
            }
            return positions.release({axes}, false);
          },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"),
          "[n, axes] commands in the order in which the readings are to be taken, mm or rad.")
      .def_prop_ro(
          "setups",
          [](const PlanOutcome& o) {
            std::vector<std::string> names;
            for (const CandidateReading& reading : o.plan.readings)
              names.push_back(o.study->setups[reading.setup].name);
            return names;
          },
          "[n] the set-up of each reading.")
      .def("readings", &readings_of_plan, nb::arg("setup"),
           "The plan of one set-up, ready to be simulated or measured.")
      .def_prop_ro(
          "time_s", [](const PlanOutcome& o) { return o.plan.time; }, "Time that the readings take, s.")
      .def_prop_ro(
          "uncertainty_mm", [](const PlanOutcome& o) { return o.plan.uncertainty; },
          "Predicted standard uncertainty of the volumetric error, root mean square, mm.")
      .def_prop_ro(
          "curve",
          [](const PlanOutcome& o) {
            Columns<double> curve(2, o.plan.curve.size());
            for (std::size_t k = 0; k < o.plan.curve.size(); ++k) {
              curve[0][k] = static_cast<double>(o.plan.curve[k].readings);
              curve[1][k] = o.plan.curve[k].determined ? o.plan.curve[k].uncertainty : NAN;
            }
            return curve.release({2}, false);
          },
          nb::sig("def curve(self) -> numpy.ndarray"),
          "[k, 2] number of readings and predicted uncertainty in mm (NaN where they do not determine the errors).")
      .def(
          "text", [](const PlanOutcome& o) { return study_plan_text(*o.study, o.plan); }, "The plan for people.")
      .def(
          "to_dict", [](const PlanOutcome& o) { return python_of_json(json_text(plan_json(*o.study, o.plan))); },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"), "The figures of `abbe plan --json`.")
      .def(
          "csv", [](const PlanOutcome& o) { return plan_csv(*o.study, o.plan); }, "The readings as CSV.")
      .def(
          "page_html", [](const PlanOutcome& o) { return plan_page(*o.study, o.plan); }, "The plan as a page.")
      .def(
          "write",
          [](const PlanOutcome& o, const std::filesystem::path& path, bool overwrite) {
            write_text(path, plan_csv(*o.study, o.plan), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, "Writes the readings as CSV, whole or not at all.")
      .def("__repr__", [](const PlanOutcome& o) {
        return fmt::format("<abbe.StudyPlan: {} readings, {:.3g} um>", o.plan.readings.size(),
                           1e3 * o.plan.uncertainty);
      });
}

}  // namespace abbe::python
