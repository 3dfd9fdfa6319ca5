#pragma once

#include <string>
#include <string_view>

#include "abbe/compensate/tables/skew_factors.h"

namespace abbe {

/// Klipper: "SET_SKEW XY=AC,BD,AD XZ=... YZ=...", the diagonals and the side of a parallelogram whose other side is
/// as long, in mm with 6 decimals. Klipper takes from them
///     side = sqrt(2 AC^2 + 2 BD^2 - 4 AD^2) / 2,  factor = tan(pi/2 - acos((AC^2 - side^2 - AD^2) / (2 side AD)))
/// The factors come back to 2e-8. Source: Klipper documentation, "Skew correction".
std::string klipper_skew_text(const SkewFactors& factors);
/// Lines that begin with # are comments; planes that are not given are 0. @throws InputError
SkewFactors parse_klipper_skew(std::string_view text, const std::string& file);

/// Marlin: "M852 I<xy> J<xz> K<yz>" with 9 decimals, and M500 that stores them.
/// Source: Marlin documentation, M852 bed skew compensation.
std::string marlin_skew_text(const SkewFactors& factors);
/// ";" begins a comment; S is the same as I. @throws InputError
SkewFactors parse_marlin_skew(std::string_view text, const std::string& file);

}  // namespace abbe
