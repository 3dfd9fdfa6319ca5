#pragma once

#include <string>
#include <string_view>

#include "abbe/compensate/tables/axis_table.h"

namespace abbe {

/// COMP_FILE of LinuxCNC 2.9: what its columns mean, COMP_FILE_TYPE in the ini file.
enum class LinuxCncCompensation {
  actual = 0,  ///< nominal, actual moving forward, actual moving in reverse: nominal - actual is added to the command
  trim = 1     ///< nominal, forward trim, reverse trim: the trim is added to the command
};

/// LinuxCNC keeps the first so many points of a file and drops the others without a word.
inline constexpr std::size_t kLinuxCncPoints = 256;

/// COMP_FILE of one joint: three numbers per line, no comment and no header (either ends the file silently), in mm or
/// degrees with 7 decimals (0.1 nm, 1.7 nrad).
/// @param table   input = output, at most kLinuxCncPoints nodes
/// @param rotary  degrees instead of mm
std::string linuxcnc_text(const AxisTable& table, bool rotary, LinuxCncCompensation type);

/// Reads a COMP_FILE and refuses what LinuxCNC would cut off or pass over.
/// @param file  name for messages
/// @returns a table for axis 0
/// @throws InputError for lines that are not three numbers, too many lines, nominal positions that do not increase
AxisTable parse_linuxcnc(std::string_view text, const std::string& file, bool rotary, LinuxCncCompensation type);

}  // namespace abbe
