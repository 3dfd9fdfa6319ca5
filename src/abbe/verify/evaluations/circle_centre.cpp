#include "abbe/verify/evaluations/circle_centre.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

Eigen::Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Direction of the true point of reading i seen from a centre: minus the derivative of its radius with the centre.
Eigen::Vector2d outward(const CircularReadings& readings, std::size_t i, const Eigen::Vector2d& centre) {
  return direction(angle_about(readings, i, centre));
}

CircleStatus checked(const CircularReadings& readings) {
  if (readings.count() < 3) return CircleStatus::too_few_readings;
  return largest_gap(readings) > kLargestGapForCentre ? CircleStatus::arc_too_short : CircleStatus::done;
}

/// Radii about a centre; nothing if a reading has none.
std::optional<std::vector<double>> radii_about(const CircularReadings& readings, const Eigen::Vector2d& centre) {
  std::vector<double> radii(readings.count());
  for (std::size_t i = 0; i < radii.size(); ++i) {
    radii[i] = radius_about(readings, i, centre);
    if (!(radii[i] > 0)) return std::nullopt;
  }
  return radii;
}

/// t >= value - slope . shift; a cut under the separation of the concentric circles.
struct Cut {
  double value = 0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double height = 1;  ///< 1 for a cut, 0 for a side of the box: 0 >= value - slope . shift
};

struct Lowest {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double height = -1;
};

/// Lowest point that satisfies all cuts, by trying all corners: there are few.
Lowest lowest_point(const std::vector<Cut>& cuts) {
  Lowest best;
  double best_height = std::numeric_limits<double>::infinity();
  const std::size_t n = cuts.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        Eigen::Matrix3d system;
        system << cuts[i].slope.transpose(), cuts[i].height, cuts[j].slope.transpose(), cuts[j].height,
            cuts[k].slope.transpose(), cuts[k].height;
        if (std::abs(system.determinant()) < 1e-12) continue;
        const Eigen::Vector3d corner = system.inverse() * Eigen::Vector3d(cuts[i].value, cuts[j].value, cuts[k].value);
        if (!(corner[2] < best_height)) continue;
        const bool below = std::any_of(cuts.begin(), cuts.end(), [&](const Cut& cut) {
          return cut.value - cut.slope.dot(corner.head<2>()) > cut.height * corner[2] + 1e-11;
        });
        if (below) continue;
        best_height = corner[2];
        best = {corner.head<2>(), corner[2]};
      }
    }
  }
  return best;
}

/// Shift that minimises max - min of heights[i] - directions[i] . shift; nothing if the gap does not close.
std::optional<Eigen::Vector2d> narrowing_shift(const std::vector<double>& heights,
                                               const std::vector<Eigen::Vector2d>& directions) {
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double unit = *high - *low;
  if (!(unit > 0)) return Eigen::Vector2d::Zero();
  const double base = *low;
  // In units of the first separation the best shift of an arc of 200 degrees or more lies far inside this box.
  constexpr double kBox = 100;
  std::vector<Cut> cuts = {{-kBox, {1, 0}, 0}, {-kBox, {-1, 0}, 0}, {-kBox, {0, 1}, 0}, {-kBox, {0, -1}, 0}};
  Eigen::Vector2d shift = Eigen::Vector2d::Zero(), best = shift;
  double best_width = std::numeric_limits<double>::infinity(), bound = 0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    std::size_t largest = 0, smallest = 0;
    double largest_value = -std::numeric_limits<double>::infinity(), smallest_value = -largest_value;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const double value = (heights[i] - base) / unit - directions[i].dot(shift);
      if (value > largest_value) largest_value = value, largest = i;
      if (value < smallest_value) smallest_value = value, smallest = i;
    }
    // Where several centres are as good, rounding must not lead away from the first of them.
    if (largest_value - smallest_value < best_width - 1e-12) {
      best_width = largest_value - smallest_value;
      best = shift;
    }
    if (best_width - bound <= 1e-10 * std::max(best_width, 1e-6)) return Eigen::Vector2d(unit * best);
    cuts.push_back({(heights[largest] - heights[smallest]) / unit, directions[largest] - directions[smallest], 1});
    const Lowest next = lowest_point(cuts);
    // A cut that is met within rounding changes nothing: the gap is closed as far as numbers can say.
    if (iteration > 3 && (next.shift - shift).norm() <= 1e-13) return Eigen::Vector2d(unit * best);
    shift = next.shift;
    bound = next.height;
  }
  return std::nullopt;
}

}  // namespace

double radius_about(const CircularReadings& readings, std::size_t i, const Eigen::Vector2d& centre) {
  const Eigen::Vector2d along = direction(readings.angle[i]);
  const double radius = readings.radius[i];
  if (readings.kind == CircularAngle::measured) return (radius * along - centre).norm();
  const double side = along.x() * centre.y() - along.y() * centre.x();
  if (std::abs(side) >= radius) return -1;
  return std::sqrt((radius - side) * (radius + side)) - centre.dot(along);
}

double angle_about(const CircularReadings& readings, std::size_t i, const Eigen::Vector2d& centre) {
  Eigen::Vector2d arm = direction(readings.angle[i]);
  if (readings.kind == CircularAngle::measured) arm = readings.radius[i] * arm - centre;
  return std::atan2(arm.y(), arm.x());
}

CircularReadings points_about(const CircularReadings& readings, const Eigen::Vector2d& centre) {
  if (readings.kind == CircularAngle::measured) return readings;
  CircularReadings points;
  points.kind = CircularAngle::measured;
  for (std::size_t i = 0; i < readings.count(); ++i) {
    const Eigen::Vector2d point = centre + radius_about(readings, i, centre) * direction(readings.angle[i]);
    points.angle.push_back(std::atan2(point.y(), point.x()));
    points.radius.push_back(point.norm());
  }
  return points;
}

double largest_gap(const CircularReadings& readings) {
  if (readings.count() < 2) return kTurn;
  std::vector<double> angles(readings.angle);
  for (double& angle : angles) angle -= kTurn * std::floor(angle / kTurn);
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + kTurn - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap;
}

CircleCentre least_squares_circle(const CircularReadings& readings) {
  CircleCentre result;
  result.status = checked(readings);
  if (result.status != CircleStatus::done) return result;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const auto radii = radii_about(readings, result.centre);
    if (!radii) break;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const double reference = radii->front();
    for (std::size_t i = 0; i < readings.count(); ++i) {
      Eigen::Vector3d row;
      row << outward(readings, i, result.centre), 1;
      normal += row * row.transpose();
      right += ((*radii)[i] - reference) * row;
    }
    result.cofactor = normal.inverse();
    const Eigen::Vector3d step = result.cofactor * right;
    if (!step.allFinite()) break;
    result.centre += step.head<2>();
    result.radius = reference + step[2];
    if (step.head<2>().norm() > 1e-12 * std::abs(result.radius)) continue;
    if (!radii_about(readings, result.centre)) break;
    return result;
  }
  result = {};
  result.status = CircleStatus::not_converged;
  return result;
}

CircleCentre minimum_zone_circle(const CircularReadings& readings) {
  assert(readings.kind == CircularAngle::measured);
  CircleCentre result = least_squares_circle(readings);
  if (result.status != CircleStatus::done) return result;
  result.cofactor.setZero();
  std::vector<Eigen::Vector2d> directions(readings.count());
  for (int iteration = 0; iteration < 20; ++iteration) {
    const auto radii = radii_about(readings, result.centre);
    if (!radii) break;
    for (std::size_t i = 0; i < directions.size(); ++i) directions[i] = outward(readings, i, result.centre);
    const auto shift = narrowing_shift(*radii, directions);
    if (!shift) break;
    result.centre += *shift;
    if (shift->norm() > 1e-12 * result.radius) continue;
    const auto last = radii_about(readings, result.centre);
    if (!last) break;
    result.radius = 0;
    for (const double radius : *last) result.radius += radius / static_cast<double>(last->size());
    return result;
  }
  result = {};
  result.status = CircleStatus::not_converged;
  return result;
}

}  // namespace abbe
