#pragma once

// Internal to formats: files that cannot be written.
#include <filesystem>
#include <system_error>

#include "abbe/formats/text/input_error.h"

namespace abbe {

/// @param error  errno
/// @throws InputError
[[noreturn]] inline void fail_to_write(const std::filesystem::path& path, int error) {
  throw InputError({path.string(), 0, 0, ""}, "cannot be written: " + std::generic_category().message(error),
                   "a writable folder with enough space");
}

}  // namespace abbe
