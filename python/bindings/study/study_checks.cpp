#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "abbe/study/run_study.h"
#include "abbe/study/study_check.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/job.h"
#include "bindings/study/study_objects.h"

namespace abbe::python {
namespace {

/// A study and what its readings say.
struct CheckedStudy {
  std::shared_ptr<const Study> study;
  StudyCheck check;
};

/// One set-up of it.
struct CheckedSetup {
  std::string name, instrument;
  std::size_t readings = 0;
  std::vector<UnexplainedReadings> unexplained;
};

CheckedStudy check_of(const Study& given, const std::map<std::string, PythonReadings>& readings,
                      const MachineErrors* truth, const nb::object& progress) {
  const auto study = study_with_data(given, readings, truth);
  return {study, job_result(progress, [&](const JobControl& control) {
            return check_study(*study, control.options(step_words(*study, StudyStep::gather)));
          })};
}

std::vector<CheckedSetup> setups_of(const CheckedStudy& checked) {
  std::vector<CheckedSetup> result;
  for (const CampaignSetup& setup : checked.check.campaign.setups) {
    result.push_back({setup.name, setup.instrument, setup.reading_count(), setup.unexplained});
  }
  return result;
}

void bind_checked_setup(nb::module_& module) {
  using Unexplained = UnexplainedReadings;
  nb::class_<Unexplained>(module, "UnexplainedReadings",
                          "Readings from one place that the nominal machine does not explain, and what would make them "
                          "fit.")
      .def_ro("place", &Unexplained::place, "Name of the station, or of the set-up.")
      .def_ro("readings", &Unexplained::readings, "Number of readings from there.")
      .def_ro("share", &Unexplained::share,
              "Share of them within 3 % of the extent of the points from where the nominal machine puts them.")
      .def_ro("rms_mm", &Unexplained::rms_mm, "Root mean square distance of these from there.")
      .def_ro("causes", &Unexplained::causes,
              "Mistakes in words, each of which would explain the readings: 'the azimuth counts clockwise'. More than "
              "one:\nthey fit equally well. None: no mistake that is known explains them.")
      .def_prop_ro(
          "mended_rms_mm",
          [](const Unexplained& u) -> std::optional<double> {
            if (u.causes.empty()) return std::nullopt;
            return u.mended_rms_mm;
          },
          "Root mean square distance without the mistake; None: none was found.")
      .def("text", &Unexplained::words, "All of this in one or two sentences.")
      .def("__repr__", [](const Unexplained& u) {
        return fmt::format("<abbe.UnexplainedReadings of {}: {} causes>", u.place, u.causes.size());
      });
  nb::class_<CheckedSetup>(module, "SetupCheck", "The readings of one set-up of a study that was checked.")
      .def_ro("name", &CheckedSetup::name)
      .def_ro("instrument", &CheckedSetup::instrument, "'tracker', 'ball-bar', ...")
      .def_ro("readings", &CheckedSetup::readings, "Their number.")
      .def_ro("unexplained", &CheckedSetup::unexplained,
              "Places whose readings the nominal machine does not explain, each an UnexplainedReadings.")
      .def("__repr__", [](const CheckedSetup& s) {
        return fmt::format("<abbe.SetupCheck {}: {} readings{}>", s.name, s.readings,
                           s.unexplained.empty() ? "" : ", not explained");
      });
}

}  // namespace

void add_study_check(nb::class_<Study>& bound) {
  bound.def("check", &check_of, nb::arg("readings"), nb::arg("truth").none(), nb::arg("progress").none());
}

void bind_study_checks(nb::module_& module) {
  bind_checked_setup(module);
  nb::class_<CheckedStudy> bound(
      module, "StudyCheck",
      "Whether the nominal machine explains the readings of a study, and what is wrong with them if not.\n\n"
      "Made by Study.check(). text() and json_text() are what `abbe check` prints. Method: "
      "docs/unexplained-readings.md.");
  bound
      .def_prop_ro(
          "explained", [](const CheckedStudy& c) { return c.check.is_explained(); },
          "Whether the nominal machine explains the readings of all places that can be judged.")
      .def_prop_ro("setups", &setups_of, "Each a SetupCheck.")
      .def_prop_ro(
          "unexplained",
          [](const CheckedStudy& c) {
            std::vector<UnexplainedReadings> all;
            for (const CampaignSetup& setup : c.check.campaign.setups) {
              all.insert(all.end(), setup.unexplained.begin(), setup.unexplained.end());
            }
            return all;
          },
          "Those of all set-ups.")
      .def_prop_ro(
          "warnings", [](const CheckedStudy& c) { return c.check.campaign.warnings; },
          "Sentences on the readings and on where the instruments stood, those on unexplained readings among them.")
      .def(
          "text", [](const CheckedStudy& c) { return study_check_text(*c.study, c.check); },
          "What the command prints.");
  add_json(bound, [](const CheckedStudy& c) { return study_check_json(*c.study, c.check); });
  bound.def("__repr__", [](const CheckedStudy& c) {
    return fmt::format("<abbe.StudyCheck '{}': {} readings, {}>", c.study->name, c.check.campaign.reading_count(),
                       c.check.is_explained() ? "explained" : "not explained");
  });
}

}  // namespace abbe::python
