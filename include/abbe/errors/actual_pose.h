#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

enum class PoseStatus { not_run, ok, out_of_range };

/// Displacement of the body carried by one axis, with its error motions and location errors, exact.
///
/// iso, linear: Trans(reference + s q u') E(q) Trans(-reference); rotary: Trans(centre) E(q) Rot' Trans(-centre), where
/// the prime marks the axis line displaced by the location errors. Source: docs/conventions.md.
RigidTransform actual_motion(const Machine& machine, const ErrorSet& errors, std::size_t axis, double position);

/// workpiece_from_tool with errors, at the functional point (tool frame parallel to the machine's with all axes at
/// zero).
/// @param positions  commands in chain order, [axes], mm or rad
RigidTransform actual_workpiece_from_tool(const Machine& machine, const ErrorSet& errors,
                                          const std::vector<double>& positions);
RigidTransform actual_bed_from_tool(const Machine& machine, const ErrorSet& errors,
                                    const std::vector<double>& positions);
RigidTransform actual_bed_from_workpiece(const Machine& machine, const ErrorSet& errors,
                                         const std::vector<double>& positions);

/// Six numbers: translation of the functional point (mm), rotation vector (rad).
using Deviation = Eigen::Matrix<double, 6, 1>;

/// Deviation of the tool pose in the workpiece frame: actual minus nominal.
///
/// @param positions      commands in chain order, [axes], mm or rad
/// @param deviation      translation of the functional point (mm), then rotation vector of R_actual R_nominal^T (rad)
/// @param by_parameters  if not null: d(deviation)/d(ErrorSet::parameters()), becomes [6, parameter_count]; its
/// rotation
///                       rows are the instantaneous rotation (the twist), equal to the derivative of the rotation
///                       vector to first order in the deviation
/// @param by_positions   if not null: twist of the actual pose per axis command, becomes [6, axes]
/// @returns out_of_range if a position lies outside the range of an error motion; the deviation is then an
///          extrapolation and must not be used as a result
/// Source: ISO 230-1:2012, 3.4; composition order in docs/conventions.md.
PoseStatus tool_deviation(const Machine& machine, const ErrorSet& errors, const std::vector<double>& positions,
                          Deviation& deviation, Eigen::MatrixXd* by_parameters = nullptr,
                          Eigen::MatrixXd* by_positions = nullptr);

}  // namespace abbe
