#pragma once

#include <filesystem>

#include "abbe/formats/machine/errors_file.h"

namespace abbe {

class Subcommand;

/// Errors that are going to correct something. Where they are marked and used nevertheless, that is told.
/// @param accept_misfit  the user's --accept-misfit
/// @throws InputError as read_errors(), and where they are marked as not to be trusted and nobody has accepted that
ErrorsFile read_errors_for_use(const std::filesystem::path& path, const Machine& machine, bool accept_misfit,
                               StatesOfErrors states = StatesOfErrors::refused);

/// Errors that are only looked at: marks are told, nothing is refused. @throws InputError as read_errors()
ErrorsFile read_errors_and_tell(const std::filesystem::path& path, const Machine& machine,
                                StatesOfErrors states = StatesOfErrors::refused);

/// Tells that errors of this file are marked as not to be trusted, if they are.
void tell_distrusted(const std::filesystem::path& path, const ErrorsFile& contents);

/// The option --accept-misfit of commands that use errors.
void add_accept_misfit(Subcommand& command, bool& accept_misfit);

}  // namespace abbe
