#pragma once

// Internal to study: customer reports on errors that depend on states.
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Errors as a customer report states them: at the references of the measured and lag states on which they depend, with
/// their covariance. Terms with states that follow from the commands remain.
ErrorsFile errors_for_customer(const Machine& machine, ErrorsFile file);

/// "ambient_degC = 20 (readings: 16.2 to 19.1)": references that the readings did not cover; empty: all are covered.
std::string references_not_covered(const Machine& machine, const ErrorsFile& file);

/// At which states the figures of a report hold, what the readings covered and what happens beyond; none without
/// states.
std::vector<std::string> customer_state_notes(const Machine& machine, const ErrorsFile& file);

}  // namespace abbe
