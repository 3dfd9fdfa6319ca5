#pragma once

// Where the tool of a mill with errors really is:
//
//   #include <abbe/errors/actual_pose.h>
//   #include <abbe/machine/chain.h>
//
//   #include <cstdio>
//
//   int main() {
//     const abbe::Machine mill = abbe::parse_chain("w X' Y' b Z t").machine;
//     abbe::ErrorSet errors;
//     // EC0Y, squareness of Y to X: 20 um/m. EAX, roll of X: 0 at X -250 mm, growing to 50 urad at X 250 mm.
//     errors.locations.push_back({.axis = mill.find_axis("Y"), .component = abbe::Component::C, .value = 20e-6});
//     abbe::ErrorMotion roll;
//     roll.axis = mill.find_axis("X");
//     roll.component = abbe::Component::A;
//     roll.basis = {.kind = abbe::BasisKind::legendre, .order = 1, .from = -250, .to = 250};  // mm
//     roll.coefficients = {25e-6, 25e-6};                                                     // rad
//     errors.motions.push_back(roll);
//
//     abbe::Deviation deviation;  // mm and rad, actual less nominal, in the frame of the workpiece
//     if (abbe::tool_deviation(mill, errors, {250, 200, 100}, deviation) != abbe::PoseStatus::ok) return 1;
//     std::printf("tool off by %.1f %.1f %.1f um\n", 1e3 * deviation[0], 1e3 * deviation[1], 1e3 * deviation[2]);
//     std::printf("and turned by %.0f %.0f %.0f urad\n", 1e6 * deviation[3], 1e6 * deviation[4], 1e6 * deviation[5]);
//     return 0;
//   }
//
// It prints:
//
//   tool off by -4.0 5.0 -10.0 um
//   and turned by -50 0 0 urad
//
// errors holds what is wrong with a machine, and what it does to the tool:
//   error_set.h, basis.h                error motions, location errors, reversal values and their names
//   poses.h                             many poses: lists, grids, sources
//   pose_model.h, chain_plan.h          actual poses and derivatives of millions of poses
//   reversal.h, calibrated_machine.h    lost motion; a machine with its constant errors put into its geometry
//   random_errors.h                     errors for simulations, of a size that is asked for

#include <Eigen/Core>
#include <span>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

enum class PoseStatus { not_run, ok, out_of_range };

/// Displacement of the body carried by one axis, with its error motions and location errors, exact.
///
/// iso, linear: Trans(reference + s q u') E(q) Trans(-reference); rotary: Trans(centre) E(q) Rot' Trans(-centre), where
/// the prime marks the axis line displaced by the location errors. Source: docs/conventions.md.
/// @param position  of the axis: its command where it is not coupled
/// @param factors  [states] (state_factors()); where they are not given, what errors with a state move is NaN
RigidTransform actual_motion(const Machine& machine, const ErrorSet& errors, std::size_t axis, double position,
                             std::span<const double> factors = {});

/// workpiece_from_tool with errors, at the functional point (tool frame parallel to the machine's with all axes at
/// zero).
/// @param commands  in chain order, [axes], mm or rad
/// @param given     as state_factor() takes it; NaN results where errors have an input state that is not given
RigidTransform actual_workpiece_from_tool(const Machine& machine, const ErrorSet& errors,
                                          const std::vector<double>& commands, std::span<const double> given = {});
RigidTransform actual_bed_from_tool(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
                                    std::span<const double> given = {});
RigidTransform actual_bed_from_workpiece(const Machine& machine, const ErrorSet& errors,
                                         const std::vector<double>& commands, std::span<const double> given = {});

/// Six numbers: translation of the functional point (mm), rotation vector (rad).
using Deviation = Eigen::Matrix<double, 6, 1>;

/// Deviation of the tool pose in the workpiece frame: actual minus nominal.
///
/// @param commands       in chain order, [axes], mm or rad
/// @param deviation      translation of the functional point (mm), then rotation vector of R_actual R_nominal^T (rad)
/// @param by_parameters  if not null: d(deviation)/d(ErrorSet::parameters()), becomes [6, parameter_count]; its
/// rotation
///                       rows are the instantaneous rotation (the twist), equal to the derivative of the rotation
///                       vector to first order in the deviation
/// @param by_commands    if not null: twist of the actual pose per axis command, becomes [6, axes]; states that depend
///                       on the commands are differentiated too
/// @param given          as state_factor() takes it
/// @returns out_of_range if a position of an axis lies outside the range of an error motion or an input state of the
/// errors is not
///          given; the deviation is then an extrapolation, or NaN, and must not be used as a result
/// Source: ISO 230-1:2012, 3.4; composition order in docs/conventions.md.
PoseStatus tool_deviation(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
                          Deviation& deviation, Eigen::MatrixXd* by_parameters = nullptr,
                          Eigen::MatrixXd* by_commands = nullptr, std::span<const double> given = {});

}  // namespace abbe
