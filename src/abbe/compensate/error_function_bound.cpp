#include "abbe/compensate/error_function_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace abbe {
namespace {

// Rounding of the sums below, far above it.
constexpr double kRounding = 1 + 1e-9;

/// Sums of |terms| of a Taylor polynomial: derivatives by t at the middle, half the width in t, dt/dq.
FunctionBound taylor_bound(std::span<const double> derivatives, double half, double rate) {
  FunctionBound bound;
  double power = 1;  // half^k / k!
  for (std::size_t k = 0; k < derivatives.size(); ++k) {
    if (k > 0) power *= half / static_cast<double>(k);
    bound.value += std::abs(derivatives[k]) * power;
    if (k + 1 < derivatives.size()) bound.slope += std::abs(derivatives[k + 1]) * power;
    if (k + 2 < derivatives.size()) bound.bend += std::abs(derivatives[k + 2]) * power;
  }
  bound.value *= kRounding;
  bound.slope *= kRounding * std::abs(rate);
  bound.bend *= kRounding * rate * rate;
  return bound;
}

/// p_{i+1} = (a s) p_i - b p_{i-1}
struct Recurrence {
  double a, b;
};
Recurrence recurrence(BasisKind kind, std::size_t i) {
  const double j = static_cast<double>(i);
  if (kind == BasisKind::legendre) return {(2 * j + 1) / (j + 1), j / (j + 1)};
  if (kind == BasisKind::chebyshev) return {i == 0 ? 1.0 : 2.0, i == 0 ? 0.0 : 1.0};
  return {1, 0};
}

FunctionBound polynomial_bound(const Basis& basis, std::span<const double> coefficients, double from, double to) {
  const std::size_t n = coefficients.size();
  const double rate = 2 / (basis.to - basis.from);
  const double s = 0.5 * rate * (from + to - basis.from - basis.to);
  // Column i: derivatives of function i at s, by Leibniz's rule from the recurrence.
  std::vector<double> before(n, 0.0), now(n, 0.0), next(n, 0.0), sum(n, 0.0);
  now[0] = 1;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k <= i; ++k) sum[k] += coefficients[i] * now[k];
    const Recurrence r = recurrence(basis.kind, i);
    for (std::size_t k = 0; k < n; ++k) {
      const double below = k == 0 ? 0 : static_cast<double>(k) * now[k - 1];
      next[k] = r.a * (s * now[k] + below) - r.b * before[k];
    }
    std::swap(before, now);
    std::swap(now, next);
  }
  return taylor_bound(sum, 0.5 * (to - from) * std::abs(rate), rate);
}

FunctionBound fourier_bound(const Basis& basis, std::span<const double> coefficients, double from, double to) {
  constexpr std::size_t kTerms = 5;
  std::array<double, kTerms + 1> derivatives{};  // the last: remainder
  std::array<double, 3> everywhere{};
  derivatives[0] = everywhere[0] = coefficients[0];
  everywhere[0] = std::abs(everywhere[0]);
  const double middle = 0.5 * (from + to);
  for (std::size_t h = 1; 2 * h < coefficients.size(); ++h) {
    const double rate = 2 * std::numbers::pi * static_cast<double>(h) / basis.period;
    const double a = coefficients[2 * h - 1], b = coefficients[2 * h];
    // f = a cos + b sin; each derivative takes (a, b) to (b, -a).
    double cosine = a * std::cos(rate * middle) + b * std::sin(rate * middle);
    double sine = b * std::cos(rate * middle) - a * std::sin(rate * middle);
    double power = 1;
    const double amplitude = std::hypot(a, b);
    for (std::size_t k = 0; k < kTerms; ++k) {
      derivatives[k] += power * cosine;
      if (k < 3) everywhere[k] += std::abs(power) * amplitude;
      const double turned = -cosine;
      cosine = sine;
      sine = turned;
      power *= rate;
    }
    derivatives[kTerms] += std::abs(power) * amplitude;
  }
  FunctionBound bound = taylor_bound(derivatives, 0.5 * (to - from), 1);
  bound.value = std::min(bound.value, kRounding * everywhere[0]);
  bound.slope = std::min(bound.slope, kRounding * everywhere[1]);
  bound.bend = std::min(bound.bend, kRounding * everywhere[2]);
  return bound;
}

/// Ends of the polynomial pieces of a spline or table within one period or the whole range, increasing; the outermost
/// pieces of one that is not periodic go on beyond.
std::vector<double> piece_ends(const Basis& basis) {
  std::vector<double> ends = basis.nodes;
  if (basis.kind == BasisKind::bspline) {
    ends.clear();
    const double length = (basis.periodic ? basis.period : basis.to - basis.from) / basis.order;
    for (int i = 0; i <= basis.order; ++i) ends.push_back(basis.from + i * length);
  } else if (basis.periodic && ends.back() < ends.front() + basis.period * (1 - 1e-12)) {
    ends.push_back(ends.front() + basis.period);
  }
  return ends;
}

/// c0 + c1 t + c2 t^2 + c3 t^3 with t from -1 to 1 over the piece.
struct Cubic {
  double middle, half;
  std::array<double, 4> c;
  double slope(double q) const {
    const double t = (q - middle) / half;
    return (c[1] + t * (2 * c[2] + 3 * t * c[3])) / half;
  }
};

/// The cubic that a piece is, from four of its values inside.
Cubic cubic_piece(const Basis& basis, std::span<const double> coefficients, double from, double to, double shift) {
  Cubic cubic{0.5 * (from + to) + shift, 0.5 * (to - from), {}};
  std::array<double, 4> f;
  for (std::size_t i = 0; i < 4; ++i) {
    const double t = 0.5 * static_cast<double>(i) - 0.75;
    f[i] = basis.evaluate(0.5 * (from + to) + t * cubic.half, coefficients);
  }
  const double outer = 0.5 * (f[0] + f[3]), inner = 0.5 * (f[1] + f[2]);
  const double outer_odd = 0.5 * (f[3] - f[0]), inner_odd = 0.5 * (f[2] - f[1]);
  cubic.c[2] = 2 * (outer - inner);
  cubic.c[0] = inner - 0.0625 * cubic.c[2];
  cubic.c[3] = (outer_odd - 3 * inner_odd) / 0.375;
  cubic.c[1] = 4 * (inner_odd - 0.015625 * cubic.c[3]);
  return cubic;
}

FunctionBound cubic_bound(const Cubic& cubic, double from, double to) {
  const double t = (0.5 * (from + to) - cubic.middle) / cubic.half;
  const double half = 0.5 * std::max(to - from, 0.0) / cubic.half;
  const std::array<double, 4>& c = cubic.c;
  const std::array<double, 4> derivatives = {c[0] + t * (c[1] + t * (c[2] + t * c[3])),
                                             c[1] + t * (2 * c[2] + 3 * t * c[3]), 2 * c[2] + 6 * t * c[3], 6 * c[3]};
  return taylor_bound(derivatives, half, 1 / cubic.half);
}

FunctionBound pieces_bound(const Basis& basis, std::span<const double> coefficients, double from, double to) {
  const std::vector<double> ends = piece_ends(basis);
  const std::size_t pieces = ends.size() - 1;
  const double period = basis.periodic ? basis.period : 0;
  // One turn more below, for a kink where the interval begins.
  const double first_turn = basis.periodic ? std::floor((from - ends.front()) / period) - 1 : 0;
  const double last_turn = basis.periodic ? std::floor((to - ends.front()) / period) : 0;
  FunctionBound bound;
  bool have_slope = false;
  double slope_before = 0;
  for (double turn = first_turn; turn <= last_turn; ++turn) {
    const double shift = turn * period;
    for (std::size_t i = 0; i < pieces; ++i) {
      const bool open_below = !basis.periodic && i == 0, open_above = !basis.periodic && i + 1 == pieces;
      const double begin = ends[i] + shift, end = ends[i + 1] + shift;
      const double spare = 1e-9 * (end - begin);
      if ((!open_above && end < from - spare) || (!open_below && begin > to + spare)) {
        have_slope = false;
        continue;
      }
      const Cubic cubic = cubic_piece(basis, coefficients, ends[i], ends[i + 1], shift);
      bound.include(cubic_bound(cubic, open_below ? from : std::max(from, begin), open_above ? to : std::min(to, end)));
      if (basis.kind == BasisKind::table_linear) {
        if (have_slope && begin >= from && begin < to) bound.jumps += std::abs(cubic.slope(begin) - slope_before);
        slope_before = cubic.slope(end);
        have_slope = true;
      }
    }
  }
  bound.jumps *= kRounding;
  return bound;
}

}  // namespace

void FunctionBound::include(const FunctionBound& other) {
  value = std::max(value, other.value);
  slope = std::max(slope, other.slope);
  bend = std::max(bend, other.bend);
  jumps += other.jumps;
}

FunctionBound bound_function(const Basis& basis, std::span<const double> coefficients, double from, double to) {
  if (coefficients.empty()) return {};
  switch (basis.kind) {
    case BasisKind::monomial:
    case BasisKind::legendre:
    case BasisKind::chebyshev:
      return polynomial_bound(basis, coefficients, from, to);
    case BasisKind::fourier:
      return fourier_bound(basis, coefficients, from, to);
    case BasisKind::bspline:
    case BasisKind::table_linear:
    case BasisKind::table_monotone:
      break;
  }
  if (!basis.periodic || to - from <= basis.period) return pieces_bound(basis, coefficients, from, to);
  // A whole turn holds every value; kinks count as often as they are passed.
  const double turns = std::ceil((to - from) / basis.period);
  FunctionBound bound = pieces_bound(basis, coefficients, basis.from, basis.from + basis.period);
  bound.jumps *= 2 * turns;
  return bound;
}

}  // namespace abbe
