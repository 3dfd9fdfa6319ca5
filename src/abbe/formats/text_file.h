#pragma once

#include <filesystem>
#include <string>

namespace abbe {

/// Whole contents of a regular file. @throws InputError if it is missing, cannot be read, is no regular file or is
/// empty
std::string read_text_file(const std::filesystem::path& path);

}  // namespace abbe
