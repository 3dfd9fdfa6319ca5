#include "abbe/study/verification/verified_readings.h"

#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <limits>

#include "bindings/evaluate/report.h"
#include "bindings/job.h"
#include "bindings/study/campaign_arguments.h"
#include "bindings/study/study_objects.h"
#include "bindings/use/map_parts.h"

namespace abbe::python {
namespace {

VerifiedReadings verification_by_readings(const Study& study, const MachineErrors& errors,
                                          const std::map<std::string, PythonReadings>& readings,
                                          const MachineErrors* truth, std::optional<double> least_reduction,
                                          std::optional<double> largest_ratio, const std::string& errors_file,
                                          const nb::object& progress) {
  require_same_machine(study.machine, errors.machine, "errors");
  ReadingsToVerify request;
  request.study = *study_with_data(study, readings, truth);
  request.identified = errors.file;
  request.errors_file = errors_file;
  request.least_reduction = least_reduction;
  request.largest_ratio = largest_ratio;
  warn_of_distrusted({errors_file, errors_file, errors.machine, errors.file});
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] { return verify_readings(request, control.options("fitting the set-ups")); });
  });
}

std::size_t index_of_setup(const VerifiedReadings& result, const std::string& name) {
  for (std::size_t s = 0; s < result.setups.size(); ++s) {
    if (result.setups[s].name == name) return s;
  }
  throw nb::key_error(fmt::format("no set-up '{}'", name).c_str());
}

/// [n] with NaN in place of what is negative: not used.
nb::object array_of_used(const std::vector<double>& values) {
  std::vector<double> result = values;
  for (double& value : result) {
    if (value < 0) value = std::numeric_limits<double>::quiet_NaN();
  }
  return array_of(std::move(result), {values.size()});
}

void add_setups_of_readings(nb::class_<VerifiedReadings>& bound) {
  bound
      .def_prop_ro(
          "setups",
          [](const VerifiedReadings& v) {
            std::vector<std::string> names;
            for (const SetupResiduals& setup : v.setups) names.push_back(setup.name);
            return names;
          },
          "Names of the set-ups.")
      .def(
          "residuals_before_mm",
          [](const VerifiedReadings& v, const std::string& name) {
            return array_of_used(v.setups[index_of_setup(v, name)].before);
          },
          nb::arg("setup"), nb::sig("def residuals_before_mm(self, setup: str) -> numpy.ndarray"),
          "[n] of each reading of a set-up, as in before_mm; NaN where a reading is left out or has no length. Raises "
          "KeyError.")
      .def(
          "residuals_after_mm",
          [](const VerifiedReadings& v, const std::string& name) {
            return array_of_used(v.setups[index_of_setup(v, name)].after);
          },
          nb::arg("setup"), nb::sig("def residuals_after_mm(self, setup: str) -> numpy.ndarray"), "[n] likewise.")
      .def(
          "norms",
          [](const VerifiedReadings& v, const std::string& name) {
            return array_of_used(v.judged.norm.at(index_of_setup(v, name)));
          },
          nb::arg("setup"), nb::sig("def norms(self, setup: str) -> numpy.ndarray"),
          "[n] Mahalanobis norm of what is left of each reading of a set-up, by the uncertainties of readings and "
          "errors;\nNaN where a reading is left out. Raises KeyError.");
}

void add_judgement_of_readings(nb::class_<VerifiedReadings>& bound) {
  bound
      .def_ro("uncertainties_known", &VerifiedReadings::uncertainties_known,
              "False: the errors state none, so that only those of the readings count.")
      .def_prop_ro(
          "chi_square", [](const VerifiedReadings& v) { return v.judged.chi_square; },
          "Of what is left, by the uncertainties of readings and errors together.")
      .def_prop_ro(
          "degrees_of_freedom", [](const VerifiedReadings& v) { return v.judged.degrees_of_freedom; },
          "Of chi_square; 0: there are no more readings than unknowns of the set-ups.")
      .def_prop_ro(
          "p_value", [](const VerifiedReadings& v) { return v.judged.p_value; },
          "Probability of a larger chi-square if model and uncertainties are right.")
      .def_prop_ro(
          "coverage",
          [](const VerifiedReadings& v) -> std::optional<double> {
            if (v.judged.components == 0) return std::nullopt;
            return static_cast<double>(v.judged.components_within) / static_cast<double>(v.judged.components);
          },
          "Share of the numbers read within their expanded uncertainty (k = 2), 0.954 expected; None: the fit of the\n"
          "set-ups reproduces every number.")
      .def_prop_ro(
          "reduction", &VerifiedReadings::reduction,
          "Mean residual of the nominal machine over that with the identified errors; 0: only angles are read.")
      .def_prop_ro("ratio", &VerifiedReadings::ratio,
                   "What is left over what the uncertainties explain, root mean square; 0: nothing to judge.")
      .def_ro("verdicts", &VerifiedReadings::verdicts, "What is asked of the readings, each a ReadingsVerdict.")
      .def_ro("warnings", &VerifiedReadings::warnings, "On the readings and on where the instruments stood.")
      .def_prop_ro("left_out", &VerifiedReadings::left_out, "Readings where the errors are not known.")
      .def_prop_ro("says_no", &VerifiedReadings::says_no, "Whether something that was asked for is not met.");
}

}  // namespace

void add_study_verification(nb::class_<Study>& bound) {
  bound.def("verify", &verification_by_readings, nb::arg("errors"), nb::arg("readings"), nb::arg("truth").none(),
            nb::arg("least_reduction").none(), nb::arg("largest_ratio").none(), nb::arg("errors_file"),
            nb::arg("progress").none());
}

void bind_verified_readings(nb::module_& module) {
  nb::class_<ReadingsVerdict>(module, "ReadingsVerdict", "On one of the figures that readings are asked for.")
      .def_ro("name", &ReadingsVerdict::name,
              "'improvement': residuals are smaller than without the errors; 'consistency': the uncertainties explain "
              "what is\nleft; 'reduction' and 'ratio': conditions that were given.")
      .def_ro("text", &ReadingsVerdict::text)
      .def_ro("met", &ReadingsVerdict::met)
      .def("__bool__", [](const ReadingsVerdict& v) { return v.met; })
      .def("__repr__", [](const ReadingsVerdict& v) {
        return fmt::format("<abbe.ReadingsVerdict {} {}: {}>", v.name, v.met ? "met" : "not met", v.text);
      });
  nb::class_<VerifiedReadings> bound(
      module, "VerifiedReadings",
      "What identified errors leave of readings that took no part in their identification. Made by Study.verify().\n\n"
      "text(), json_text() and page_html() give what `abbe verify --readings` writes. Method: docs/verify.md.");
  add_report_of_one_page(bound, &VerifiedReadings::report);
  bound.def_ro("readings", &VerifiedReadings::readings, "Their number, with those that are left out.")
      .def_prop_ro(
          "before_mm", [](const VerifiedReadings& v) { return copied_array(v.before); },
          nb::sig("def before_mm(self) -> numpy.ndarray"),
          "[n] length of measured minus modelled for the nominal machine, its set-ups fitted, of the readings that "
          "are\ncompared and have a length.")
      .def_prop_ro(
          "after_mm", [](const VerifiedReadings& v) { return copied_array(v.after); },
          nb::sig("def after_mm(self) -> numpy.ndarray"), "[n] the same with the identified errors.")
      .def_ro("before_statistics_mm", &VerifiedReadings::before_statistics)
      .def_ro("after_statistics_mm", &VerifiedReadings::after_statistics);
  add_setups_of_readings(bound);
  add_judgement_of_readings(bound);
  bound.def("__repr__", [](const VerifiedReadings& v) {
    return fmt::format("<abbe.VerifiedReadings: {} readings, mean residual {:.3f} um before, {:.3f} um after{}>",
                       v.readings, 1e3 * v.before_statistics.mean, 1e3 * v.after_statistics.mean,
                       v.says_no() ? ", a condition is not met" : "");
  });
}

}  // namespace abbe::python
