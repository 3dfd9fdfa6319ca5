#pragma once

// Internal to formats: names of files that are being written.
#include <filesystem>

namespace abbe {

/// The file that is written under a name: where a link leads. @throws InputError for a folder, device, pipe or socket,
/// which a new file would replace instead of being written to it
std::filesystem::path file_to_write(const std::filesystem::path& path);

/// "<name>.partial-<process>": what a file is called while this process writes it.
std::filesystem::path partial_name(const std::filesystem::path& path);

/// Removes what killed writers of this name left behind; puts an older result back that one of them had moved aside.
void remove_partials_of_killed_writers(const std::filesystem::path& path);

}  // namespace abbe
