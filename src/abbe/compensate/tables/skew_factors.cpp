#include "abbe/compensate/tables/skew_factors.h"

#include "abbe/compensate/point_correction.h"

namespace abbe {
namespace {

constexpr std::size_t kPositions = 9;  // per axis

/// Slope of values over positions, least squares with a constant; 0 where the positions do not differ.
double slope(const std::vector<double>& positions, const std::vector<double>& values) {
  double middle = 0, above = 0, below = 0;
  for (const double q : positions) middle += q / static_cast<double>(positions.size());
  for (std::size_t k = 0; k < positions.size(); ++k) {
    above += (positions[k] - middle) * values[k];
    below += (positions[k] - middle) * (positions[k] - middle);
  }
  return below > 0 ? above / below : 0;
}

}  // namespace

void SkewCorrection::evaluate(const PoseList& commands, PoseList& correction) const {
  const std::size_t count = commands.count();
  correction.axis.assign(commands.axis.size(), std::vector<double>(count, 0.0));
  for (std::size_t k = 0; k < count; ++k) {
    const double y = commands.axis[axes_[1]][k], z = commands.axis[axes_[2]][k];
    correction.axis[axes_[0]][k] = -y * factors_.xy - z * (factors_.xz - factors_.xy * factors_.yz);
    correction.axis[axes_[1]][k] = -z * factors_.yz;
  }
}

SkewFactors fit_skew(const Machine& machine, const ErrorSet& errors, const std::array<std::size_t, 3>& axes,
                     const std::vector<double>& reference) {
  std::array<std::vector<double>, 3> positions;
  for (std::size_t c = 0; c < 3; ++c) {
    const KnownTravel travel = known_travel(machine, errors, axes[c]);
    positions[c] = evenly_spaced(travel.from, travel.to, travel.to > travel.from ? kPositions : 1);
  }
  PoseList grid, found;
  for (const double x : positions[0]) {
    for (const double y : positions[1]) {
      for (const double z : positions[2]) {
        std::vector<double> pose = reference;
        pose[axes[0]] = x;
        pose[axes[1]] = y;
        pose[axes[2]] = z;
        grid.append(pose);
      }
    }
  }
  PointCorrection(machine, errors).evaluate(grid, found);
  // The grid's axes are orthogonal, so the slopes of one fit are those of three.
  SkewFactors factors;
  factors.xy = -slope(grid.axis[axes[1]], found.axis[axes[0]]);
  factors.yz = -slope(grid.axis[axes[2]], found.axis[axes[1]]);
  factors.xz = -slope(grid.axis[axes[2]], found.axis[axes[0]]) + factors.xy * factors.yz;
  return factors;
}

}  // namespace abbe
