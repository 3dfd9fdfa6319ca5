#include "abbe/formats/files/companion_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <system_error>

namespace abbe {
namespace {

bool can_be_run(const std::filesystem::path& path) {
  std::error_code ignored;
  return ::access(path.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(path, ignored);
}

}  // namespace

std::filesystem::path path_beside_this_program(const CompanionProgram& program) {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / program.name;
}

std::filesystem::path find_companion_program(const CompanionProgram& program, const InputError::Place& place) {
  if (const char* named = std::getenv(program.variable); named != nullptr && *named != '\0') {
    if (can_be_run(named)) return named;
    throw InputError(place, fmt::format("{} names {}, which is not a program", program.variable, named),
                     fmt::format("the program {}, or no such variable", program.name));
  }
  const std::filesystem::path beside = path_beside_this_program(program);
  return can_be_run(beside) ? beside : std::filesystem::path();
}

}  // namespace abbe
