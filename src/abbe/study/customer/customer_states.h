#pragma once

// Internal to study: customer reports on errors that depend on states.
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/machine/machine.h"
#include "abbe/report/customer/customer_report.h"
#include "abbe/study/study_result.h"

namespace abbe {

/// The identified errors as their file has them, as far as states matter.
ErrorsFile identified_for_customer(const Study& study, const StudyResult& result);

/// Errors as a customer report states them: at the references of the measured and lag states on which they depend, with
/// their covariance. Terms with states that follow from the commands remain.
ErrorsFile errors_for_customer(const Machine& machine, ErrorsFile file);

/// "ambient_degC = 20 (readings: 16.2 to 19.1)": references that the readings did not cover; empty: all are covered.
std::string references_not_covered(const Machine& machine, const ErrorsFile& file);

/// At which states the figures of a report hold, what the readings covered and what happens beyond; none without
/// states.
std::vector<std::string> customer_state_notes(const Machine& machine, const ErrorsFile& file);

/// States of the machine in the report, before and after a correction, with why nothing is proven of them.
/// @param is_refused  the result must not be used
std::vector<CustomerState> customer_states(const Study& study, const StudyResult& result, bool is_refused,
                                           ReportLanguage language);

}  // namespace abbe
