#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Options of a command about a workpiece that is not at 20 degC.
struct WorkpieceOptions {
  std::optional<double> expansion;    ///< --workpiece-expansion-um-per-m-K
  std::optional<double> u_expansion;  ///< --u-workpiece-expansion-um-per-m-K
  std::string state;                  ///< --workpiece-state: a state of the machine, its temperature
  std::optional<double> u_kelvin;     ///< --u-workpiece-temperature-K
  std::vector<double> fixed_mm;       ///< --workpiece-fixed-mm: three coordinates, or none
  bool any() const;
};

/// The expansion that options describe; nothing without them. Its temperature is a column of the poses, or the value of
/// --state, which is then put into the poses.
/// @param states  texts of --state
/// @throws InputError for options that miss each other, numbers out of range, and a temperature that is not given or
///   whose reference is not 20 degC
std::optional<WorkpieceExpansion> workpiece_option(const Machine& machine, const WorkpieceOptions& options,
                                                   const std::vector<std::string>& states, PoseList& poses);

}  // namespace abbe
