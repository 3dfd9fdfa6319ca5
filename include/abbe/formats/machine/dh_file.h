#pragma once

#include <filesystem>
#include <string>

#include "abbe/machine/dh_arm.h"

namespace abbe {

/// A Denavit-Hartenberg table as TOML (`*.dh.toml`) or CSV; the formats are described in docs/dh-tables.md.
/// machine_from_dh() of it has no problems. @throws InputError
DhArm read_dh_arm(const std::filesystem::path& path);
/// The same from text. @param file  name for messages; a name that ends in .csv: the text is CSV
DhArm parse_dh_arm(const std::string& text, const std::string& file);

/// Machine file of the arm, with comments on where it came from; parse_machine() gives machine_from_dh().
std::string dh_machine_text(const DhArm& arm, const std::string& file);

}  // namespace abbe
