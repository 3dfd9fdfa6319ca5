#pragma once

// Internal to formats: what was being written and is not wanted any more.
#include <filesystem>

namespace abbe {

/// A file in a folder of results until they are whole: all that is there may be removed.
inline constexpr const char* kBeingWritten = ".abbe-being-written";

/// Removes an unfinished file, or an unfinished folder with all that is in it. kBeingWritten and the marker of results
/// go last, so that what a kill leaves is still known to be ours, and the next writer removes it. What cannot be
/// removed stays.
void remove_unfinished(const std::filesystem::path& path);

}  // namespace abbe
