#include "abbe/instruments/point_scan.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>
#include <stdexcept>

namespace abbe {
namespace {

constexpr std::size_t kBlock = 1024;  // points whose starts stay in the first level cache
constexpr std::size_t kMostAxes = 32;

}  // namespace

PointScan::PointScan(const Machine& machine, const ErrorSet& errors, const ProbeBeam& beam)
    : workpiece_from_tool_(machine, errors, Body::tool, Body::workpiece),
      zero_(beam.zero + errors.tool_offset_error),
      direction_(beam.direction) {
  if (!(std::abs(direction_.norm() - 1) < 1e-9))
    throw std::invalid_argument("the beam's direction is not a unit vector");
  if (machine.axes.size() > kMostAxes) throw std::invalid_argument("more than 32 axes");
}

void PointScan::points(PositionArrays positions, const double* indication, PointArrays points,
                       std::uint8_t* covered) const {
  std::array<double, kBlock> x, y, z;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before they are read
  std::array<const double*, kMostAxes> axis{};
  for (std::size_t first = 0; first < positions.count; first += kBlock) {
    const std::size_t count = std::min(kBlock, positions.count - first);
    for (std::size_t k = 0; k < count; ++k) {
      const double h = indication[first + k];
      x[k] = zero_[0] + h * direction_[0];
      y[k] = zero_[1] + h * direction_[1];
      z[k] = zero_[2] + h * direction_[2];
    }
    for (std::size_t i = 0; i < positions.axis.size(); ++i) axis[i] = positions.axis[i] + first;
    workpiece_from_tool_.transform(
        {std::span(axis).first(positions.axis.size()), count}, {x.data(), y.data(), z.data()},
        {points.x + first, points.y + first, points.z + first}, {}, covered == nullptr ? nullptr : covered + first);
  }
}

}  // namespace abbe
