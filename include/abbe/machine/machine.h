#pragma once

// Commands of a five-axis mill for a tilted tool, both ways:
//
//   #include <abbe/geometry/angle_units.h>
//   #include <abbe/machine/chain.h>
//   #include <abbe/machine/inverse_kinematics.h>
//   #include <abbe/machine/machine.h>
//
//   #include <cmath>
//   #include <cstdio>
//
//   int main() {
//     abbe::Machine mill = abbe::parse_chain("w C' A' Y' b X Z t").machine;  // table C on cradle A; travels by default
//     mill.axes[mill.find_axis("A")].point = {0, 0, -50};                    // mm, A turns 50 mm below the table
//     const abbe::InverseKinematics inverse(mill);
//     const auto target = abbe::PoseTarget::at({60, 0, 20}, {0, 0.5, std::sqrt(0.75)});  // mm; tool tilted by 30 deg
//     const abbe::InverseResult result = inverse.solve(target);
//     for (const abbe::InverseSolution& found : result.solutions) {
//       const auto& q = found.position;  // in the order of the chain, rad and mm
//       std::printf("C %.0f A %.0f deg, Y %.3f X %.3f Z %.3f mm\n", q[0] / abbe::kDegree, q[1] / abbe::kDegree, q[2],
//                   q[3], q[4]);
//     }
//     const std::vector<double> zero(mill.axes.size(), 0.0);
//     const Eigen::Vector3d tool = abbe::nominal_workpiece_from_tool(mill, zero).translation;
//     std::printf("all axes at zero: tool at %.0f %.0f %.0f mm\n", tool.x(), tool.y(), tool.z());
//     return result.status == abbe::InverseStatus::solved ? 0 : 1;
//   }
//
// It prints:
//
//   C 0 A -30 deg, Y -35.000 X 60.000 Z 10.622 mm
//   C 180 A 30 deg, Y 35.000 X -60.000 Z 10.622 mm
//   all axes at zero: tool at 0 0 0 mm
//
// machine holds machines without errors:
//   chain.h, machine_check.h            a machine from "w C' A' Y' b X Z t"; what makes one unusable
//   inverse_kinematics.h                all commands for a pose, singular poses, unreachable ones
//   path.h, tool_path.h                 commands along a path; curves that a beam follows on a workpiece
//   placement.h, test_piece.h           where a workpiece stands; cone frustum and S shape
//   state.h                             what errors depend on besides commands: temperatures, loads, gravity
//   coupling.h                          positions of axes whose commands are coupled

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/machine/state.h"

namespace abbe {

enum class AxisKind { linear, rotary };

/// No machine has more axes than this: room for working arrays without allocation.
inline constexpr std::size_t kMaxAxes = 16;

/// Which side of the bed an axis carries.
enum class ChainSide { workpiece, tool };

/// One axis of a serial chain, described in the machine frame with every axis at its zero.
struct Axis {
  std::string name;  ///< ISO 841 letter and optional number: "X", "C", "C2"
  AxisKind kind = AxisKind::linear;
  ChainSide side = ChainSide::tool;
  bool primed = false;                                   ///< positive command moves what it carries the other way
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit vector of positive motion of an unprimed axis
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< mm; rotary: a point on the axis; linear: reference point
  double travel_min = 0;                                 ///< mm or rad
  double travel_max = 0;                                 ///< mm or rad
  bool endless = false;                                  ///< rotary without travel limits
  bool setting = false;                                  ///< positioned beforehand and not interpolated with the others

  /// +1, or -1 for a primed axis: displacement of the carried body = sense() * command.
  double sense() const { return primed ? -1.0 : 1.0; }
};

/// The position of an axis contains the command of another one: parallelograms, belts through a joint, screws.
///
/// position of `axis` = its command + ratio times the command of `of`, over all couplings of the axis. Without any the
/// position is the command. Error motions, location errors and states are functions of positions, travels are limits of
/// commands. docs/kinematics.md.
struct AxisCoupling {
  std::size_t axis = 0;  ///< index into Machine::axes
  std::size_t of = 0;    ///< index into Machine::axes
  double ratio = 0;      ///< without unit for axes of one kind; mm per rad or rad per mm
  bool operator==(const AxisCoupling&) const = default;
};

/// A serial machine from the workpiece to the tool.
///
/// Machine frame: fixed to the bed, right-handed, axes X Y Z of ISO 841. All directions and points are given in it
/// with every axis at zero. The workpiece frame and the tool frame are parallel to it there (the workpiece frame may
/// be turned by `bed_from_workpiece`).
struct Machine {
  std::string name;
  std::string description;
  std::vector<Axis> axes;             ///< in chain order, workpiece to tool; workpiece-side axes come first
  RigidTransform bed_from_workpiece;  ///< workpiece frame with all axes at zero; mm
  Eigen::Vector3d tool_reference = Eigen::Vector3d::Zero();   ///< spindle gauge point with all axes at zero, mm
  Eigen::Vector3d tool_offset = Eigen::Vector3d::Zero();      ///< functional point from the gauge point, mm
  Eigen::Vector3d tool_direction = Eigen::Vector3d::UnitZ();  ///< unit, from the functional point to the spindle
  std::vector<MachineState> states{};                         ///< what errors depend on besides commands; may be empty
  Eigen::Vector3d gravity{0, 0, -9.80665};                    ///< m/s^2, machine frame; by default standard, along -Z
  std::vector<AxisCoupling> couplings{};                      ///< at most one of an axis to another; mostly none

  std::size_t workpiece_axis_count() const;

  /// Index of the axis of that name, or npos.
  std::size_t find_axis(std::string_view axis_name) const;
  static constexpr std::size_t npos = static_cast<std::size_t>(-1);

  /// The chain in words: "w C' X' b Z t".
  std::string chain() const;
};

/// Default kind of an axis from its ISO 841 letter: X Y Z U V W P Q R linear, A B C D E rotary.
/// @returns false for any other letter
bool axis_kind_from_letter(char letter, AxisKind& kind);

/// Default direction from the letter: X U P A D -> x, Y V Q B E -> y, Z W R C -> z.
Eigen::Vector3d direction_from_letter(char letter);

/// Displacement of the body carried by one axis without errors: bed-side frame from carried frame.
///
/// linear: Trans(sense q u); rotary: Trans(point) Rot(u, sense q) Trans(-point).
/// @param position  of the axis: its command where it has no coupling; mm or rad
RigidTransform nominal_motion(const Axis& axis, double position);

/// bed_from_tool without errors, at the functional point.
/// @param commands  in chain order, [axes.size()], mm or rad
RigidTransform nominal_bed_from_tool(const Machine& machine, const std::vector<double>& commands);

/// bed_from_workpiece without errors.
RigidTransform nominal_bed_from_workpiece(const Machine& machine, const std::vector<double>& commands);

/// workpiece_from_tool without errors: (workpiece-side axes, bed to workpiece)^-1 (tool-side axes, bed to tool) tool.
RigidTransform nominal_workpiece_from_tool(const Machine& machine, const std::vector<double>& commands);
RigidTransform nominal_workpiece_from_tool(const Machine& machine, std::span<const double> commands);

}  // namespace abbe
