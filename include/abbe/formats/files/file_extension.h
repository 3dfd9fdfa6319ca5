#pragma once

// For formats and the program abbe-step.
#include <filesystem>
#include <string>

#include "abbe/formats/text/ascii_letters.h"

namespace abbe {

/// Extension with its point in small letters: ".stl" of "PART.STL".
inline std::string file_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = lower_case(c);
  return extension;
}

/// "scan.csv" of "scan.csv.gz": the name of what gzip packed.
inline std::filesystem::path without_gz(std::filesystem::path path) {
  if (file_extension(path) == ".gz" && path.has_stem()) path.replace_extension();
  return path;
}

}  // namespace abbe
