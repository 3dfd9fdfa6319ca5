#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/compensate/left_out_errors.h"
#include "abbe/compensate/machine_planes.h"
#include "abbe/compensate/program_correction.h"
#include "abbe/compensate/program_uncertainty.h"
#include "abbe/compensate/tool_centre_moves.h"
#include "abbe/errors/reversal.h"
#include "abbe/formats/errors_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/kept_inputs.h"
#include "abbe/formats/machine_file.h"
#include "abbe/formats/nc_program.h"
#include "abbe/formats/streamed_file.h"
#include "abbe/formats/text_file.h"
#include "command.h"
#include "compensate/compensate.h"
#include "compensate/gcode_options.h"
#include "compensate/gcode_report.h"
#include "compensate/safety.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "progress.h"

namespace abbe {
namespace {

void state_uncertainties(const Machine& machine, const ErrorsFile& errors, const WordAxes& words, GcodeResult& result) {
  const Eigen::MatrixXd covariance = parameter_covariance(errors.errors, errors.covariance);
  std::vector<bool> moved;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) moved.push_back(words.moves(i));
  const auto at = [&](const ProgramPlace& place) {
    return place.line == 0 ? PlaceUncertainty{} : uncertainty_at(machine, errors.errors, covariance, place, moved);
  };
  result.largest = at(result.report.largest_shift);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) result.by_axis.push_back(at(result.report.by_axis[i]));
  for (const ReversalAxis& axis : result.reversals) {
    auto parameter = static_cast<Eigen::Index>(first_reversal(errors.errors));
    for (const Reversal& reversal : errors.errors.reversals) {
      if (reversal.axis == axis.axis)
        result.reversal_uncertainty.push_back(std::sqrt(std::max(0.0, covariance(parameter, parameter))));
      ++parameter;
    }
  }
}

int run_gcode(const GcodeOptions& options) {
  if (options.output.empty() && !options.dry_run) {
    throw InputError({.field = "-o"}, "missing", "a file for the corrected program, or --dry-run");
  }
  const Machine machine = read_machine(options.machine);
  const ErrorsFile errors = read_errors_for_use(options.errors, machine, options.accept_misfit);
  check_leave_out(options.leave_out_factor, errors, options.errors);
  const WordAxes words = gcode_words(options, machine);
  NcProgramOptions text_options = gcode_text_options(options, machine, words);
  const AllowedProblems allowed = allowed_problems(options);
  const MachinePlanes planes(machine, words);
  text_options.planes = &planes;
  text_options.tool_centre = options.tool_centre;

  GcodeResult result;
  ErrorSet corrected_errors = errors.errors;
  if (options.leave_out_factor > 0) {
    result.left_out = leave_out_uncertain(
        machine, corrected_errors, parameter_covariance(errors.errors, errors.covariance), options.leave_out_factor);
  }
  MappedFile program(options.program);
  const std::size_t size = program.text().size();
  const GcodeBudget allowed_budget = gcode_budget(options, size);
  ProgramBudget budget(static_cast<std::size_t>(1e6 * allowed_budget.megabytes), 60 * allowed_budget.minutes);
  text_options.budget = &budget;
  ProgramCorrectionOptions correction_options = gcode_correction_options(options);
  correction_options.budget = &budget;
  ProgramCorrection correction(machine, corrected_errors, words, correction_options);
  if (!correction.problem().empty()) throw InputError({.file = options.errors}, correction.problem());
  ToolCentreMoves tool_centre(correction);
  MoveCorrector& corrector = options.tool_centre ? static_cast<MoveCorrector&>(tool_centre) : correction;

  std::optional<StreamedFile> out;
  if (!options.output.empty()) refuse_input_as_output(options.output);
  if (!options.dry_run) out.emplace(options.output);
  Progress progress("correcting the program");
  result.text = correct_nc_program(
      program.text(), options.program, text_options, corrector,
      [&](std::string_view text) {
        if (out) out->append(text);
      },
      [&](std::size_t end) {
        program.forget(end);
        progress(end, size);
      });
  result.report = correction.report();
  result.reversals = correction.reversals();
  if (result.report.impossible.count > 0) {
    throw InputError({.file = options.program, .line = result.report.impossible.line[0]},
                     "a tool centre move, for which the machine has no solution here",
                     "X, Y and Z as three independent linear axes without a rotary axis between them");
  }
  state_uncertainties(machine, errors, words, result);
  if (result.text.spent == ProgramBudget::Spent::nothing) {
    result.refused = reasons_to_refuse(options, allowed, machine, result.report);
  } else {
    result.refused = {given_up_words(options, allowed_budget, result.text)};
  }
  if (out && result.refused.empty()) out->commit();
  if (options.json) {
    fmt::print("{}", json_text(gcode_json(options, machine, result)));
  } else {
    print_gcode_report(options, machine, result);
  }
  std::fflush(stdout);
  for (const std::string& reason : result.refused) tell("abbe: {}\n", reason);
  if (!result.refused.empty() && !options.dry_run) tell("abbe: nothing written\n");
  return result.refused.empty() ? kDone : kNegative;
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
      "corrected.ngc\n\n"
      "X, Y and Z are axis positions unless G43.4 or --tool-centre says otherwise. The tool is that of the machine\n"
      "file, lengthened by the tool length offset in force. An axis with a reversal value takes up its play by a\n"
      "motion of its own wherever it reverses. Leave the control's own backlash compensation as it was when the "
      "errors\n"
      "were measured. See docs/programs.md.");
  command->add_option("program", options->program, "NC program (RS274/NGC, ISO 6983)")->required();
  command->add_option("--machine", options->machine, "Machine file (*.machine.toml)")->required();
  command->add_option("--errors", options->errors, "Errors file of the machine (*.errors.toml)")->required();
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
      "eighth "
      "of the tolerance, is part of the tolerance; a value given here is added to it. For a rotary axis it is a "
      "distance at the longest lever of the tool in force");
  command->add_option("--limit-um", options->limit_um,
                      "Refuse corrections of the functional point above this, um; nothing is written then");
  command->add_option("--leave-out-below-uncertainty", options->leave_out_factor,
                      "Leave out errors that are everywhere smaller than this many of their standard uncertainties");
  command
      ->add_option("--largest-turn-deg", options->largest_turn_deg,
                   "How far rotary axes may turn for a correction near a singularity")
      ->capture_default_str();
  command->add_option("--word", options->words, "Word of an axis in the program: C1=C");
  command->add_option("--start", options->start, "Where an axis stands when the program begins: X_mm=0, C_deg=30");
  command->add_option("--tool-table", options->tool_table, "Tool table of LinuxCNC, for G43 H");
  command->add_flag("--tool-table-in-inches", options->tool_table_in_inches,
                    "The lengths of the tool table are in inches");
  command->add_option("--tool", options->tool, "Number of the tool in the spindle");
  command->add_option("--parameters", options->parameters, "Parameter file of LinuxCNC (.var), for work offsets");
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
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options] { return run_gcode(*options); }; });
}

}  // namespace abbe
