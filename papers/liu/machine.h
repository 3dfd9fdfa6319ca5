#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// The scanner of the examples. @throws InputError if its file is not found
Machine liu_machine();

/// Reading of Table 3, whose unit of the shifts is doubtful.
enum class LiuUnit { millimetre, micrometre };
const char* liu_unit_name(LiuUnit unit);  ///< "mm" or "um"

/// Location errors of the stages, Table 3: A through (dx, dy, dz) along (1, tan d1, tan d2), C along (tan d1, 1, tan
/// d2). The shift along the axis itself brings the tilted line to where it crosses the plane through the origin.
/// @param angles, shifts  factors, 1: as in the table
ErrorSet liu_errors(const Machine& machine, LiuUnit unit, double angles = 1, double shifts = 1);
/// The eight location errors with value zero, in the order of liu_errors().
ErrorSet liu_unknowns(const Machine& machine);

/// Clamping errors of Table 3: tilts about x and z in degrees, shifts along x and z in the doubtful unit.
inline constexpr std::array<double, 4> kLiuTable3Clamping = {-5.6936, 2.2561, 0.0651, -0.2498};
/// workpiece_from_part with them.
RigidTransform liu_clamping(LiuUnit unit);

/// Points that the probe on Z indicates, [3, positions] mm, workpiece frame, as a machine with these errors sees them.
/// @param indication  mm
Eigen::Matrix3Xd liu_points(const Machine& machine, const ErrorSet& errors, const PoseList& positions,
                            const std::vector<double>& indication);

/// Positions, indications and points of the reference file, [rows].
struct LiuReference {
  PoseList positions;
  std::vector<double> indication;                    ///< mm
  Eigen::Matrix3Xd nominal, millimetre, micrometre;  ///< [3, rows] mm
};
LiuReference read_liu_reference(const Machine& machine);

/// The recursion of equations (8) and (9), from point to point. Both forms begin at the home position and turn the
/// probe by the increments about the axes, against their sense.
///
/// as_worded: R_A R_C; "rotations around the C axis change the directions of linear motions", those about A also "the
/// vector of the C axis". corrected: R_C R_A, A about where C has brought it, C standing still in the workpiece.
enum class LiuRecursion { as_worded, corrected };
/// @returns [3, rows] mm
Eigen::Matrix3Xd liu_recursion(const Machine& machine, const ErrorSet& errors, const PoseList& positions,
                               const std::vector<double>& indication, LiuRecursion form);

}  // namespace abbe
