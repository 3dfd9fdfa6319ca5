#pragma once

#include <string>
#include <vector>

#include "command_description.h"

namespace abbe {

struct ManPage {
  std::string name;  ///< "abbe-compensate-table"
  std::string text;  ///< for man(1): macros of man(7)
};

/// A page for the program and one for each of its commands, in section 1.
/// @param version  "0.2.0"
/// @param date     of the release, "2026-11-26"
std::vector<ManPage> man_pages(const CommandDescription& program, const std::string& version, const std::string& date);

}  // namespace abbe
