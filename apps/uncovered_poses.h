#pragma once

#include <cstddef>
#include <string>

namespace abbe {

/// What --accept-uncovered does, for --help.
inline constexpr const char* kAcceptUncoveredWords =
    "Exit code 0 even if poses of the map lie where the errors are not known";

/// That poses of a map have no result.
std::string uncovered_words(std::size_t left_out, std::size_t all);

/// Says on standard error how many poses of a map have no result, if any.
/// @returns the exit code of the command: kNegative for poses left out unless that is accepted
int tell_uncovered(std::size_t left_out, std::size_t all, bool accepted);

}  // namespace abbe
