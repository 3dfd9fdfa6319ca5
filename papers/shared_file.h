#pragma once

#include <filesystem>

namespace abbe {

/// A file that comes with the program (published readings, machines): looked for beside the installed program and in
/// the source tree around a build folder. @throws InputError naming the places looked at
std::filesystem::path shared_file(const std::filesystem::path& relative);

}  // namespace abbe
