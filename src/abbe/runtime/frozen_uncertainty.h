#pragma once

#include <array>
#include <cstddef>

#include "abbe/runtime/abbe_runtime.h"

namespace abbe {

inline constexpr double kWholeTurn = 6.283185307179586476925286766559;  ///< rad

/// Standard uncertainty of the correction of the functional point, on a lattice over axes and tool lengths.
struct FrozenUncertainty {
  static constexpr std::size_t kMostDimensions = 8;
  static constexpr std::size_t kMostNodes = 131072;  ///< of all dimensions together

  /// Nodes evenly spaced from `from` to `to`.
  struct Dimension {
    std::size_t axis = 0;      ///< of the machine; kToolLength: none
    std::size_t nodes = 2;     ///< two or more
    double from = 0, to = 0;   ///< mm or rad
    bool is_periodic = false;  ///< endless axes: one turn
  };
  static constexpr std::size_t kToolLength = ABBE_RUNTIME_AXES;

  std::size_t dimensions = 0;  ///< 0: the errors had no uncertainties
  std::array<Dimension, kMostDimensions> dimension;
  const double* value = nullptr;  ///< mm; the last dimension is the fastest

  /// Linear between the nodes; beyond the ends as at the end.
  /// @param joints  [axes] mm, rad; finite and not beyond 1e6
  /// @returns mm
  double at(const double* joints, double tool_length) const noexcept;
};

}  // namespace abbe
