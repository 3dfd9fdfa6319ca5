#include "abbe/verify/evaluations/rotation_error_motion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

/// Where the grid angles lie among the readings: reading `below` and the share of the next one.
struct PlaceBetweenReadings {
  std::size_t below = 0;
  double share = 0;
};

struct AngleGrid {
  RotationResult result;
  std::vector<PlaceBetweenReadings> places;  // [turns * positions]
};

double spread_of(std::span<const double> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

/// Whole turns and positions of the readings, or why there are none.
AngleGrid grid_of(const std::vector<double>& angle) {
  AngleGrid grid;
  RotationResult& result = grid.result;
  result.status = RotationStatus::too_few_turns;
  const std::size_t n = angle.size();
  if (n < 2) return grid;
  const double span = angle.back() - angle.front(), sense = span < 0 ? -1 : 1;
  const double step = std::abs(span) / static_cast<double>(n - 1);
  if (std::abs(span) < (static_cast<double>(kLeastTurns) - 1) * kTurn) return grid;
  if (kTurn / step < static_cast<double>(kLeastPositions) - 0.5) {
    result.status = RotationStatus::too_few_positions;
    return grid;
  }
  for (std::size_t i = 1; i < n; ++i) {
    const double advance = sense * (angle[i] - angle[i - 1]);
    if (!(advance > 0) || advance > kLargestStepRatio * step) {
      result.status = RotationStatus::uneven_coverage;
      return grid;
    }
  }
  const double positions = std::round(kTurn / step);
  // The last turn is whole one step before its end; readings at nominal angles may end a rounding short of that.
  const double turns = std::floor(std::abs(span) / kTurn + (1 + 1e-6) / positions);
  if (turns < static_cast<double>(kLeastTurns)) return grid;
  result.status = RotationStatus::done;
  result.positions = static_cast<std::size_t>(positions);
  result.turns = static_cast<std::size_t>(turns);
  for (std::size_t k = 0; k < result.positions; ++k) {
    result.angle.push_back(angle.front() + sense * kTurn * static_cast<double>(k) / positions);
  }
  std::size_t below = 0;
  for (std::size_t i = 0; i < result.turns * result.positions; ++i) {
    const double advance = kTurn * static_cast<double>(i) / positions;
    while (below + 2 < n && sense * (angle[below + 1] - angle.front()) <= advance) ++below;
    const double first = sense * (angle[below] - angle.front()), second = sense * (angle[below + 1] - angle.front());
    const double share = std::clamp((advance - first) / (second - first), 0.0, 1.0);
    if (std::min(share, 1 - share) > 1e-3) result.interpolated = true;
    grid.places.push_back({below, share});
  }
  return grid;
}

std::vector<double> on_grid(const AngleGrid& grid, const std::vector<double>& readings) {
  std::vector<double> values;
  values.reserve(grid.places.size());
  for (const PlaceBetweenReadings& place : grid.places) {
    values.push_back((1 - place.share) * readings[place.below] + place.share * readings[place.below + 1]);
  }
  return values;
}

/// First harmonic of values that stand at equal angles over whole turns.
struct Fundamental {
  double mean = 0, cosine = 0, sine = 0;
};

Fundamental fundamental_of(const std::vector<double>& values, const std::vector<double>& angle) {
  Fundamental part;
  const double n = static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double at = angle[i % angle.size()];
    part.mean += values[i] / n;
    part.cosine += 2 * values[i] * std::cos(at) / n;
    part.sine += 2 * values[i] * std::sin(at) / n;
  }
  return part;
}

double drift_of(const std::vector<double>& values, std::size_t turns, std::size_t positions) {
  const double middle = static_cast<double>(turns - 1) / 2;
  double product = 0, spread = 0;
  for (std::size_t m = 0; m < turns; ++m) {
    double mean = 0;
    for (std::size_t k = 0; k < positions; ++k) mean += values[m * positions + k] / static_cast<double>(positions);
    const double at = static_cast<double>(m) - middle;
    product += at * mean;
    spread += at * at;
  }
  return product / spread * static_cast<double>(turns - 1);
}

AxisErrorMotion evaluate(AxisErrorMotionKind kind, std::vector<double> values, const RotationResult& grid,
                         double uncertainty) {
  AxisErrorMotion motion;
  motion.kind = kind;
  const std::size_t turns = grid.turns, positions = grid.positions;
  const Fundamental part = fundamental_of(values, grid.angle);
  const auto once = [&](std::size_t k) {
    return part.cosine * std::cos(grid.angle[k]) + part.sine * std::sin(grid.angle[k]);
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] -= part.mean;
    if (fundamental_is_removed(kind)) values[i] -= once(i % positions);
  }
  std::vector<double> residual;
  for (std::size_t k = 0; k < positions; ++k) {
    double mean = 0, low = values[k], high = low;
    for (std::size_t m = 0; m < turns; ++m) {
      const double value = values[m * positions + k];
      mean += value / static_cast<double>(turns);
      low = std::min(low, value);
      high = std::max(high, value);
    }
    motion.synchronous.push_back(mean);
    residual.push_back(fundamental_is_removed(kind) ? mean : mean - once(k));
    if (high - low > motion.asynchronous_value) {
      motion.asynchronous_value = high - low;
      motion.asynchronous_at = k;
    }
  }
  motion.total_value = spread_of(values);
  motion.synchronous_value = spread_of(motion.synchronous);
  motion.residual_value = spread_of(residual);
  motion.fundamental_value = 2 * std::hypot(part.cosine, part.sine);
  motion.drift = drift_of(values, turns, positions);
  motion.total = std::move(values);
  // Differences of two readings, and of two means over the turns.
  motion.total_uncertainty = motion.asynchronous_uncertainty = std::sqrt(2.0) * uncertainty;
  motion.synchronous_uncertainty = std::sqrt(2.0 / static_cast<double>(turns)) * uncertainty;
  return motion;
}

}  // namespace

bool is_tilt(AxisErrorMotionKind kind) {
  return kind == AxisErrorMotionKind::tilt_fixed_x || kind == AxisErrorMotionKind::tilt_fixed_y ||
         kind == AxisErrorMotionKind::tilt_rotating;
}

bool fundamental_is_removed(AxisErrorMotionKind kind) {
  return kind != AxisErrorMotionKind::axial && kind != AxisErrorMotionKind::face;
}

std::vector<AxisErrorMotionKind> evaluated_kinds(const RotationReadings& readings, const RotationOptions& options) {
  const bool x1 = !readings.x1.empty(), y1 = !readings.y1.empty(), x2 = !readings.x2.empty(), y2 = !readings.y2.empty();
  const bool tilt = options.plane_distance > 0;
  std::vector<AxisErrorMotionKind> kinds;
  const auto add = [&](AxisErrorMotionKind kind, bool allowed) {
    if (allowed) kinds.push_back(kind);
  };
  add(AxisErrorMotionKind::radial_fixed_x1, x1);
  add(AxisErrorMotionKind::radial_fixed_y1, y1);
  add(AxisErrorMotionKind::radial_rotating_1, x1 && y1);
  add(AxisErrorMotionKind::radial_fixed_x2, x2);
  add(AxisErrorMotionKind::radial_fixed_y2, y2);
  add(AxisErrorMotionKind::radial_rotating_2, x2 && y2);
  add(AxisErrorMotionKind::tilt_fixed_x, tilt && x1 && x2);
  add(AxisErrorMotionKind::tilt_fixed_y, tilt && y1 && y2);
  add(AxisErrorMotionKind::tilt_rotating, tilt && x1 && x2 && y1 && y2);
  add(AxisErrorMotionKind::axial, !readings.axial.empty());
  add(AxisErrorMotionKind::face, !readings.face.empty());
  return kinds;
}

RotationResult rotation_error_motions(const RotationReadings& readings, const RotationOptions& options) {
  const AngleGrid grid = grid_of(readings.angle);
  RotationResult result = grid.result;
  if (result.status != RotationStatus::done) return result;
  const auto signal = [&](const std::vector<double>& probe) {
    assert(probe.empty() || probe.size() == readings.angle.size());
    return probe.empty() ? probe : on_grid(grid, probe);
  };
  std::vector<double> x1 = signal(readings.x1), y1 = signal(readings.y1), x2 = signal(readings.x2),
                      y2 = signal(readings.y2);
  const auto rotating = [&](const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<double> values(x.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double at = result.angle[i % result.positions] + options.sensitive_angle;
      values[i] = x[i] * std::cos(at) + y[i] * std::sin(at);
    }
    return values;
  };
  const auto tilt = [&](const std::vector<double>& near, const std::vector<double>& far) {
    std::vector<double> values(near.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = (far[i] - near[i]) / options.plane_distance;
    return values;
  };
  const auto values_of = [&](AxisErrorMotionKind kind) -> std::vector<double> {
    switch (kind) {
      case AxisErrorMotionKind::radial_fixed_x1:
        return x1;
      case AxisErrorMotionKind::radial_fixed_y1:
        return y1;
      case AxisErrorMotionKind::radial_rotating_1:
        return rotating(x1, y1);
      case AxisErrorMotionKind::radial_fixed_x2:
        return x2;
      case AxisErrorMotionKind::radial_fixed_y2:
        return y2;
      case AxisErrorMotionKind::radial_rotating_2:
        return rotating(x2, y2);
      case AxisErrorMotionKind::tilt_fixed_x:
        return tilt(x1, x2);
      case AxisErrorMotionKind::tilt_fixed_y:
        return tilt(y1, y2);
      case AxisErrorMotionKind::tilt_rotating:
        return rotating(tilt(x1, x2), tilt(y1, y2));
      case AxisErrorMotionKind::axial:
        return signal(readings.axial);
      case AxisErrorMotionKind::face:
        return signal(readings.face);
    }
    return {};
  };
  for (const AxisErrorMotionKind kind : evaluated_kinds(readings, options)) {
    const double uncertainty = is_tilt(kind) ? std::sqrt(2.0) * options.reading_uncertainty / options.plane_distance
                                             : options.reading_uncertainty;
    result.motions.push_back(evaluate(kind, values_of(kind), result, uncertainty));
  }
  return result;
}

}  // namespace abbe
