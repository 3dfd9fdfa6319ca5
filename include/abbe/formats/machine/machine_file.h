#pragma once

#include <filesystem>
#include <string>

#include "abbe/machine/machine.h"

namespace abbe {

/// Machine from a `*.machine.toml` file; the format is described in docs/formats.md. @throws InputError
Machine read_machine(const std::filesystem::path& path);
/// The same from text. @param file  name for messages
Machine parse_machine(const std::string& text, const std::string& file);

/// Text of a machine file without comments; parse_machine() gives back the same machine.
std::string machine_text(const Machine& machine);

/// Commented machine file for a chain such as "w C' X' b Z t", to be filled in by a person: `abbe new`. @throws
/// InputError
std::string commented_machine_file(const std::string& chain);

}  // namespace abbe
