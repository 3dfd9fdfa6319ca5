#pragma once

// Commands of single poses corrected for the errors of a machine, as `abbe compensate poses` does it:
//
//   #include <abbe/formats/files/results_folder.h>
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/formats/readings/measurement_file.h>
//   #include <abbe/study/compensation/corrected_commands.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::CommandsRequest request;
//     request.machine = abbe::read_machine("examples/machines/trunnion-mill.machine.toml");
//     request.errors = abbe::read_errors("examples/compensate/trunnion.errors.toml", request.machine);
//     request.poses = abbe::read_poses("examples/compensate/poses.csv", request.machine);
//     request.limit_um = 500;
//     const abbe::CorrectedCommands result = abbe::correct_commands(request);
//     if (!result.refused.empty()) return 1;
//     abbe::write_file_atomically("corrected.csv", abbe::corrected_commands_csv(result));
//     std::printf("%zu poses, %zu of them not reached; largest correction %.1f um\n", result.poses.count(),
//                 result.not_reached, 1e3 * result.corrected.largest_shift.value);
//     return 0;  // corrected_commands_text() says more
//   }
//
// It prints:
//
//   20 poses, 0 of them not reached; largest correction 81.6 um
//
// Method and status of a pose: docs/compensation.md.

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/corrected_poses.h"
#include "abbe/errors/poses.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Commands that are to be corrected; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe compensate poses` that sets it, given below.
struct CommandsRequest {
  Machine machine;
  ErrorsFile errors;                      ///< without covariance: its standard uncertainties, as if independent
  PoseList poses;                         ///< commands, and the measured states that the errors depend on
  std::string machine_file, errors_file;  ///< names for messages

  /// --largest-turn-deg: of rotary axes, at most 10 degrees; none: 0.5 degrees, of an arm 5 degrees
  std::optional<double> largest_turn;
  std::vector<std::size_t> held;  ///< --hold: axes that keep their commands
  double leave_out_factor = 0;    ///< --leave-out-below-uncertainty: 0 to 1000; 0: none is left out; no states
  std::optional<WorkpieceExpansion> workpiece{};  ///< --workpiece-...: not at 20 degC, where it is to be right
  std::optional<double> limit_um;  ///< --limit-um: larger corrections of the point are refused; above zero
};

/// Corrected commands, and what is left. They hold no reference to the request.
struct CorrectedCommands {
  Machine machine;
  PoseList poses;               ///< of the request
  double leave_out_factor = 0;  ///< of the request
  StateValues at_state{};       ///< at which the errors are taken; `outside` also of the states of the poses
  CorrectedPoses corrected;
  std::optional<WorkpieceExpansion> workpiece{};  ///< of the request
  bool has_reversals = false;                     ///< the errors have reversal values, which are not in the commands
  std::string refused;                            ///< why the commands must not be used, in words; empty: they may
  std::size_t not_reached = 0;                    ///< poses to which the tool is not brought
};

/// Axis commands that bring the actual tool to where the nominal machine has it. Opens no file and prints nothing.
/// Errors that are marked as not to be trusted (ErrorsFile::distrusted) are corrected for like others.
/// @throws InputError for a machine on which nothing can be corrected, and for what is out of range in the request
CorrectedCommands correct_commands(const CommandsRequest& request);

/// CSV: a row for each pose with its status and what is left.
std::string corrected_commands_csv(const CorrectedCommands& result);

/// For people; complete lines.
std::string corrected_commands_text(const CorrectedCommands& result);

/// For programs; units in the keys. @param output  name of the file of the commands
nlohmann::ordered_json corrected_commands_json(const CorrectedCommands& result, const std::string& output,
                                               bool written);

}  // namespace abbe
