#pragma once

// What stands behind the classes of studies in Python.
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "abbe/formats/study/study.h"
#include "abbe/instruments/instrument.h"
#include "abbe/study/planning/planning.h"
#include "abbe/study/study_result.h"
#include "bindings/bindings.h"
#include "bindings/machine_errors.h"

namespace abbe::python {

/// An instrument where it stands, and the machine that it measures.
struct MachineInstrument {
  std::string setup;  ///< name of its set-up
  std::string word;   ///< "ball-bar"
  std::shared_ptr<const Instrument> device;
  Machine machine;
};

/// Readings of an instrument.
struct PythonReadings {
  MachineInstrument instrument;
  InstrumentReadings readings;
};

/// A study and what came out. Both are needed to say anything about the result.
struct StudyOutcome {
  std::shared_ptr<const Study> study;
  StudyResult result;
};

/// A copy of the study in which the readings and the truth that were given take the place of files.
/// @param readings  by the name of the set-up  @param truth  null: that of the study
/// @throws InputError, KeyError of Python
std::shared_ptr<const Study> study_with_data(const Study& study, const std::map<std::string, PythonReadings>& readings,
                                             const MachineErrors* truth);

/// Adds methods that look at the readings of a study without identifying anything.
void add_study_check(nb::class_<Study>& bound);
void add_study_verification(nb::class_<Study>& bound);
/// Adds the thermal test of location errors.
void add_location_distortion(nb::class_<Study>& bound);

/// The errors that a study identified, as in its errors file. @throws InputError if there are none
MachineErrors identified_errors(const StudyOutcome& outcome);

struct PlanOutcome {
  std::shared_ptr<const Study> study;
  StudyPlan plan;
};

/// A JSON text as objects of Python.
nb::object python_of_json(const std::string& text);

}  // namespace abbe::python
