#pragma once

// The map of an errors file, as `abbe map` makes it:
//
//   #include <abbe/formats/files/results_folder.h>
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/study/compensation/errors_map.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::ErrorsMapRequest request;
//     request.machine = abbe::read_machine("examples/machines/three-axis-mill.machine.toml");
//     request.errors = abbe::read_errors("examples/compensate/mill.errors.toml", request.machine);
//     const abbe::ErrorsMap map = abbe::map_errors(request);
//     const abbe::SampleStatistics& size = map.before.statistics;
//     std::printf("%zu poses: mean %.1f um, largest %.1f um\n", map.before.count(), 1e3 * size.mean,
//                 1e3 * size.maximum);
//     abbe::write_file_atomically("map.csv", abbe::map_csv(abbe::errors_map_data(map)));
//     return 0;
//   }
//
// It prints:
//
//   729 poses: mean 20.0 um, largest 46.5 um

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/map_file.h"
#include "abbe/machine/machine.h"
#include "abbe/report/evaluations/partial_errors.h"
#include "abbe/study/job_options.h"
#include "abbe/verify/error_map.h"
#include "abbe/verify/left_out_poses.h"
#include "abbe/verify/volumetric_figures.h"

namespace abbe {

/// Errors, and where they are mapped; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe map` that sets it, given below.
struct ErrorsMapRequest {
  Machine machine;
  ErrorsFile errors;
  std::optional<ErrorsFile> minus;  ///< --minus: errors that are corrected for
  /// --workpiece-...: one that is to be right at 20 degC and has the temperature stated here: its expansion is among
  /// the errors, and nothing of --minus corrects it.
  std::optional<WorkpieceExpansion> workpiece{};
  std::optional<StatedPoses> poses;  ///< --poses: instead of a grid
  /// --grid: [axes], or empty; what is not set runs over the range in which all errors are known.
  std::vector<std::optional<AxisRange>> grid;
  bool fit_datum = true;  ///< --keep-datum: false; displacements with the workpiece where it is
};

/// Volumetric error at poses, in the workpiece frame. It holds no reference to the request.
struct ErrorsMap {
  Machine machine;
  StatedPoses stated;
  ErrorMap before;                           ///< of the errors, with uncertainties where they are stated
  std::optional<ErrorMap> after;             ///< with `minus`: what is left after correction for these
  bool after_is_true = false;                ///< the errors are the truth of a simulation
  std::optional<VolumetricFigures> figures;  ///< with the datum fitted only: without, they are other quantities
  PartialErrors partial;                     ///< what the errors do not state
  std::optional<WorkpieceExpansion> workpiece{};

  LeftOutPoses left_out() const {
    return {.all = stated.poses.count(),
            .not_covered = before.statistics.excluded,
            .extrapolated = partial.at_state.outside};
  }
};

/// Maps errors over a grid or at given poses, before and after a correction. Opens no file and prints nothing.
/// @param options  progress: poses done of all, for every map, one call at a time but from any thread
/// @throws InputError for a grid of more than 20,000,000 poses; Stopped where that was asked for
ErrorsMap map_errors(const ErrorsMapRequest& request, const JobOptions& options = {});

/// As map files hold it.
MapData errors_map_data(const ErrorsMap& map);

/// For people: figures, in complete lines.
std::string errors_map_text(const ErrorsMap& map);

/// For programs; units in the keys.
nlohmann::ordered_json errors_map_json(const ErrorsMap& map);

}  // namespace abbe
