#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/workpiece_option.h"

namespace abbe {

class Subcommand;

/// Errors that are going to correct something. Where they are marked and used nevertheless, that is told.
/// @param accept_misfit  the user's --accept-misfit
/// @param states         the user's --state
/// @param not_given      without --state: allowed where the job itself takes values of states
/// @throws InputError as read_errors_at(), and where they are marked as not to be trusted and nobody has accepted that
ErrorsFile read_errors_for_use(const std::filesystem::path& path, const Machine& machine, bool accept_misfit,
                               const std::vector<std::string>& states,
                               StatesOfErrors not_given = StatesOfErrors::refused);

/// Errors that are only looked at: marks are told, nothing is refused. @throws InputError as read_errors()
ErrorsFile read_errors_and_tell(const std::filesystem::path& path, const Machine& machine,
                                StatesOfErrors states = StatesOfErrors::refused);

/// The same at the user's --state. @throws InputError as read_errors_at()
ErrorsFile read_errors_and_tell(const std::filesystem::path& path, const Machine& machine,
                                const std::vector<std::string>& states);

/// Tells that errors of this file are marked as not to be trusted, if they are.
void tell_distrusted(const std::filesystem::path& path, const ErrorsFile& contents);

/// The option --state of commands that use errors at given values of states.
void add_states(Subcommand& command, std::vector<std::string>& states);

/// The options --workpiece-... of commands that make or map a workpiece at another temperature than 20 degC.
void add_workpiece(Subcommand& command, WorkpieceOptions& workpiece);

/// The option --accept-misfit of commands that use errors.
void add_accept_misfit(Subcommand& command, bool& accept_misfit);

}  // namespace abbe
