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
  PoseList commands;               ///< [axes][samples] mm or rad
  std::vector<double> time_s;      ///< [samples], never decreasing; empty if the file does not say
  std::vector<std::size_t> lines;  ///< [samples] of the file in which each stands, from 1, for messages
};

/// Reads a CSV with a column for each axis (X_mm, A_deg, ...) and one row per sample; `time_s` may be there. What else
/// a trace or the commands that `abbe path` writes may have is checked to be numbers and not used: `line` (of the
/// program), `step`, `point`, `region`, `beam`, `feed_mm_per_min`, `length_mm`, `dwell_s`. Commands may leave the
/// travel as far as a correction does.
/// @throws InputError for a file with less than two samples, times that decrease, and as read_csv()
TraceFile read_trace(const std::filesystem::path& path, const Machine& machine);
/// The same from text. @param file  name for messages
TraceFile parse_trace(std::string_view text, const std::string& file, const Machine& machine);

}  // namespace abbe
