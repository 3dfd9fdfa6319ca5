#pragma once

// Internal to formats: initialisation files of SINUMERIK controls, line by line.
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/table_numbers.h"

namespace abbe {

/// One line "$NAME[index, ...] = value ; comment".
struct SiemensAssignment {
  std::string name;                       ///< upper case, with $
  std::vector<std::string_view> indices;  ///< without blanks
  std::string_view value;                 ///< without blanks, of "(AX1)" and "AX1" in quotes the name inside
};

/// Reads up to the next assignment; lines of the head and the end (%..., ;$PATH, CHANDATA(n), M17, M30, M02, M0) and
/// comments are passed over.
/// @returns false at the end of the text @throws InputError for any other line
bool next_siemens_assignment(TableLines& lines, SiemensAssignment& assignment);

}  // namespace abbe
