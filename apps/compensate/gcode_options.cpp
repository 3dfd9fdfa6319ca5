#include "compensate/gcode_options.h"

#include <fmt/format.h>

#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/axis_unit.h"
#include "axis_option.h"

namespace abbe {
namespace {

bool is_rotary(std::size_t word) { return word >= 3 && word < 6; }

/// "X_mm=100", "C_deg=30": the word of an axis in the program and where the axis stands.
/// @param on_axes  X Y Z are positions of the axes: what lies outside the travel is a mistake
void read_start(const std::string& text, const Machine& machine, const WordAxes& words, bool on_axes,
                NcProgramOptions& options) {
  const std::string name = text.substr(0, text.find('_'));
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (name != axis_word_text(static_cast<AxisWord>(i)) || words.axis[i] == Machine::npos) continue;
    // The axis may have another name than its word.
    const std::string of_axis = machine.axes[words.axis[i]].name + text.substr(name.size());
    const double position = axis_option(machine, "--start", of_axis).position;
    const Axis& axis = machine.axes[words.axis[i]];
    if ((on_axes || is_rotary(i)) && !axis.endless && !(position >= axis.travel_min && position <= axis.travel_max)) {
      const double unit = position_unit(axis);
      throw InputError(
          {.field = "--start " + text}, "outside the axis's travel",
          fmt::format("{:g} to {:g} {}", axis.travel_min / unit, axis.travel_max / unit, position_suffix(axis)));
    }
    options.start[i] = position;
    return;
  }
  throw InputError({.field = "--start " + text}, fmt::format("'{}' is not a word of an axis of the machine", name),
                   "WORD_unit=position, such as X_mm=100 or C_deg=30");
}

}  // namespace

AllowedProblems allowed_problems(const GcodeOptions& options) {
  AllowedProblems allowed;
  for (const std::string& name : options.allow) {
    if (name == "not-covered") {
      allowed.not_covered = true;
    } else if (name == "outside-travel") {
      allowed.outside_travel = true;
    } else if (name == "position-left") {
      allowed.position_left = true;
    } else if (name == "not-converged") {
      allowed.not_converged = true;
    } else if (name == "not-proven") {
      allowed.not_proven = true;
    } else if (name == "held-start") {
      allowed.held_start = true;
    } else {
      throw InputError({.field = "--allow " + name}, "unknown",
                       "not-covered, outside-travel, held-start, position-left, not-converged or not-proven");
    }
  }
  return allowed;
}

WordAxes gcode_words(const GcodeOptions& options, const Machine& machine) {
  PathProgramOptions named;
  named.words = axis_words(machine, options.words, "--word");
  WordAxes words;
  bool any = false;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    const std::string word = axis_word(machine.axes[axis].name, named);
    for (std::size_t i = 0; i < kAxisWords; ++i) {
      if (word != axis_word_text(static_cast<AxisWord>(i))) continue;
      const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
      if (rotary != is_rotary(i)) {
        throw InputError({.field = "--word"},
                         fmt::format("axis {} is {}, its word {} is not", machine.axes[axis].name,
                                     rotary ? "rotary" : "linear", word),
                         "A, B or C for rotary axes, X, Y, Z, U, V or W for linear ones");
      }
      words.axis[i] = axis;
      any = true;
    }
  }
  if (!any) {
    throw InputError({.file = options.machine}, "no axis has a word of programs",
                     "--word AXIS=WORD, such as --word C1=C");
  }
  return words;
}

NcProgramOptions gcode_text_options(const GcodeOptions& options, const Machine& machine, const WordAxes& words) {
  NcProgramOptions text;
  for (std::size_t i = 0; i < kAxisWords; ++i) text.words[i] = words.axis[i] != Machine::npos;
  for (const std::string& start : options.start) {
    read_start(start, machine, words, !options.tool_centre, text);
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
  const double megabytes = 1e-6 * static_cast<double>(size);
  return {options.max_output_mb.value_or(200 + 20 * megabytes), options.max_minutes.value_or(5 + 0.1 * megabytes)};
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
