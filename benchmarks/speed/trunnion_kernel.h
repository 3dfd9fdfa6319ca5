#pragma once

#include <array>

#include "five_axis_case.h"

namespace abbe::benchmarks {

/// What a kernel written by hand for the one machine of FiveAxisCase needs; it shows what the generality of ChainPlan
/// costs.
///
/// Known at compile time: order and kind of the axes, degrees and harmonics, angles that suit short series, no zero
/// position errors, linear axes' reference at the origin. The moved point and columns do not leave the
/// registers on their way through the axes.
struct TrunnionNumbers {
  explicit TrunnionNumbers(const FiveAxisCase& five_axis);
  double legendre[3][6][5];  ///< X Y Z: power series in q / 300 mm
  double fourier[2][6][9];   ///< C A: powers of the cosine, [5] alone and [4] times the sine
  double direction[5][3];    ///< C A X Y Z, displaced
  double products[2][6];     ///< xx yy zz xy xz yz of the directions of C A
  double centre[2][3];       ///< displaced
  double reference[2][3];
  double tool_reference[3], workpiece[3];
};

/// Points and rotations like ChainPlan::transform from tool to workpiece; count a multiple of 128.
/// @param seen  [12] x, y, z of the point, then the rotation, row-major
void transform_trunnion(const TrunnionNumbers& numbers, const double* const* commands, const double* const* start,
                        double* const* seen, std::size_t count);

}  // namespace abbe::benchmarks
