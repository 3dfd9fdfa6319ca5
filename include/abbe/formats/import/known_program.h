#pragma once

#include <optional>
#include <string_view>

namespace abbe {

/// A program whose text files are known by sight and have no public description.
struct KnownProgram {
  std::string_view what;    ///< "a report of Metrolog"
  std::string_view advice;  ///< what to export instead
};

/// Looks at the beginning of a text that could not be read as a table. @returns nothing for any other text
std::optional<KnownProgram> known_program(std::string_view text);

}  // namespace abbe
