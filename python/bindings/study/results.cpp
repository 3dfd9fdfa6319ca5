#include "abbe/study/report/results.h"

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/report.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/report/report_data.h"
#include "abbe/study/report/study_text.h"
#include "abbe/study/report/summary.h"
#include "bindings/arrays.h"
#include "bindings/files.h"
#include "bindings/machine_errors.h"
#include "bindings/study/study_objects.h"
#include "bindings/tables.h"

namespace abbe::python {
namespace {

const Identification& identification(const StudyOutcome& outcome) { return outcome.result.identification; }

nb::object flags(const std::vector<EstimatedParameter>& parameters, bool EstimatedParameter::*flag) {
  std::vector<std::uint8_t> values;
  for (const EstimatedParameter& parameter : parameters) values.push_back(parameter.*flag ? 1 : 0);
  return array_of_bools(std::move(values));
}

std::size_t setup_index(const StudyOutcome& outcome, const std::string& name) {
  const auto& setups = outcome.result.campaign.setups;
  for (std::size_t i = 0; i < setups.size(); ++i) {
    if (setups[i].name == name) return i;
  }
  throw nb::key_error(fmt::format("no set-up '{}' in the study", name).c_str());
}

/// Measured minus modelled of a set-up, [n, rows].
nb::object residuals(const StudyOutcome& outcome, const std::string& name) {
  const std::size_t index = setup_index(outcome, name);
  const auto& all = outcome.result.model.problem.observations;
  if (index >= all.size()) return nb::none();
  const Observations& observations = *all[index].observations;
  const auto rows = static_cast<std::size_t>(observations.rows());
  const std::size_t count = observations.reading_count();
  Columns<double> result(rows, count);
  const std::vector<double> deviations = deviations_by_reading(observations);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t k = 0; k < count; ++k) result[r][k] = deviations[k * rows + r];
  return result.release({rows}, false);
}

nb::object used(const StudyOutcome& outcome, const std::string& name) {
  const std::size_t index = setup_index(outcome, name);
  const auto& all = outcome.result.model.problem.observations;
  if (index >= all.size()) return nb::none();
  std::vector<std::uint8_t> use = all[index].use;
  if (use.empty()) use.assign(all[index].observations->reading_count(), 1);
  for (std::uint8_t& flag : use) flag = flag ? 1 : 0;
  return array_of_bools(std::move(use));
}

std::string page(const StudyOutcome& outcome) {
  const nlohmann::ordered_json summary = study_summary(*outcome.study, outcome.result);
  return report_page(study_report_data(*outcome.study, outcome.result, summary));
}

nb::list outliers(const StudyOutcome& outcome) {
  nb::list result;
  for (const Outlier& outlier : identification(outcome).outliers) {
    nb::dict entry;
    entry["setup"] = outcome.result.campaign.setups.at(outlier.observations).name;
    entry["reading"] = outlier.reading;
    entry["norm"] = outlier.norm;
    entry["weight"] = outlier.weight;
    result.append(entry);
  }
  return result;
}

void write(const StudyOutcome& outcome, const std::filesystem::path& folder) {
  check_results_folder(folder);
  Study study = *outcome.study;
  study.output = folder;
  write_results(study, outcome.result);
}

void bind_identification(nb::class_<StudyOutcome>& result) {
  result
      .def_prop_ro(
          "status", [](const StudyOutcome& o) { return std::string(status_text(identification(o).status)); },
          "'converged', 'no convergence', 'rank deficient', ... or 'not run'.")
      .def_prop_ro(
          "message", [](const StudyOutcome& o) { return identification(o).message; }, "The status in one sentence.")
      .def_prop_ro(
          "usable", [](const StudyOutcome& o) { return o.result.usable(); },
          "Whether there are errors: converged and nothing impossible.")
      .def_prop_ro(
          "trusted", [](const StudyOutcome& o) { return !says_no(*o.study, o.result); },
          "Whether they may be used: usable, and not distrusted (or that was accepted).")
      .def_prop_ro(
          "distrusted",
          [](const StudyOutcome& o) {
            std::vector<std::string> reasons;
            for (const Distrust& reason : o.result.distrusted) reasons.push_back(reason.text);
            return reasons;
          },
          "Why the result must not be used as it is, a sentence each.")
      .def_prop_ro("warnings", [](const StudyOutcome& o) { return study_warnings(*o.study, o.result); })
      .def_prop_ro("errors", &identified_errors,
                   "The identified errors with their covariance. Raises InputError if there are none.")
      .def_prop_ro(
          "names",
          [](const StudyOutcome& o) {
            std::vector<std::string> names;
            for (const EstimatedParameter& parameter : identification(o).parameters) names.push_back(parameter.name);
            return names;
          },
          "Names of the estimates: 'EXX[P2]', 'tracker1.x'.")
      .def_prop_ro(
          "is_angle",
          [](const StudyOutcome& o) { return flags(identification(o).parameters, &EstimatedParameter::is_angle); },
          nb::sig("def is_angle(self) -> numpy.ndarray"), "[p] true for estimates in rad.")
      .def_prop_ro(
          "is_pure_number",
          [](const StudyOutcome& o) {
            return flags(identification(o).parameters, &EstimatedParameter::is_pure_number);
          },
          nb::sig("def is_pure_number(self) -> numpy.ndarray"), "[p] true for scales, which have no unit.")
      .def_prop_ro(
          "estimates_mm_rad", [](const StudyOutcome& o) { return Eigen::VectorXd(identification(o).estimates); },
          "[p] estimates, mm or rad.")
      .def_prop_ro(
          "standard_uncertainties_mm_rad",
          [](const StudyOutcome& o) { return Eigen::VectorXd(identification(o).standard_uncertainties); },
          "[p] standard uncertainties, mm or rad; 0 where the gauge fixes an estimate.")
      .def_prop_ro(
          "covariance", [](const StudyOutcome& o) { return Eigen::MatrixXd(identification(o).covariance); },
          "[p, p] covariance of the estimates, products of mm and rad.")
      .def_prop_ro(
          "gauge",
          [](const StudyOutcome& o) {
            std::vector<std::string> words;
            for (const GaugeConstraint& constraint : identification(o).gauge.constraints)
              words.push_back(constraint.words);
            return words;
          },
          "Conventions that fix what the readings cannot tell apart, in words.")
      .def_prop_ro(
          "singular_values",
          [](const StudyOutcome& o) { return Eigen::VectorXd(identification(o).gauge.singular_values); },
          "[p] of the column-scaled Jacobian at the start, relative to the largest.")
      .def_prop_ro("chi_square", [](const StudyOutcome& o) { return identification(o).statistics.chi_square; })
      .def_prop_ro("degrees_of_freedom",
                   [](const StudyOutcome& o) { return identification(o).statistics.degrees_of_freedom; })
      .def_prop_ro(
          "p_value", [](const StudyOutcome& o) { return identification(o).statistics.p_value; },
          "Probability of a larger chi-square if model and stated uncertainties are right.")
      .def_prop_ro(
          "variance_factor", [](const StudyOutcome& o) { return identification(o).statistics.variance_factor; },
          "Chi-square over degrees of freedom.")
      .def_prop_ro("outliers", &outliers, nb::sig("def outliers(self) -> list[dict[str, typing.Any]]"),
                   "Readings far off: set-up, reading, norm (standard uncertainties), weight; largest first.")
      .def_prop_ro(
          "costs",
          [](const StudyOutcome& o) {
            std::vector<double> costs;
            for (const IterationRecord& record : identification(o).history) costs.push_back(record.cost);
            const std::size_t count = costs.size();
            return array_of(std::move(costs), {count});
          },
          nb::sig("def costs(self) -> numpy.ndarray"), "[iterations] half the sum of squares.");
}

}  // namespace

MachineErrors identified_errors(const StudyOutcome& outcome) {
  if (!outcome.result.usable()) {
    throw InputError({.field = "errors"}, "there are none: " + identification(outcome).message,
                     "a study that converged");
  }
  return {outcome.study->machine, identified_errors_file(*outcome.study, outcome.result)};
}

void bind_study_results(nb::module_& module) {
  nb::class_<StudyOutcome> result(module, "StudyResult", "Everything that a study has computed.", nb::dynamic_attr());
  bind_identification(result);
  add_tables(result, "result_frame", "result_html");
  result
      .def_prop_ro(
          "setups",
          [](const StudyOutcome& o) {
            std::vector<std::string> names;
            for (const CampaignSetup& setup : o.result.campaign.setups) names.push_back(setup.name);
            return names;
          },
          "Names of the set-ups.")
      .def(
          "readings",
          [](const StudyOutcome& o, const std::string& name) {
            const CampaignSetup& setup = o.result.campaign.setups[setup_index(o, name)];
            return PythonReadings{{setup.name, setup.instrument, setup.device, o.study->machine}, setup.readings};
          },
          nb::arg("setup"), "Readings of a set-up, measured or simulated.")
      .def("residuals_mm_rad", &residuals, nb::arg("setup"),
           nb::sig("def residuals_mm_rad(self, setup: str) -> numpy.ndarray | None"),
           "Measured minus modelled of a set-up, [n, components], mm or rad.")
      .def("used", &used, nb::arg("setup"), nb::sig("def used(self, setup: str) -> numpy.ndarray | None"),
           "[n] which readings of a set-up took part in the fit; the others were held out.")
      .def_prop_ro(
          "truth",
          [](const StudyOutcome& o) -> std::optional<MachineErrors> {
            if (!o.result.campaign.truth) return std::nullopt;
            return MachineErrors{
                o.study->machine,
                {.errors = *o.result.campaign.truth, .covariance = {}, .provenance = {{"method", kTruthOfSimulation}}}};
          },
          "Simulated studies: the errors that the machine really has.")
      .def(
          "to_dict", [](const StudyOutcome& o) { return python_of_json(json_text(study_summary(*o.study, o.result))); },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"), "The headline figures: what summary.json holds.")
      .def(
          "text", [](const StudyOutcome& o) { return study_text(*o.study, o.result, nullptr); },
          "The result for people.")
      .def(
          "residuals_csv", [](const StudyOutcome& o) { return residuals_csv(*o.study, o.result); },
          "All residuals as CSV, one line per component of a reading.")
      .def("page_html", &page, "The report as a page that needs nothing else.")
      .def("write", &write, nb::arg("folder"),
           "Writes the results folder that `abbe run` writes, whole or not at all. A folder with other files is "
           "refused.")
      .def("__repr__", [](const StudyOutcome& o) {
        return fmt::format("<abbe.StudyResult '{}': {} readings, {}>", o.study->name, o.result.campaign.reading_count(),
                           status_text(identification(o).status));
      });
}

}  // namespace abbe::python
