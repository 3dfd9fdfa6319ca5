#pragma once

// Machine and errors as one file that a controller uses in real time, as `abbe compensate freeze` makes it:
//
//   #include <abbe/formats/files/results_folder.h>
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/study/compensation/frozen_errors.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::FreezeRequest request;
//     request.machine = abbe::read_machine("examples/machines/three-axis-mill.machine.toml");
//     request.errors_file = "examples/compensate/mill.errors.toml";
//     request.errors = abbe::read_errors(request.errors_file, request.machine);
//     request.limit_um = 500;
//     const abbe::FrozenErrors result = abbe::freeze_errors(request);
//     if (!result.refused.empty()) return 1;
//     abbe::write_file_atomically("frozen.abbec", result.bytes());
//     std::printf("largest correction %.1f um, standard uncertainty %.2f um on average\n",
//                 1e3 * result.frozen.largest_correction, 1e3 * result.frozen.mean_uncertainty);
//     return 0;  // frozen_errors_text() says more
//   }
//
// It prints:
//
//   largest correction 65.0 um, standard uncertainty 1.10 um on average
//
// What the file is for and what the figures mean: docs/runtime.md.

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/left_out_errors.h"
#include "abbe/errors/error_set.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machine.h"
#include "abbe/runtime/freeze.h"

namespace abbe {

/// Errors that are to be frozen; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe compensate freeze` that sets it, given below.
struct FreezeRequest {
  Machine machine;
  ErrorsFile errors;        ///< without covariance: its standard uncertainties, as if independent
  std::string errors_file;  ///< name for messages

  std::optional<Eigen::Vector3d> tool;  ///< --tool-mm: default tool; without it that of the machine
  double tool_length_min = 0;           ///< --tool-length-mm: tools that are tried
  double tool_length_max = 300;
  double largest_turn = 0.57 * kDegree;  ///< --largest-turn-deg: of all rotary axes together; at most 10 degrees
  bool world_zero_at_joints = true;      ///< --world: as FreezeOptions
  double leave_out_factor = 0;           ///< --leave-out-below-uncertainty: 0 to 1000; 0: none is left out
  /// --state-range: "NAME_unit=FROM:TO" of measured states; others: what the readings covered (ErrorsFile::covered)
  std::vector<std::string> state_ranges;
  std::optional<double> limit_um;  ///< --limit-um: larger corrections of the tool are refused; above zero
};

/// Frozen errors, and the results of their test. They hold no reference to the request.
struct FrozenErrors {
  Machine machine;
  std::string errors_file;
  double tool_length_min = 0, tool_length_max = 0, leave_out_factor = 0;  ///< as in the request
  StateValues at_state{};                                                 ///< at which the errors are taken
  ErrorSet errors;                                                        ///< those that are frozen
  FrozenCompensation frozen;
  LeftOutErrors left_out;
  std::string refused;  ///< why the file must not be used, in words; empty: it may

  /// Contents of the file (*.abbec).
  std::string_view bytes() const { return {reinterpret_cast<const char*>(frozen.bytes.data()), frozen.bytes.size()}; }
};

/// Freezes errors and tries the result against the full model at poses all over the travel. Opens no file and prints
/// nothing. Errors that are marked as not to be trusted (ErrorsFile::distrusted) are frozen like others.
/// @throws InputError for errors that cannot be frozen on this machine, and for what is out of range in the request
FrozenErrors freeze_errors(const FreezeRequest& request);

/// What happened to the file, for the texts.
struct FrozenOutput {
  std::string file = {};
  bool written = true;
  bool dry_run = false;  ///< not written because that was not wanted
};

/// For people: what was found, and the lines of LinuxCNC for lost motion; complete lines.
std::string frozen_errors_text(const FrozenErrors& frozen, const FrozenOutput& file);

/// For programs; units in the keys.
nlohmann::ordered_json frozen_errors_json(const FrozenErrors& frozen, const FrozenOutput& file);

}  // namespace abbe
