#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/study/run_study.h"
#include "bindings/job.h"
#include "bindings/machine_errors.h"
#include "bindings/study/study_objects.h"

namespace abbe::python {
namespace {

/// What the numbers of readings are: "ball-bar: length; on table".
std::string meaning_of(const std::string& word, const Instrument& device) {
  std::vector<std::string> numbers, items;
  for (const ReadingComponent& component : device.components()) numbers.push_back(component.name);
  for (const InstrumentItem& item : device.items()) items.push_back(item.name);
  return fmt::format("{}: {}; on {}", word, fmt::join(numbers, ", "), fmt::join(items, ", "));
}

/// Columns and items are known by their places alone, so those of readings must be those of the set-up.
/// @throws InputError
void require_readings_of(const Setup& setup, const Machine& machine, const MachineInstrument& given) {
  const auto refuse = [&](const std::string& theirs, const std::string& own) {
    throw InputError({.file = setup.name, .field = "readings"}, "are of another instrument (" + theirs + ")", own);
  };
  if (given.machine.chain() != machine.chain()) {
    refuse("on a machine " + given.machine.chain(), "readings on a machine " + machine.chain());
  }
  const std::string theirs = meaning_of(given.word, *given.device), own = meaning_of(setup.instrument, *setup.device);
  if (theirs != own) refuse(theirs, "readings as of the set-up (" + own + ")");
}

std::shared_ptr<StudyOutcome> run_whole(const Study& study, const std::map<std::string, PythonReadings>& readings,
                                        const MachineErrors* truth, bool accept_misfit, bool map, bool advice,
                                        const nb::object& progress) {
  auto outcome = std::make_shared<StudyOutcome>();
  outcome->study = study_with_data(study, readings, truth);
  run_job(progress, [&](const JobControl& control) {
    RunOptions options;
    options.accept_misfit = accept_misfit;
    options.map = map;
    options.advice = advice;
    options.stop = control.stop;
    options.progress = [&](StudyStep step, std::size_t done, std::size_t total) {
      control.progress(step_words(*outcome->study, step), done, total);
    };
    outcome->result = run_study(*outcome->study, options);
  });
  return outcome;
}

std::map<std::string, PythonReadings> gather(const Study& study, const std::map<std::string, PythonReadings>& readings,
                                             const MachineErrors* truth, const nb::object& progress) {
  const auto complete = study_with_data(study, readings, truth);
  const Campaign campaign = job_result(progress, [&](const JobControl& control) {
    return gather_readings(*complete, control.options(step_words(*complete, StudyStep::gather)));
  });
  std::map<std::string, PythonReadings> result;
  for (const CampaignSetup& setup : campaign.setups) {
    result.emplace(setup.name,
                   PythonReadings{{setup.name, setup.instrument, setup.device, study.machine}, setup.readings});
  }
  return result;
}

std::shared_ptr<PlanOutcome> plan(const Study& study, const nb::object& progress) {
  auto outcome = std::make_shared<PlanOutcome>();
  outcome->study = std::make_shared<Study>(study);
  run_job(progress,
          [&](const JobControl& control) { outcome->plan = plan_study(*outcome->study, control.options("planning")); });
  return outcome;
}

}  // namespace

std::shared_ptr<const Study> study_with_data(const Study& study, const std::map<std::string, PythonReadings>& readings,
                                             const MachineErrors* truth) {
  auto result = std::make_shared<Study>(study);
  for (const auto& [name, given] : readings) {
    const auto setup = std::find_if(result->setups.begin(), result->setups.end(),
                                    [&name = name](const Setup& one) { return one.name == name; });
    if (setup == result->setups.end()) throw nb::key_error(fmt::format("no set-up '{}' in the study", name).c_str());
    if (result->simulation) {
      throw InputError({.field = "readings"}, "are given, but the study simulates its readings",
                       "a study without [simulate]");
    }
    if (given.readings.measured.empty()) {
      throw InputError({.file = name, .field = "readings"}, "are a plan, nothing is measured", "readings");
    }
    require_readings_of(*setup, study.machine, given.instrument);
    setup->data = {
        SetupData{.file = name, .mapping = {}, .readings = std::make_shared<InstrumentReadings>(given.readings)}};
  }
  if (truth) {
    if (!result->simulation)
      throw InputError({.field = "truth"}, "is given, but the study simulates nothing", "a study with [simulate]");
    if (truth->machine.chain() != study.machine.chain()) {
      throw InputError({.field = "truth"}, "are errors of another machine: " + truth->machine.chain(),
                       study.machine.chain());
    }
    result->simulation->errors = truth->set();
    result->simulation->generator.reset();
  }
  for (const Setup& setup : result->setups) {
    if (!result->simulation && setup.data.empty()) {
      throw InputError({.file = setup.name, .field = "readings"}, "the set-up has no readings",
                       "readings for it, or [[setup.data]] with a file");
    }
  }
  return result;
}

nb::object python_of_json(const std::string& text) {
  return nb::module_::import_("json").attr("loads")(nb::str(text.c_str(), text.size()));
}

void bind_studies(nb::module_& module) {
  bind_study_checks(module);
  bind_verified_readings(module);
  bind_location_distortion(module);
  nb::class_<Study> bound(module, "StudyData", "A study that has been checked against its machine; behind abbe.Study.");
  bound.def_static("read", &read_study, nb::arg("path"))
      .def_static(
          "parse",
          [](const std::string& text, const std::filesystem::path& path, const Machine& machine) {
            return parse_study(text, path, machine, ReadingsSource::given_later);
          },
          nb::arg("text"), nb::arg("path"), nb::arg("machine"))
      .def_ro("name", &Study::name)
      .def_ro("description", &Study::description)
      .def_prop_ro("machine", [](const Study& study) { return study.machine; })
      .def_prop_ro("output", [](const Study& study) { return study.output; })
      .def_prop_ro("simulated", [](const Study& study) { return study.simulation.has_value(); })
      .def("instruments",
           [](const Study& study) {
             std::vector<MachineInstrument> instruments;
             for (const Setup& setup : study.setups) {
               instruments.push_back({setup.name, setup.instrument, setup.device, study.machine});
             }
             return instruments;
           })
      .def("run", &run_whole, nb::arg("readings"), nb::arg("truth").none(), nb::arg("accept_misfit"), nb::arg("map"),
           nb::arg("advice"), nb::arg("progress").none())
      .def("gather", &gather, nb::arg("readings"), nb::arg("truth").none(), nb::arg("progress").none())
      .def("plan", &plan, nb::arg("progress").none());
  add_study_check(bound);
  add_study_verification(bound);
  add_location_distortion(bound);
}

}  // namespace abbe::python
