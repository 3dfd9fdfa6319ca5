#pragma once

#include <Eigen/Core>
#include <array>

#include "abbe/machine/machine.h"

namespace abbe {

/// How the linear axes of a laser engraver with a double swing head C1, A over a turntable C2 are arranged.
enum class LinkageConvention {
  table_moves,  ///< U: X and Y carry the table, Z the head, focus below the head: text, (12), Tables 2 and 3
  head_moves    ///< P: X, Y, Z carry the head and the focus lies R_A above the axis of A: (5) as printed
};

/// Linkage parameters of such a machine, mm. Yin et al., Machines 9 (2021) 237, section 2.2.
///
/// With c = Rz(C1) and (i, j, k) = c (0, -sin A, cos A) from the focus to the source:
///
///     U  p = c [R_C1; L_AC1 + L_tA cos A + R_A sin A; L_tA sin A - R_A cos A] + (x0 - X, y0 - Y, Z - z0)
///     P  p = c [R_C1; L_AC1 + L_tA cos A - R_A sin A; L_tA sin A + R_A cos A] + (X + x0, Y + y0, Z + z0)
struct SwingHeadLinkage {
  double focus_to_a = 0;                             ///< R_A: from the axis of A to the focus, along the beam
  double a_to_c1 = 0;                                ///< R_C1: from the axis of C1 along the axis of A
  double beam_offset = 0;                            ///< L_tA: of the beam beside the axis of A
  double a_offset = 0;                               ///< L_AC1: of the axis of A beside that of C1
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< x0, y0, z0

  static constexpr std::size_t kCount = 7;
  /// R_A, R_C1, L_tA, L_AC1, x0, y0, z0.
  std::array<double, kCount> values() const;
  static SwingHeadLinkage of(const std::array<double, kCount>& values);
};

/// "R_A", "R_C1", "L_tA", "L_AC1", "x0", "y0", "z0".
const char* linkage_name(std::size_t index);

/// Axis commands of the five linkage axes, mm and rad.
struct SwingHeadCommand {
  double x = 0, y = 0, z = 0, a = 0, c1 = 0;
};

/// Focus in the frame of the table C2 at C2 = 0, mm.
Eigen::Vector3d swing_head_focus(const SwingHeadLinkage& linkage, LinkageConvention convention,
                                 const SwingHeadCommand& command);
/// Unit vector from the focus to the source in U, along the beam's Z+ in P; same frame.
Eigen::Vector3d swing_head_beam(const SwingHeadCommand& command);

/// Commands that bring the focus to a point with the beam along a direction.
///
/// Two answers exist: A = +atan2(hypot(i, j), k) with C1 = atan2(i, -j), and A < 0 with C1 = atan2(-i, j). With the
/// beam along Z, C1 is free.
/// @param point, beam  frame of the table C2 at C2 = 0, mm; the beam as swing_head_beam() has it, of any length
/// @param sign         +1 or -1: of A
/// @param held_c1      taken where C1 is free, rad
SwingHeadCommand swing_head_command(const SwingHeadLinkage& linkage, LinkageConvention convention,
                                    const Eigen::Vector3d& point, const Eigen::Vector3d& beam, int sign = 1,
                                    double held_c1 = 0);

/// Puts the parameters into a machine with axes named C1 and A and the tool along Z.
/// @throws std::invalid_argument if the machine has no axis C1 or A
void set_linkage(Machine& machine, const SwingHeadLinkage& linkage, LinkageConvention convention);
/// The parameters of such a machine. @throws std::invalid_argument as set_linkage()
SwingHeadLinkage linkage_of(const Machine& machine, LinkageConvention convention);

}  // namespace abbe
