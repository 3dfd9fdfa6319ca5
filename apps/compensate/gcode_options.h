#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/program/program_correction.h"
#include "abbe/formats/machine/workpiece_option.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/machine/machine.h"
#include "abbe/report/words/program_words.h"

namespace abbe {

/// What `abbe compensate gcode` is told.
struct GcodeOptions {
  std::string program, machine, errors, output;
  double tolerance_um = 1, rapid_tolerance_um = 10, orientation_tolerance_urad = 10;
  std::optional<double> limit_um;
  double dead_band_um = 0;
  double leave_out_factor = 0, largest_turn_deg = 0.5;
  std::vector<std::string> words, start, allow, states;
  std::string tool_table, parameters;
  int tool = -1, decimals = 6;
  std::optional<double> max_output_mb, max_minutes;
  WorkpieceOptions workpiece;
  bool tool_table_in_inches = false, parameters_in_inches = false;
  bool accept_misfit = false, tool_centre = false, inches = false, block_delete = false, dry_run = false, json = false;
};

NcProgramOptions gcode_text_options(const GcodeOptions& options, const Machine& machine, const WordAxes& words);
/// @param size  of the program, bytes
ProgramLimits gcode_limits(const GcodeOptions& options, std::size_t size);
ProgramCorrectionOptions gcode_correction_options(const GcodeOptions& options);

}  // namespace abbe
