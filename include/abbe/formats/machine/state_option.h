#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// "ambient_degC=26.5" of an option that may be given several times: values of measured and lag states, with the unit
/// in the name as in columns.
/// @param option  how the user calls it, for the error: "--state"
/// @return [states of the machine] in the unit of each state, NaN where not given
/// @throws InputError
std::vector<double> state_options(const Machine& machine, const std::string& option,
                                  const std::vector<std::string>& texts);

/// The errors of a file as they are at given values of measured and lag states: at_state(), with the covariance and the
/// standard uncertainties. Files whose errors use no such state come back as they are.
/// @param values  [states of the machine], as state_options() returns them
/// @param path    of the file, for messages
/// @throws InputError naming the options of the states that are not given
ErrorsFile at_given_states(const Machine& machine, ErrorsFile file, std::span<const double> values,
                           const std::string& path);

/// Adds to the covariance what the errors have wandered since their measurement, as their file says (ErrorAgeing).
/// @param days  since the measurement
void add_ageing(const Machine& machine, double days, ErrorsFile& file);

/// read_errors() with --state: for a job that cannot take states into account, and can be done at values of theirs.
/// @param states     texts of --state, days_since_measurement among them
/// @param not_given  without values of states: allowed where the job itself takes them, with the readings or poses
/// @throws InputError as both
ErrorsFile read_errors_at(const std::filesystem::path& path, const Machine& machine,
                          const std::vector<std::string>& states, StatesOfErrors not_given = StatesOfErrors::refused);

/// The same for errors that have been read.
/// @param option  how the user calls it, for the error: "--state"
/// @param path    of the file, for messages
ErrorsFile errors_at_options(const Machine& machine, ErrorsFile file, const std::string& option,
                             const std::vector<std::string>& states, const std::string& path,
                             StatesOfErrors not_given = StatesOfErrors::refused);

/// The errors of a file with their states, older if --state says so, for a job that takes the values itself.
/// @param values  [states of the machine] written: those of --state, NaN where not given
/// @throws InputError
ErrorsFile read_errors_and_values(const std::filesystem::path& path, const Machine& machine,
                                  const std::vector<std::string>& states, std::vector<double>& values);

/// Ranges of measured states, "ambient_degC=15:30" of an option, the lower end first.
/// @param option  how the user calls it, for the error: "--state-range"
/// @return [states of the machine] in the unit of each state; nothing where not given
/// @throws InputError
std::vector<std::optional<std::pair<double, double>>> state_range_options(const Machine& machine,
                                                                          const std::string& option,
                                                                          const std::vector<std::string>& texts);

/// Values of states beyond what the readings of the errors covered, a sentence each; of states that the errors use.
/// @param values  [states of the machine], NaN where not given
std::vector<std::string> values_outside_covered(const Machine& machine, const ErrorsFile& file,
                                                std::span<const double> values);

/// States of poses beyond what the readings of the errors covered: a sentence for each state, with the worst pose.
std::vector<std::string> states_outside_covered(const Machine& machine, const ErrorsFile& file, const PoseList& poses);

/// "ambient_degC = 26.5, column_degC = 24".
std::string state_words(const StateValues& values);

}  // namespace abbe
