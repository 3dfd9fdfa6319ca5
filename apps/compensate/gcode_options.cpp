#include "compensate/gcode_options.h"

#include "abbe/formats/machine/axis_option.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/compensation/program_settings.h"

namespace abbe {
namespace {

/// "X_mm=100", "C_deg=30": the word of an axis in the program and where the axis stands.
void read_start(const std::string& text, const Machine& machine, const WordAxes& words, bool tool_centre,
                NcProgramOptions& options) {
  const std::string name = text.substr(0, text.find('_'));
  // The name of the axis may differ from its word.
  const std::string of_axis = machine.axes[axis_of_word(words, name, text)].name + text.substr(name.size());
  set_program_start(machine, words, axis_option(machine, "--start", of_axis), tool_centre, text, options);
}

}  // namespace

NcProgramOptions gcode_text_options(const GcodeOptions& options, const Machine& machine, const WordAxes& words) {
  NcProgramOptions text;
  for (std::size_t i = 0; i < kAxisWords; ++i) text.words[i] = words.axis[i] != Machine::npos;
  for (const std::string& start : options.start) {
    read_start(start, machine, words, options.tool_centre, text);
  }
  if (!options.parameters.empty()) text.parameters = read_nc_parameters(options.parameters);
  text.parameters_in_inches = options.parameters_in_inches;
  if (!options.tool_table.empty()) text.tools = read_nc_tools(options.tool_table, options.tool_table_in_inches);
  if (options.tool >= 0) text.tool = options.tool;
  text.inches = options.inches;
  text.block_delete = options.block_delete;
  text.decimals_mm = text.decimals_deg = options.decimals;
  text.batch = 1 << 14;
  return text;
}

ProgramLimits gcode_limits(const GcodeOptions& options, std::size_t size) {
  const ProgramLimits usual = default_program_limits(size);
  return {options.max_output_mb.value_or(usual.megabytes), options.max_minutes.value_or(usual.minutes)};
}

ProgramCorrectionOptions gcode_correction_options(const GcodeOptions& options) {
  ProgramCorrectionOptions correction;
  correction.tolerance.position = 1e-3 * options.tolerance_um;
  correction.rapid_tolerance = 1e-3 * options.rapid_tolerance_um;
  correction.tolerance.orientation = 1e-6 * options.orientation_tolerance_urad;
  correction.inverse.largest_turn = kDegree * options.largest_turn_deg;
  correction.reversal_dead_band = 1e-3 * options.dead_band_um;
  return correction;
}

}  // namespace abbe
