#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "abbe/compensate/program/command_correction.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Angles between three linear axes as printers correct them (Marlin's planner, Klipper's skew_correction):
///     x' = x - y xy - z (xz - xy yz),   y' = y - z yz,   z' = z
/// with commanded positions and corrected ones x', y', z'.
struct SkewFactors {
  double xy = 0;  ///< tangent of an angle
  double xz = 0;
  double yz = 0;
  bool operator==(const SkewFactors&) const = default;
};

class SkewCorrection final : public CommandCorrection {
 public:
  /// @param axes  which axes are X, Y, Z
  SkewCorrection(const SkewFactors& factors, const std::array<std::size_t, 3>& axes) : factors_(factors), axes_(axes) {}
  void evaluate(const PoseList& commands, PoseList& correction) const override;

 private:
  SkewFactors factors_;
  std::array<std::size_t, 3> axes_;
};

/// Factors that fit the exact corrections of X and Y (PointCorrection) over a grid of the known travel best, by least
/// squares with a free constant: the slopes of the corrections over the other axes' positions.
/// @param axes       which axes are X, Y, Z
/// @param reference  [axes] where all others stand; mm or rad
SkewFactors fit_skew(const Machine& machine, const ErrorSet& errors, const std::array<std::size_t, 3>& axes,
                     const std::vector<double>& reference);

}  // namespace abbe
