#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Where the axes of a machine were while a program ran, in the order of time.
struct TraceFile {
  PoseList commands;           ///< [axes][samples] mm or rad
  std::vector<double> time_s;  ///< [samples], never decreasing; empty if the file does not say
};

/// Reads a CSV with a column for each axis (X_mm, A_deg, ...) and one row per sample; `time_s` may be there, and
/// `line`, the line of the program (not read further). Commands may leave the travel as far as a correction does.
/// @throws InputError for a file with less than two samples, times that decrease, and as read_csv()
TraceFile read_trace(const std::filesystem::path& path, const Machine& machine);
/// The same from text. @param file  name for messages
TraceFile parse_trace(std::string_view text, const std::string& file, const Machine& machine, int threads = 0);

/// Line of the file in which a sample stands, from 1, for messages.
std::size_t trace_line(const std::filesystem::path& path, std::size_t sample);

}  // namespace abbe
