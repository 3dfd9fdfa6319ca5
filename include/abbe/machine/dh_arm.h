#pragma once

#include <span>
#include <string>
#include <vector>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Where the angle and the offset of a row of a Denavit-Hartenberg table stand.
enum class DhConvention {
  standard,  ///< Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha): joint i about z of frame i - 1
  modified   ///< Rot_x(alpha) Trans_x(a) Rot_z(theta) Trans_z(d): joint i about z of frame i; a, alpha before it
};

/// One row of the table; mm and rad. A rotary joint turns by theta + position, a linear one moves by d + position; the
/// position counts with its sign reversed if `reversed`. It is the command, plus what DhArm::couplings add to it.
struct DhJoint {
  std::string name;  ///< of the axis, as in a chain: "A1"
  AxisKind kind = AxisKind::rotary;
  double a = 0, alpha = 0, d = 0, theta = 0;
  bool reversed = false;
  double travel_min = 0, travel_max = 0;  ///< of the command
  bool endless = false;
};

/// A serial arm by its table.
/// Sources: J. Denavit, R. Hartenberg (1955), J. Applied Mechanics 22, 215 (standard); J. Craig (1986), Introduction to
/// Robotics, 3.5 (modified).
struct DhArm {
  std::string name, description;
  DhConvention convention = DhConvention::standard;
  std::vector<DhJoint> joints;
  std::vector<AxisCoupling> couplings{};  ///< indices into `joints`
  RigidTransform workpiece_from_base;     ///< frame 0 of the table in the workpiece frame
  RigidTransform last_from_tool;          ///< frame of the tool in the last frame of the table
};

/// workpiece_from_tool: the product of the matrices of all rows. @param commands  [joints], mm or rad
RigidTransform dh_pose(const DhArm& arm, std::span<const double> commands);

/// The machine with the same workpiece_from_tool at all commands, to rounding.
///
/// The tool frame of a machine is parallel to its machine frame with all axes at zero. So the machine frame is the
/// workpiece frame turned until it is parallel to the frame of the tool of the arm there; the origin is the same. The
/// tool direction is -z of that frame. The machine is not checked (find_problems()).
Machine machine_from_dh(const DhArm& arm);

}  // namespace abbe
