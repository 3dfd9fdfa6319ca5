#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/tables/correction_lattice.h"
#include "abbe/formats/controls/table_axis_names.h"

namespace abbe {

/// Three-dimensional error compensation: corrections of three linear axes over an evenly spaced grid of their machine
/// positions, in whole numbers of a unit.
struct FanucLattice {
  std::array<std::size_t, 3> axes{};             ///< compensation axes, of the machine
  std::array<std::size_t, 3> points{};           ///< along each
  std::array<std::size_t, 3> reference_point{};  ///< number, from 1, of the point at the reference position
  std::array<int, 3> magnification{1, 1, 1};
  std::array<double, 3> interval{};  ///< between points, mm
  /// [axes][points in all] correction in magnification * unit, the first axis fastest.
  std::array<std::vector<int>, 3> values;
  bool operator==(const FanucLattice&) const = default;

  std::size_t count() const { return points[0] * points[1] * points[2]; }
};

inline constexpr std::size_t kFanucLatticePoints = 25;  ///< along one axis
inline constexpr int kFanucLatticeLargest = 127;        ///< of a value; the magnification is raised instead
inline constexpr int kFanucLatticeMagnification = 100;

/// Rounds a lattice to whole numbers, with the smallest magnification that they fit into; it may be above
/// kFanucLatticeMagnification.
/// @param lattice  three evenly spaced inputs; outputs among them; others are not corrected
/// @param unit     detection unit, mm
/// @param anchor   [3] index of the node at the reference position
FanucLattice fanuc_lattice(const CorrectionLattice& lattice, double unit, const std::array<std::size_t, 3>& anchor);
/// What the control then adds, linear in every position between the points.
/// @param reference  [3] machine positions of the reference positions, mm
CorrectionLattice fanuc_lattice_corrections(const FanucLattice& lattice, double unit,
                                            const std::array<double, 3>& reference);

/// Parameters of the grid as a parameter file, "N10803P21" between "%": 10800 to 10802 numbers of the compensation
/// axes, 10803 to 10805 points, 10806 to 10808 point at the reference position, 10809 to 10811 magnification, 10812 to
/// 10814 interval (mm).
/// Source: FANUC Series 15i/150i-MODEL A Parameter Manual B-63330EN/03, "Inputting and outputting parameters", for the
/// form of the blocks. The numbers are not verified.
/// @param axes  named by their numbers: "1", "2"
std::string fanuc_lattice_parameter_text(const FanucLattice& lattice, const std::vector<TableAxisName>& axes);
/// Values of the points in blocks of the same form, "N00001A1P3A2P-2A3P0": number of the point from 1, the first axis
/// fastest, then number and value of every compensation axis. The form is not verified: FANUC's is not public.
std::string fanuc_lattice_point_text(const FanucLattice& lattice, const std::vector<TableAxisName>& axes);

/// @throws InputError also where parameters or points are missing
FanucLattice parse_fanuc_lattice(std::string_view parameters, const std::string& parameter_file,
                                 std::string_view points, const std::string& point_file,
                                 const std::vector<TableAxisName>& axes);

}  // namespace abbe
