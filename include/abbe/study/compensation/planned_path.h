#pragma once

// A curve on the workpiece as commands of a calibrated machine, as `abbe path` plans them:
//
//   #include <abbe/formats/files/results_folder.h>
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/formats/shapes/curve_file.h>
//   #include <abbe/study/compensation/planned_path.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::PathRequest request;
//     request.machine = abbe::read_machine("examples/machines/yin-engraver-u.machine.toml");
//     request.curve_file = "examples/laser_engraver/table-a4.csv";
//     request.curve = abbe::read_curve(request.curve_file, request.machine);
//     request.placement = abbe::read_placement("examples/laser_engraver/part.placement.toml");
//     const abbe::PlannedPath planned = abbe::plan_path(request);
//     if (!planned.refused.empty()) return 1;
//     abbe::write_file_atomically("program.ngc", abbe::planned_path_file(planned, "program.ngc"));
//     std::printf("%zu moves, %.3f mm at work\n", planned.commands.size(), planned.path.working_length);
//     return 0;  // planned_path_text() says more
//   }
//
// It prints:
//
//   30 moves, 115.191 mm at work
//
// Formats and method: docs/tool-path.md.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/placement_file.h"
#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"
#include "abbe/machine/tool_path.h"
#include "abbe/machine/tool_path_miss.h"

namespace abbe {

/// A curve that a tool is to follow; lengths in mm, angles in rad, speeds in mm/s.
///
/// Messages name a field by the option of `abbe path` that sets it, given below.
struct PathRequest {
  Machine machine;                         ///< nominal
  std::optional<ErrorsFile> errors;        ///< --errors: states follow from the commands or the motions
  std::optional<PlacementFile> placement;  ///< --placement: where the workpiece is clamped
  Curve curve;
  std::string curve_file, errors_file, placement_file;  ///< names for messages

  double feed = 0;              ///< --feed-mm-per-min: where the curve has none; 0: none
  std::vector<HeldAxis> held;   ///< --hold: axes kept at a command
  std::vector<HeldAxis> start;  ///< --start: where axes stand before the path; others may stand anywhere
  double retract = 0;           ///< --retract-mm: before and after each region; 0: none
  double tolerance = 0;         ///< --tolerance-um: of the tool from the lines between the points; 0: no poses inserted
};

/// Commands that follow the curve, or the reason why there are none. They hold no reference to the request.
struct PlannedPath {
  Machine machine;  ///< calibrated, with the workpiece in place
  std::string curve_file, placement_file;
  StateValues at_state{};                   ///< at which the errors are taken
  std::vector<std::string> errors_along{};  ///< names of errors that change along the path, corrected at every pose
  std::vector<std::string> warnings;        ///< of the placement
  ToolPath path;
  std::vector<std::vector<double>> commands;  ///< [steps][axes] as the control is to have them, mm or rad
  ToolPathMiss miss;                          ///< by which the tool misses the points of the curve
  std::string refused;                        ///< why there is no path, or why it must not be used; empty: it may

  /// Whether there is a path, be it one on which axes jump while the tool works.
  bool has_path() const {
    return path.status == ToolPathStatus::followed || path.status == ToolPathStatus::jumps_while_working;
  }
};

/// Axis commands that bring the tool of the calibrated machine along the curve. Opens no file and prints nothing.
///
/// Constant errors are put into the geometry of the machine, for which the path is planned. The commands of this path
/// are then corrected for errors that change along it, pose by pose.
/// @throws InputError for errors with states that have to be given, a working move without feed, a held axis that the
///   curve sets, regions without retract distance, and a start that leaves the path undecided
PlannedPath plan_path(const PathRequest& request);

/// Contents of a file of a path, by the extension of its name: a program (.ngc, .nc, .tap, .mpf) or .csv.
/// @param options  of a program; a comment says what it is a path of
/// @throws InputError for another extension
std::string planned_path_file(const PlannedPath& planned, const std::string& name, PathProgramOptions options = {});

/// For people: moves, times, what the path misses, ranges of the axes; complete lines.
std::string planned_path_text(const PlannedPath& planned);

/// For programs; units in the keys.
nlohmann::ordered_json planned_path_json(const PlannedPath& planned);

/// The page that plays the path.
/// @param part       workpiece on which it is shown; null: none
/// @param part_file  its name
std::string planned_path_page(const PlannedPath& planned, const MeshFile* part = nullptr,
                              const std::string& part_file = "");

}  // namespace abbe
