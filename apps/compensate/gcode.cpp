#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/compensation/corrected_program.h"
#include "abbe/study/compensation/program_settings.h"
#include "command.h"
#include "compensate/compensate.h"
#include "compensate/gcode_options.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

int run_gcode(const GcodeOptions& options) {
  if (options.output.empty() && !options.dry_run) {
    throw InputError({.field = "-o"}, "missing", "a file for the corrected program, or --dry-run");
  }
  ProgramRequest request;
  request.machine = read_machine(options.machine);
  const Machine& machine = request.machine;
  const ErrorsFile errors = read_errors_for_use(options.errors, machine, options.accept_misfit, options.states);
  request.errors = errors.errors;
  request.at_state = errors.at_state;
  request.covariance = errors.covariance;
  request.workpiece = workpiece_option(machine, options.workpiece, options.states);
  request.program_file = options.program;
  request.errors_file = options.errors;
  request.words = program_word_axes(machine, options.words, options.machine);
  request.text = gcode_text_options(options, machine, request.words);
  request.tool_centre = options.tool_centre;
  request.allowed = allowed_problems(options.allow);
  request.leave_out_factor = options.leave_out_factor;
  MappedFile program(options.program);
  const std::size_t size = program.text().size();
  request.limits = gcode_limits(options, size);
  request.correction = gcode_correction_options(options);
  request.limit_um = options.limit_um;

  std::optional<StreamedFile> out;
  if (!options.output.empty()) refuse_input_as_output(options.output);
  if (!options.dry_run) out.emplace(options.output);
  Progress progress("correcting the program");
  const CorrectedProgram result = correct_program(
      request, program.text(),
      [&](std::string_view text) {
        if (out) out->append(text);
      },
      [&](std::size_t end) {
        program.forget(end);
        progress(end, size);
      });
  if (out && result.refused.empty()) out->commit();
  const ProgramWordsRequest words_request{.program = options.program,
                                          .output = options.output,
                                          .tolerance_um = options.tolerance_um,
                                          .leave_out_factor = options.leave_out_factor,
                                          .dry_run = options.dry_run};
  fmt::print("{}", options.json ? json_text(program_json(words_request, machine, result))
                                : program_text(words_request, machine, result));
  std::fflush(stdout);
  for (const std::string& reason : result.refused) tell("abbe: {}\n", reason);
  if (!result.refused.empty() && !options.dry_run) tell("abbe: nothing written\n");
  return tell_outside(result.at_state, result.refused.empty() ? kDone : kNegative);
}

}  // namespace

void add_compensate_gcode(Subcommand& compensate, CommandLine& line) {
  auto options = std::make_shared<GcodeOptions>();
  Subcommand* command = compensate.add_subcommand(
      "gcode", "Correct an NC program: the actual tool follows the commanded path within a tolerance");
  command->footer(
      "Example:\n"
      "  abbe compensate gcode examples/compensate/cone.ngc --machine "
      "examples/machines/trunnion-mill.machine.toml --errors examples/compensate/trunnion.errors.toml -o "
      "corrected.ngc\n"
      "  abbe compensate gcode examples/compensate/cone.ngc --machine examples/machines/trunnion-mill.machine.toml "
      "--errors examples/compensate/trunnion.errors.toml --workpiece-expansion-um-per-m-K 23.4 "
      "--workpiece-temperature-degC 26 --u-workpiece-temperature-K 0.5 -o warm.ngc\n\n"
      "X, Y and Z are axis positions unless G43.4 or --tool-centre says otherwise. The tool is that of the machine\n"
      "file, lengthened by the tool length offset in force. An axis with a reversal value takes up its play by a\n"
      "motion of its own wherever it reverses. Leave the control's own backlash compensation as it was when the\n"
      "errors were measured. See docs/programs.md.");
  command->add_input_file("program", options->program, "NC program (RS274/NGC, ISO 6983)")->required();
  add_machine(*command, options->machine)->required();
  add_errors(*command, options->errors)->required();
  command->add_output_file("-o,--output", options->output, "Corrected program to write", &options->dry_run);
  command
      ->add_option("--tolerance-um", options->tolerance_um,
                   "Largest distance of the actual tool from the commanded path between corrected poses")
      ->capture_default_str();
  command->add_option("--rapid-tolerance-um", options->rapid_tolerance_um, "The same for rapid moves")
      ->capture_default_str();
  command
      ->add_option("--orientation-tolerance-urad", options->orientation_tolerance_urad,
                   "The same for the direction of the tool")
      ->capture_default_str();
  command->add_option(
      "--reversal-dead-band-um", options->dead_band_um,
      "An axis with a reversal value counts as reversed once it has come back by more than this. The default, an "
      "eighth of the tolerance, is part of the tolerance; a value given here is added to it. For a rotary axis it is a "
      "distance at the longest lever of the tool in force");
  command->add_option("--limit-um", options->limit_um,
                      "Refuse corrections of the functional point above this, um; nothing is written then");
  command->add_option("--leave-out-below-uncertainty", options->leave_out_factor,
                      "Leave out errors that are everywhere smaller than this many times their standard uncertainties");
  command
      ->add_option("--largest-turn-deg", options->largest_turn_deg,
                   "How far rotary axes may turn for a correction near a singularity")
      ->capture_default_str();
  command->add_option("--word", options->words, "Word of an axis in the program: C1=C");
  command->add_option("--start", options->start, "Position of an axis when the program begins: X_mm=0, C_deg=30");
  command->add_input_file("--tool-table", options->tool_table, "Tool table of LinuxCNC, for G43 H");
  command->add_flag("--tool-table-in-inches", options->tool_table_in_inches,
                    "The lengths of the tool table are in inches");
  command->add_option("--tool", options->tool, "Number of the tool in the spindle");
  command->add_input_file("--parameters", options->parameters, "Parameter file of LinuxCNC (.var), for work offsets");
  command->add_flag("--parameters-in-inches", options->parameters_in_inches,
                    "The offsets of the parameter file are in inches");
  command->add_flag("--tool-centre", options->tool_centre,
                    "X Y Z are always the functional point in the workpiece frame: the control has the kinematics");
  command->add_flag("--inches", options->inches, "G20 is in force when the program begins");
  command->add_flag("--block-delete", options->block_delete, "Leave out blocks that begin with a slash");
  command->add_option("--decimals", options->decimals, "Decimals of mm and degrees in the program")
      ->check(in_range(0, 9));
  command->add_option("--allow", options->allow,
                      "Write the program despite: not-covered, outside-travel, held-start, position-left, "
                      "not-converged, not-proven");
  command->add_option("--max-output-mb", options->max_output_mb,
                      "Give up on a program that becomes longer (default: 200, plus 20 times the size of the program)");
  command->add_option("--max-minutes", options->max_minutes,
                      "Give up on a program that takes longer (default: 5, plus 1 for every 10 MB of the program)");
  command->add_flag("--dry-run", options->dry_run,
                    "Report only: the largest corrections and where they are; write nothing");
  add_workpiece(*command, options->workpiece);
  add_states(*command, options->states);
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options] { return run_gcode(*options); }; });
}

}  // namespace abbe
