#include "shared_file.h"

#include <fmt/format.h>

#include <system_error>

#include "abbe/formats/text/input_error.h"

namespace abbe {

std::filesystem::path shared_file(const std::filesystem::path& relative) {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::filesystem::path places[] = {
      program / ".." / "share" / "abbe" / relative,  // installed
      program / ".." / ".." / ".." / relative,       // build/<preset>/bin in the source tree
      program / ".." / ".." / ".." / "tests" / relative,
  };
  for (const std::filesystem::path& place : places) {
    if (std::filesystem::exists(place, ignored)) return std::filesystem::weakly_canonical(place, ignored);
  }
  throw InputError({.file = relative.string()}, "this file of the program was not found",
                   fmt::format("it at {} or {}", places[0].string(), places[1].string()));
}

}  // namespace abbe
