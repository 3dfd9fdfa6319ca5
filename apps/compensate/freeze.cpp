#include "abbe/runtime/freeze.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/left_out_errors.h"
#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/controls/lost_motion_words.h"
#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/position_words.h"
#include "abbe/report/evaluations/position_json.h"
#include "abbe/report/version.h"
#include "abbe/report/words/left_out_words.h"
#include "abbe/runtime/abbe_runtime.h"
#include "command.h"
#include "compensate/compensate.h"
#include "compensate/safety.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"

namespace abbe {
namespace {

/// A frozen compensation that differs more from the full model of the same errors is not given out, mm.
constexpr double kLargestDifference = 1e-6;

struct FreezeArguments {
  std::string machine, errors, output, world = "joints";
  std::vector<double> tool, lengths{0, 300};
  std::optional<double> limit_um;
  double largest_turn_deg = 0.57;
  double leave_out_factor = 0;
  bool json = false, dry_run = false, accept_misfit = false;
};

FreezeOptions options_of(const FreezeArguments& arguments, const Machine& machine, const ErrorsFile& errors) {
  FreezeOptions options;
  options.tool = machine.tool_offset;
  if (!arguments.tool.empty()) options.tool = {arguments.tool[0], arguments.tool[1], arguments.tool[2]};
  if (!options.tool.allFinite()) throw InputError({.field = "--tool-mm"}, "not finite", "three lengths in mm");
  options.tool_length_min = arguments.lengths[0];
  options.tool_length_max = arguments.lengths[1];
  if (!(arguments.lengths[0] <= arguments.lengths[1]) || !std::isfinite(arguments.lengths[1] - arguments.lengths[0]))
    throw InputError({.field = "--tool-length-mm"}, "the range is empty", "the lower end first, in mm");
  options.largest_turn = largest_turn_option(arguments.largest_turn_deg);
  options.world_zero_at_joints = arguments.world == "joints";
  options.covariance = parameter_covariance(errors.errors, errors.covariance);
  options.source = machine_text(machine) + errors_text(machine, errors);
  options.version = version_text();
  return options;
}

/// What is left at the poses that are known to be compensated; never the largest of none.
std::string remaining_text(const FrozenCompensation& frozen) {
  if (frozen.points_compared == 0) return "not known: no pose where the errors are known was reached";
  std::string text = fmt::format("{:.1e} mm", frozen.accuracy);
  if (frozen.directions_compared > 0) text += fmt::format(" and {:.1e} rad", frozen.accuracy_turn);
  text += " at most";
  if (frozen.directions_compared == 0) text += "; the direction of the tool is not corrected";
  if (frozen.unreached > 0) text += fmt::format(" ({} of {} poses)", frozen.points_compared, frozen.poses);
  return text;
}

void print_result(const FreezeArguments& arguments, const Machine& machine, const FrozenCompensation& frozen,
                  const LeftOutErrors& left_out, bool written) {
  fmt::print("{}: errors of {} frozen\n", machine.name, arguments.errors);
  fmt::print("  {}: {} bytes, format {}, abbe {}, checksum {:016x} (machine and errors {:016x})\n",
             written             ? arguments.output
             : arguments.dry_run ? "dry run, nothing written"
                                 : "nothing written",
             frozen.bytes.size(), static_cast<int>(ABBE_RUNTIME_FORMAT), version_text(), frozen.checksum,
             frozen.source_checksum);
  fmt::print("  tried at {} poses, tools of {:g} to {:g} mm\n", frozen.poses, arguments.lengths[0],
             arguments.lengths[1]);
  fmt::print("  largest correction of the tool: {:.1f} um at {}, tool {:g} mm\n", 1e3 * frozen.largest_correction,
             position_words(machine, frozen.where, "{:.4g}"), frozen.tool_length_there);
  fmt::print("  largest correction of its direction: {:.1f} urad\n", 1e6 * frozen.largest_correction_turn);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    fmt::print("  largest correction of {}: {:.4g} {}", machine.axes[i].name,
               frozen.largest_joint[i] * micro_per_unit(rotary), micro_unit(rotary));
    fmt::print("{}\n", frozen.largest_joint[i] > 0
                           ? " at " + position_words(machine, frozen.largest_joint_at[i], "{:.4g}")
                           : "");
  }
  fmt::print("  after it, by the full model{}: {}\n", left_out.names.empty() ? "" : " with what is left out",
             remaining_text(frozen));
  if (frozen.largest_uncertainty > 0) {
    fmt::print(
        "  standard uncertainty of the tool's correction: {:.2f} um on average, at most {:.2f} um; in the file to "
        "{:.2f} um\n",
        1e3 * frozen.mean_uncertainty, 1e3 * frozen.largest_uncertainty, 1e3 * frozen.uncertainty_lattice);
  } else {
    fmt::print("  standard uncertainty of the tool's correction: not stated by the errors file\n");
  }
  if (arguments.leave_out_factor > 0)
    fmt::print("{}", left_out_text(machine, arguments.leave_out_factor, left_out, "  "));
  fmt::print("  iterations of one call: at most {}\n", frozen.worst_iterations);
  if (frozen.limited > 0)
    fmt::print("  near singularities the turn is bounded: at {} poses a part of the orientation error stays\n",
               frozen.limited);
  if (frozen.unreached > 0)
    fmt::print("  the axes cannot take all of the error of the point: at {} of {} poses a part of it stays\n",
               frozen.unreached, frozen.poses);
}

void print_json(const FreezeArguments& arguments, const Machine& machine, const ErrorSet& errors,
                const FrozenCompensation& frozen, const LeftOutErrors& left_out, bool written) {
  nlohmann::ordered_json json;
  json["machine"] = machine.name;
  json["errors"] = arguments.errors;
  json["output"] = arguments.output;
  json["written"] = written;
  json["bytes"] = frozen.bytes.size();
  json["format"] = static_cast<int>(ABBE_RUNTIME_FORMAT);
  json["version"] = version_text();
  json["checksum"] = fmt::format("{:016x}", frozen.checksum);
  json["source_checksum"] = fmt::format("{:016x}", frozen.source_checksum);
  json["poses"] = frozen.poses;
  json["largest_correction_um"] = 1e3 * frozen.largest_correction;
  json["largest_correction_urad"] = 1e6 * frozen.largest_correction_turn;
  nlohmann::ordered_json joints;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    joints[machine.axes[i].name + (rotary ? "_deg" : "_um")] = frozen.largest_joint[i] * (rotary ? 1 / kDegree : 1e3);
  }
  json["largest_correction_at"] = position_json(machine, frozen.where);
  json["largest_joint_corrections"] = joints;
  // null: the largest of nothing.
  const auto known = [](std::size_t count, double value) {
    return count > 0 ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
  };
  json["accuracy_mm"] = known(frozen.points_compared, frozen.accuracy);
  json["accuracy_rad"] = known(frozen.directions_compared, frozen.accuracy_turn);
  json["difference_by_freezing_mm"] = known(frozen.points_compared, frozen.difference);
  json["points_compared"] = frozen.points_compared;
  json["directions_compared"] = frozen.directions_compared;
  if (frozen.largest_uncertainty > 0) {
    json["largest_standard_uncertainty_um"] = 1e3 * frozen.largest_uncertainty;
    json["mean_standard_uncertainty_um"] = 1e3 * frozen.mean_uncertainty;
    json["standard_uncertainty_in_file_to_um"] = 1e3 * frozen.uncertainty_lattice;
  }
  state_left_out(machine, left_out, json);
  json["backlash"] = nlohmann::ordered_json::array();
  for (const JointBacklash& one : linuxcnc_backlash(machine, errors)) {
    json["backlash"].push_back({{"axis", one.axis},
                                {"setting", one.setting},
                                {one.rotary ? "lost_motion_deg" : "lost_motion_mm", one.lost_motion}});
  }
  json["worst_iterations"] = frozen.worst_iterations;
  json["turn_bounded"] = frozen.limited;
  json["point_not_reached"] = frozen.unreached;
  fmt::print("{}", json_text(json));
}

/// Why no pose was compensated, and what can be done.
std::string nothing_reached(const FrozenCompensation& frozen) {
  if (frozen.unreached < frozen.poses) {
    return "the remaining error is not known: at every pose that was reached, a correction leads out of the range "
           "where the errors are known; state the errors over the whole travel";
  }
  std::string text =
      fmt::format("the remaining error is not known: at none of {} poses can the axes correct the position completely",
                  frozen.poses);
  if (frozen.point_axes < 3) {
    text += fmt::format(
        ". This takes three linear axes, or two linear axes and one rotary axis; this machine has {} such ax{}. "
        "Correct the errors of an arm in the parameters of its control instead",
        frozen.point_axes == 0 ? "no" : fmt::format("{}", frozen.point_axes), frozen.point_axes == 1 ? "is" : "es");
  } else {
    text += ". Check whether the errors are larger than the largest correction (10 mm, and --largest-turn-deg)";
  }
  return text;
}

int run_freeze(const FreezeArguments& arguments) {
  const Machine machine = read_machine(arguments.machine);
  const ErrorsFile errors = read_errors_for_use(arguments.errors, machine, arguments.accept_misfit);
  if (arguments.output.empty() && !arguments.dry_run) {
    throw InputError({.field = "-o"}, "missing", "a file for the frozen compensation (*.abbec), or --dry-run");
  }
  if (!arguments.output.empty()) refuse_input_as_output(arguments.output);
  check_leave_out(arguments.leave_out_factor, errors, arguments.errors);
  const double limit_um = refusal_limit("--limit-um", arguments.limit_um, "um");
  FreezeOptions options = options_of(arguments, machine, errors);
  ErrorSet frozen_errors = errors.errors;
  LeftOutErrors left_out;
  if (arguments.leave_out_factor > 0) {
    left_out = leave_out_uncertain(machine, frozen_errors, options.covariance, arguments.leave_out_factor,
                                   tools_tried(machine, options));
    options.all_errors = errors.errors;
  }
  const FrozenCompensation frozen = freeze(machine, frozen_errors, options);
  if (!frozen.problem.empty()) throw InputError({.file = arguments.errors}, "cannot be frozen: " + frozen.problem);
  std::string refused;
  if (!(1e3 * frozen.largest_correction <= limit_um)) {
    refused = fmt::format("the correction is {:.1f} um, above --limit-um {:g}, at {}, tool {:g} mm",
                          1e3 * frozen.largest_correction, limit_um, position_words(machine, frozen.where, "{:.4g}"),
                          frozen.tool_length_there);
  } else if (frozen.points_compared == 0) {
    refused = nothing_reached(frozen);
  } else if (!(frozen.difference <= kLargestDifference)) {
    refused = fmt::format("the frozen compensation differs by {:.2e} mm from the full model", frozen.difference);
  }
  const bool written = refused.empty() && !arguments.dry_run;
  if (written) {
    write_file_atomically(arguments.output, {reinterpret_cast<const char*>(frozen.bytes.data()), frozen.bytes.size()});
  }
  if (arguments.json) {
    print_json(arguments, machine, frozen_errors, frozen, left_out, written);
  } else {
    print_result(arguments, machine, frozen, left_out, written);
    fmt::print("{}", linuxcnc_backlash_text(machine, frozen_errors));
  }
  if (refused.empty()) return kDone;
  tell("abbe: refused: {}; nothing was written\n", refused);
  return kNegative;
}

}  // namespace

void add_compensate_freeze(Subcommand& compensate, CommandLine& line) {
  auto arguments = std::make_shared<FreezeArguments>();
  Subcommand* command =
      compensate.add_subcommand("freeze", "Write machine and errors to one file that a controller uses in real time");
  command->footer(
      "The file is for the C interface abbe/runtime/abbe_runtime.h and for the LinuxCNC module (docs/runtime.md). It "
      "is\n"
      "tried at thousands of poses before it is written; the printed figures come from there. It does not contain\n"
      "reversal values: the lines for LinuxCNC's own BACKLASH are printed instead.\n\n"
      "Example:\n"
      "  abbe compensate freeze --machine examples/machines/trunnion-mill.machine.toml --errors "
      "examples/trunnion/table.errors.toml -o "
      "mill.abbec\n"
      "  abbe compensate freeze --machine examples/machines/trunnion-mill.machine.toml --errors "
      "examples/trunnion/table.errors.toml -o "
      "long-tools.abbec --tool-length-mm 60 220 --limit-um 500");
  add_machine_and_errors(*command, arguments->machine, arguments->errors);
  command->add_output_file("-o,--output", arguments->output, "File to write (*.abbec)", &arguments->dry_run);
  command->add_flag("--dry-run", arguments->dry_run,
                    "Report only: the largest corrections and where they are; write nothing");
  command
      ->add_option("--tool-mm", arguments->tool,
                   "Functional point from the gauge point, for calls that give no tool (default: that of the machine)")
      ->expected(3);
  command->add_option("--tool-length-mm", arguments->lengths, "Tool lengths that are tried; others are flagged")
      ->expected(2)
      ->capture_default_str();
  command->add_option("--limit-um", arguments->limit_um, "Refuse if the tool would be corrected by more than this");
  command
      ->add_option("--largest-turn-deg", arguments->largest_turn_deg,
                   "Largest turn of all rotary axes together; takes effect near singularities")
      ->capture_default_str();
  command
      ->add_option("--world", arguments->world,
                   "Origin of world coordinates: joints (zero where all joints are) or workpiece")
      ->check(one_of({"joints", "workpiece"}))
      ->capture_default_str();
  command->add_option("--leave-out-below-uncertainty", arguments->leave_out_factor,
                      "Leave out errors that are everywhere smaller than this many of their standard uncertainties");
  add_accept_misfit(*command, arguments->accept_misfit);
  command->add_flag("--json", arguments->json, "Print JSON for programs");
  command->callback([arguments, &line] { line.run = [arguments] { return run_freeze(*arguments); }; });
}

}  // namespace abbe
