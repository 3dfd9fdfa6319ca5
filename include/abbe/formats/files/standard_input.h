#pragma once

#include <filesystem>

namespace abbe {

/// Name of standard input where a file has one: for readers, in messages and in results.
inline constexpr const char* kStandardInput = "<stdin>";

/// From now on the file of that name is standard input. For command lines that say so; otherwise a file that names
/// another one could have it read.
void accept_standard_input();

/// The name under which the system opens a file for reading. It is `path`, except for standard input. That can be read
/// several times: what does not come from a file on the disk is kept in a temporary one, which has no name and is gone
/// when the process ends.
/// @throws InputError if standard input cannot be read or kept
std::filesystem::path path_to_open(const std::filesystem::path& path);

}  // namespace abbe
