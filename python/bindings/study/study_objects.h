#pragma once

// What stands behind the classes of studies in Python.
#include <memory>
#include <optional>
#include <string>

#include "abbe/formats/study/study.h"
#include "abbe/instruments/instrument.h"
#include "abbe/study/planning.h"
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

/// The errors that a study identified, as in its errors file. @throws InputError if there are none
MachineErrors identified_errors(const StudyOutcome& outcome);

struct PlanOutcome {
  std::shared_ptr<const Study> study;
  StudyPlan plan;
};

/// A JSON text as objects of Python.
nb::object python_of_json(const std::string& text);

}  // namespace abbe::python
