#pragma once

#include <string>

namespace abbe {

// Files of a results folder of `abbe run`, for commands that go on from there.

/// @param results  folder; empty: none was named, which is no error
/// @throws InputError if it is no folder
void require_results(const std::string& results);

/// Whether this is a folder: results are, their files are not.
bool is_results_folder(const std::string& path);

/// Name of a file that was named, or of the one that the results hold under this name.
/// @param named       by the user; empty: that of the results
/// @param results     folder; empty: none
/// @param in_results  "machine.toml"
/// @param option      by which the user can name it, for messages: "--machine"
/// @throws InputError if neither was named, and if the results have no such file
std::string file_or_of_results(const std::string& named, const std::string& results, const char* in_results,
                               const char* option);

/// Name of a file that results hold. @throws InputError, saying what is expected, if they do not
std::string file_of_results(const std::string& results, const char* in_results,
                            const std::string& expected = "a results folder of abbe run");

/// Text of the results' summary.json, or empty where there is none. @param results  folder; empty: none
std::string results_summary_text(const std::string& results);

}  // namespace abbe
