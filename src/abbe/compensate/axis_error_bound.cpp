#include "abbe/compensate/axis_error_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "abbe/compensate/error_function_bound.h"

namespace abbe {
namespace {

double norm(double a, double b, double c) { return std::sqrt(a * a + b * b + c * c); }

/// Period that all terms have in common, or 0.
double common_period(const std::vector<ErrorMotion>& motions) {
  double longest = 0;
  for (const ErrorMotion& motion : motions) {
    if (motion.basis.kind != BasisKind::fourier && !motion.basis.periodic) return 0;
    longest = std::max(longest, motion.basis.period);
  }
  for (const ErrorMotion& motion : motions) {
    const double times = longest / motion.basis.period;
    if (std::abs(times - std::round(times)) > 1e-12 * times) return 0;
  }
  return longest;
}

}  // namespace

void AxisErrorBound::include(const AxisErrorBound& other) {
  shift = std::max(shift, other.shift);
  shift_slope = std::max(shift_slope, other.shift_slope);
  shift_bend = std::max(shift_bend, other.shift_bend);
  shift_jumps += other.shift_jumps;
  turn = std::max(turn, other.turn);
  turn_slope = std::max(turn_slope, other.turn_slope);
  turn_bend = std::max(turn_bend, other.turn_bend);
  turn_jumps += other.turn_jumps;
}

AxisErrorCells::AxisErrorCells(const Machine& machine, const ErrorSet& errors, std::size_t axis, std::size_t state) {
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.axis == axis && motion.state == state) motions_.push_back(motion);
  }
  if (motions_.empty()) return;
  const Axis& moving = machine.axes[axis];
  period_ = common_period(motions_);
  double last = 0;
  if (period_ > 0) {
    last = period_;
  } else {
    first_ = moving.travel_min;
    last = moving.travel_max;
    if (moving.endless || !(last > first_)) {
      first_ = -std::numbers::pi;
      last = std::numbers::pi;
    }
    // Corrected commands may leave the travel a little before they are kept within it.
    const double spare = 1e-3 * (last - first_);
    first_ -= spare;
    last += spare;
  }
  width_ = (last - first_) / static_cast<double>(kCells);
  levels_.emplace_back();
  shift_jumps_.assign(kCells + 1, 0.0);
  turn_jumps_.assign(kCells + 1, 0.0);
  for (std::size_t i = 0; i < kCells; ++i) {
    const double from = first_ + width_ * static_cast<double>(i), to = first_ + width_ * static_cast<double>(i + 1);
    AxisErrorBound cell = bound(from, to);
    shift_jumps_[i + 1] = shift_jumps_[i] + cell.shift_jumps;
    turn_jumps_[i + 1] = turn_jumps_[i] + cell.turn_jumps;
    cell.shift_jumps = cell.turn_jumps = 0;
    levels_[0].push_back(cell);
  }
  for (std::size_t size = 1; 2 * size <= kCells; size *= 2) {
    const std::vector<AxisErrorBound>& half = levels_.back();
    std::vector<AxisErrorBound> level(half.begin(), half.end() - static_cast<std::ptrdiff_t>(size));
    for (std::size_t i = 0; i < level.size(); ++i) level[i].include(half[i + size]);
    levels_.push_back(std::move(level));
  }
}

AxisErrorBound AxisErrorCells::bound(double from, double to) const {
  std::array<FunctionBound, kComponentCount> sums;
  for (const ErrorMotion& motion : motions_) {
    const FunctionBound term = bound_function(motion.basis, motion.coefficients, from, to);
    FunctionBound& sum = sums[static_cast<std::size_t>(motion.component)];
    sum.value += term.value;
    sum.slope += term.slope;
    sum.bend += term.bend;
    sum.jumps += term.jumps;
  }
  AxisErrorBound result;
  const auto& [x, y, z, a, b, c] = sums;
  result.shift = norm(x.value, y.value, z.value);
  result.shift_slope = norm(x.slope, y.slope, z.slope);
  result.shift_bend = norm(x.bend, y.bend, z.bend);
  // Kinks may stand in different places, seen through different rotations: their sizes add up.
  result.shift_jumps = x.jumps + y.jumps + z.jumps;
  // Angular velocity w = sum of angle rates times their axes, whose only angle other than 90 deg is that of A to C:
  // |w| <= |rates| sqrt(1 + |sin EB|); R' = [w] R, R'' = ([w'] + [w]^2) R, |w'| <= |bends| sqrt(..) + |rates|^2.
  const double skewed = std::min(b.value, 1.0), stretch = std::sqrt(1 + skewed);
  const double slope = norm(a.slope, b.slope, c.slope);
  result.turn = stretch * norm(a.value, b.value, c.value);
  result.turn_slope = stretch * slope;
  result.turn_bend = stretch * norm(a.bend, b.bend, c.bend) + (2 + skewed) * slope * slope;
  result.turn_jumps = stretch * (a.jumps + b.jumps + c.jumps);
  return result;
}

AxisErrorBound AxisErrorCells::over(double from, double to) const {
  if (motions_.empty()) return {};
  if (period_ > 0) {
    const double turns = std::floor(from / period_);
    from -= turns * period_;
    to -= turns * period_;
  }
  // A hair wider than asked, so that rounding of the cell's number cannot matter.
  const double i = std::floor((from - first_) / width_ - 1e-6), j = std::floor((to - first_) / width_ + 1e-6);
  const double count = static_cast<double>(kCells);
  if (!(i >= (period_ > 0 ? -1 : 0)) || !(j < (period_ > 0 ? 2 * count : count))) return bound(from, to);
  const std::size_t begin = static_cast<std::size_t>(std::max(i, 0.0)), end = static_cast<std::size_t>(j) + 1;
  if (i < 0 || end > kCells) {
    // Over the end of the period.
    if (end - begin + 1 >= kCells) {
      AxisErrorBound all = levels_.back()[0];
      all.shift_jumps = 2 * shift_jumps_.back();
      all.turn_jumps = 2 * turn_jumps_.back();
      return all;
    }
    AxisErrorBound both = over_cells(begin, std::min(end, kCells));
    both.include(i < 0 ? over_cells(kCells - 1, kCells) : over_cells(0, end - kCells));
    return both;
  }
  return over_cells(begin, end);
}

AxisErrorBound AxisErrorCells::over_cells(std::size_t begin, std::size_t end) const {
  std::size_t level = 0;
  while ((std::size_t{2} << level) <= end - begin) ++level;
  const std::size_t size = std::size_t{1} << level;
  AxisErrorBound result = levels_[level][begin];
  if (size < end - begin) result.include(levels_[level][end - size]);
  result.shift_jumps = shift_jumps_[end] - shift_jumps_[begin];
  result.turn_jumps = turn_jumps_[end] - turn_jumps_[begin];
  return result;
}

}  // namespace abbe
