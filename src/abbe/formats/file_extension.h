#pragma once

// Internal to formats.
#include <filesystem>
#include <string>

namespace abbe {

/// Extension with its point in small letters: ".stl" of "PART.STL".
inline std::string file_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

}  // namespace abbe
