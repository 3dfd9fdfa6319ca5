#pragma once

#include <filesystem>
#include <string>

namespace abbe {

/// "part.stl" of "parts/part.stl", for titles and facts.
inline std::string file_name(const std::filesystem::path& path) { return path.filename().string(); }

}  // namespace abbe
