#include "abbe/runtime/frozen_uncertainty.h"

#include <cmath>

namespace abbe {
double FrozenUncertainty::at(const double* joints, double tool_length) const noexcept {
  std::array<std::size_t, kMostDimensions> stride, first;
  std::array<double, kMostDimensions> part;
  std::size_t step = 1;
  for (std::size_t k = dimensions; k-- > 0;) {
    const Dimension& d = dimension[k];
    double position = d.axis == kToolLength ? tool_length : joints[d.axis];
    if (d.is_periodic) position -= kWholeTurn * std::floor((position - d.from) / kWholeTurn);
    double at = (position - d.from) / (d.to - d.from) * static_cast<double>(d.nodes - 1);
    const double last = static_cast<double>(d.nodes - 1);
    if (!(at > 0)) at = 0;
    if (at > last) at = last;
    std::size_t cell = static_cast<std::size_t>(at);
    if (cell > d.nodes - 2) cell = d.nodes - 2;
    stride[k] = step;
    first[k] = cell;
    part[k] = at - static_cast<double>(cell);
    step *= d.nodes;
  }
  // The corners of the cell, folded along one dimension after the other.
  std::array<double, std::size_t{1} << kMostDimensions> corner;
  const std::size_t corners = std::size_t{1} << dimensions;
  for (std::size_t c = 0; c < corners; ++c) {
    std::size_t place = 0;
    for (std::size_t k = 0; k < dimensions; ++k) place += (first[k] + (c >> k & 1U)) * stride[k];
    corner[c] = value[place];
  }
  for (std::size_t k = dimensions; k-- > 0;) {
    const std::size_t half = std::size_t{1} << k;
    for (std::size_t c = 0; c < half; ++c) corner[c] += part[k] * (corner[c + half] - corner[c]);
  }
  return corner[0];
}

}  // namespace abbe
