#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "bindings/bindings.h"

namespace abbe::python {

/// Writes a file, whole or not at all.
/// @throws FileExistsError of Python  it is there and must not be replaced
void write_text(const std::filesystem::path& path, std::string_view text, bool overwrite);

/// The same check alone, before long work.
void refuse_existing(const std::filesystem::path& path, bool overwrite);

}  // namespace abbe::python
