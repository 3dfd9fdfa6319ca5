#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "abbe/compensate/program/command_correction.h"
#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// Deviation of the tool at poses, actual minus nominal: length of the shift of the functional point (mm), angle
/// between the directions of the tool (rad); a turn about the tool's own direction does not count.
struct PoseDeviations {
  std::vector<double> position;
  std::vector<double> orientation;
  SampleStatistics position_statistics;
  SampleStatistics orientation_statistics;
};

/// The machine with errors, driven by a control that adds a correction to its commands: actual pose at the corrected
/// commands against the nominal pose at the commands. Where axes have reversal values, the largest over all directions
/// in which they can have come (beyond six such axes: all forward and all backward).
PoseDeviations deviations_with(const Machine& machine, const ErrorSet& errors, const PoseList& commands,
                               const CommandCorrection& correction);

/// Volumetric error with a correction added to the commands: displacement of the functional point after the best fit of
/// the workpiece datum over all poses, mean of both directions of approach (docs/conventions.md), mm.
SampleStatistics volumetric_error_with(const Machine& machine, const ErrorSet& errors, const PoseList& commands,
                                       const CommandCorrection& correction);

/// The same as deviations_with() with the best that the axes can do (CompensatedInverse: point, and direction where
/// rotary axes work for it), travel limits apart (with_room_beyond_travel).
/// @param not_reached  number of poses where the point is not reached; their deviation is as it then is
PoseDeviations ideal_deviations(const Machine& machine, const ErrorSet& errors, const PoseList& commands,
                                std::size_t& not_reached);

/// One error of the machine by its name, and how much of what it does a control's tables take away.
struct CarriedError {
  std::string name;          ///< "EXX", "EC0Y", "reversal_X", "tool_X"
  bool is_angle = false;     ///< of `size`
  double size = 0;           ///< largest value over the axis's known travel, mm or rad
  double effect_before = 0;  ///< root mean square shift of the functional point by this error alone, mm
  double effect_after = 0;   ///< the same with tables made for this error alone, mm
  double turn_before = 0;    ///< root mean square angle of the tool's direction by this error alone, rad
  double turn_after = 0;     ///< rad

  /// Share of the shift that is taken away; 0 for an error that moves no point. May be negative: the tables make it
  /// worse.
  double carried() const { return effect_before > 0 ? 1 - effect_after / effect_before : 0; }
};

/// Makes the correction that a control would apply with tables for a set of errors.
using CorrectionMaker = std::function<std::unique_ptr<CommandCorrection>(const ErrorSet& errors)>;

/// Every error of the set alone, before and after tables made for it alone. To first order the errors add up, and so do
/// the tables: what a format carries of one error does not depend on the others.
std::vector<CarriedError> carried_errors(const Machine& machine, const ErrorSet& errors, const PoseList& commands,
                                         const CorrectionMaker& make);

/// Every error motion, location error and reversal value by name with a set that contains it alone (all terms of one
/// motion together).
struct NamedErrors {
  std::string name;
  bool is_angle = false;
  double size = 0;  ///< largest value over the known travel, mm or rad
  ErrorSet errors;
};
std::vector<NamedErrors> errors_one_by_one(const Machine& machine, const ErrorSet& errors);

}  // namespace abbe
