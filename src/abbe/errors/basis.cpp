#include "abbe/errors/basis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

double scaled(const Basis& basis, double position) {
  return (2.0 * position - basis.from - basis.to) / (basis.to - basis.from);
}

double wrapped(double position, double from, double period) {
  return position - period * std::floor((position - from) / period);
}

/// Cubic B-spline segment weights at u in [0, 1], and their derivatives by u.
std::array<double, 4> bspline_weights(double u) {
  const double v = 1.0 - u;
  return {v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0, (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0,
          u * u * u / 6.0};
}
std::array<double, 4> bspline_slopes(double u) {
  const double v = 1.0 - u;
  return {-0.5 * v * v, 1.5 * u * u - 2.0 * u, -1.5 * v * v + 2.0 * v, 0.5 * u * u};
}

struct Interval {
  std::size_t index;
  double local;   ///< position within the interval, 0 to 1
  double length;  ///< mm or rad
};

Interval bspline_interval(const Basis& basis, double position) {
  const double length = (basis.periodic ? basis.period : basis.to - basis.from) / basis.order;
  const double q = basis.periodic ? wrapped(position, basis.from, basis.period) : position;
  const double x = (q - basis.from) / length;
  const double index = std::clamp(std::floor(x), 0.0, static_cast<double>(basis.order - 1));
  return {static_cast<std::size_t>(index), x - index, length};
}

/// Interval of a table. The interval after the last node exists only in a periodic table and closes the ring.
Interval table_interval(const Basis& basis, double position) {
  const std::vector<double>& nodes = basis.nodes;
  const double q = basis.periodic ? wrapped(position, nodes.front(), basis.period) : position;
  const auto after = std::upper_bound(nodes.begin(), nodes.end(), q);
  std::size_t index = after == nodes.begin() ? 0 : static_cast<std::size_t>(after - nodes.begin()) - 1;
  if (!basis.periodic) index = std::min(index, nodes.size() - 2);
  const double end = index + 1 < nodes.size() ? nodes[index + 1] : nodes.front() + basis.period;
  const double length = end - nodes[index];
  return {index, (q - nodes[index]) / length, length};
}

/// Slope of the monotone cubic at node i and its derivatives by the neighbouring node values.
struct NodeSlope {
  double value = 0;
  std::array<double, 3> by_values{};  ///< by the values at i - 1, i, i + 1
};

/// Fritsch and Butland (1984): weighted harmonic mean of the neighbouring secants where they have the same sign, else
/// zero; one-sided secant at the ends, so that the interpolant stays monotone there too.
NodeSlope monotone_slope(const Basis& basis, std::span<const double> values, std::size_t i) {
  const std::vector<double>& x = basis.nodes;
  NodeSlope slope;
  const std::size_t last = x.size() - 1;
  if (i == 0 || i == last) {
    const std::size_t a = i == 0 ? 0 : last - 1;
    const double h = x[a + 1] - x[a];
    slope.value = (values[a + 1] - values[a]) / h;
    if (i == 0) {
      slope.by_values = {0.0, -1.0 / h, 1.0 / h};
    } else {
      slope.by_values = {-1.0 / h, 1.0 / h, 0.0};
    }
    return slope;
  }
  const double h0 = x[i] - x[i - 1], h1 = x[i + 1] - x[i];
  const double s0 = (values[i] - values[i - 1]) / h0, s1 = (values[i + 1] - values[i]) / h1;
  if (s0 * s1 <= 0) return slope;
  const double w0 = (h0 + 2.0 * h1) / (3.0 * (h0 + h1)), w1 = 1.0 - w0;
  // harmonic mean s0 s1 / (w0 s1 + w1 s0), with the weight of the shorter interval's secant larger
  const double denominator = w0 * s1 + w1 * s0;
  slope.value = s0 * s1 / denominator;
  const double by_s0 = w0 * s1 * s1 / (denominator * denominator);
  const double by_s1 = w1 * s0 * s0 / (denominator * denominator);
  slope.by_values = {-by_s0 / h0, by_s0 / h0 - by_s1 / h1, by_s1 / h1};
  return slope;
}

void monotone_values(const Basis& basis, double position, std::span<const double> coefficients,
                     std::span<double> values, bool derivative) {
  const auto [i, u, length] = table_interval(basis, position);
  const double v = 1.0 - u;
  // Hermite weights of value i, value i+1, slope i, slope i+1.
  const double y0 = derivative ? 6.0 * u * (u - 1.0) / length : (1.0 + 2.0 * u) * v * v;
  const double y1 = derivative ? -y0 : u * u * (3.0 - 2.0 * u);
  const double m0 = derivative ? v * (1.0 - 3.0 * u) : length * u * v * v;
  const double m1 = derivative ? u * (3.0 * u - 2.0) : -length * u * u * v;
  const NodeSlope slope0 = monotone_slope(basis, coefficients, i);
  const NodeSlope slope1 = monotone_slope(basis, coefficients, i + 1);
  values[i] += y0;
  values[i + 1] += y1;
  for (std::size_t k = 0; k < 3; ++k) {
    // Outside the table the derivative is zero, so that the index never leaves the vector.
    if (slope0.by_values[k] != 0) values[i + k - 1] += m0 * slope0.by_values[k];
    if (slope1.by_values[k] != 0) values[i + k] += m1 * slope1.by_values[k];
  }
}

/// Functions, or their derivatives by position.
void fill(const Basis& basis, double position, std::span<const double> coefficients, std::span<double> out,
          bool derivative) {
  assert(out.size() == basis.size());
  std::fill(out.begin(), out.end(), 0.0);
  const std::size_t n = out.size();
  switch (basis.kind) {
    case BasisKind::monomial: {
      const double s = scaled(basis, position), ds = 2.0 / (basis.to - basis.from);
      double power = 1.0, previous = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        out[k] = derivative ? static_cast<double>(k) * previous * ds : power;
        previous = power;
        power *= s;
      }
      return;
    }
    case BasisKind::legendre: {
      const double s = scaled(basis, position), ds = 2.0 / (basis.to - basis.from);
      double p = 1.0, p_before = 0.0, d = 0.0, d_before = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        out[k] = derivative ? d * ds : p;
        const double j = static_cast<double>(k);
        const double p_next = ((2.0 * j + 1.0) * s * p - j * p_before) / (j + 1.0);
        const double d_next = d_before + (2.0 * j + 1.0) * p;  // P'_{k+1} = P'_{k-1} + (2k+1) P_k
        p_before = p, p = p_next;
        d_before = d, d = d_next;
      }
      return;
    }
    case BasisKind::chebyshev: {
      const double s = scaled(basis, position), ds = 2.0 / (basis.to - basis.from);
      double t = 1.0, t_before = s, d = 0.0, d_before = 1.0;  // T_0 and T_{-1} = T_1; their derivatives
      for (std::size_t k = 0; k < n; ++k) {
        out[k] = derivative ? d * ds : t;
        const double t_next = 2.0 * s * t - t_before;
        const double d_next = 2.0 * t + 2.0 * s * d - d_before;
        t_before = t, t = t_next;
        d_before = d, d = d_next;
      }
      return;
    }
    case BasisKind::fourier: {
      const double rate = kTwoPi / basis.period;
      out[0] = derivative ? 0.0 : 1.0;
      for (std::size_t h = 1; 2 * h < n; ++h) {
        const double factor = rate * static_cast<double>(h);
        const double cosine = std::cos(factor * position), sine = std::sin(factor * position);
        out[2 * h - 1] = derivative ? -factor * sine : cosine;
        out[2 * h] = derivative ? factor * cosine : sine;
      }
      return;
    }
    case BasisKind::bspline: {
      const auto [index, u, length] = bspline_interval(basis, position);
      std::array<double, 4> weights = derivative ? bspline_slopes(u) : bspline_weights(u);
      for (std::size_t k = 0; k < 4; ++k) out[(index + k) % n] += derivative ? weights[k] / length : weights[k];
      return;
    }
    case BasisKind::table_linear: {
      const auto [index, u, length] = table_interval(basis, position);
      out[index] += derivative ? -1.0 / length : 1.0 - u;
      out[(index + 1) % n] += derivative ? 1.0 / length : u;
      return;
    }
    case BasisKind::table_monotone:
      monotone_values(basis, position, coefficients, out, derivative);
      return;
  }
}

double dot_with_functions(const Basis& basis, double position, std::span<const double> coefficients, bool derivative) {
  assert(coefficients.size() == basis.size());
  std::array<double, 64> on_stack;
  std::vector<double> on_heap;
  std::span<double> functions(on_stack.data(), std::min(on_stack.size(), basis.size()));
  if (basis.size() > on_stack.size()) {
    on_heap.resize(basis.size());
    functions = on_heap;
  }
  fill(basis, position, coefficients, functions, derivative);
  double sum = 0;
  for (std::size_t k = 0; k < functions.size(); ++k) sum += functions[k] * coefficients[k];
  return sum;
}

}  // namespace

std::size_t Basis::size() const {
  const std::size_t n = static_cast<std::size_t>(order);
  switch (kind) {
    case BasisKind::monomial:
    case BasisKind::legendre:
    case BasisKind::chebyshev:
      return n + 1;
    case BasisKind::fourier:
      return 2 * n + 1;
    case BasisKind::bspline:
      return periodic ? n : n + 3;
    case BasisKind::table_linear:
    case BasisKind::table_monotone:
      return nodes.size();
  }
  return 0;
}

bool Basis::covers(double position) const {
  if (!std::isfinite(position)) return false;
  if (periodic) return true;
  const double range = to - from;
  const double spare = 1e-9 * range;
  if (kind == BasisKind::fourier && range >= period - spare) return true;
  return position >= from - spare && position <= to + spare;
}

void Basis::values(double position, std::span<const double> coefficients, std::span<double> out) const {
  fill(*this, position, coefficients, out, false);
}

double Basis::evaluate(double position, std::span<const double> coefficients) const {
  return dot_with_functions(*this, position, coefficients, false);
}

double Basis::slope(double position, std::span<const double> coefficients) const {
  return dot_with_functions(*this, position, coefficients, true);
}

std::string Basis::function_name(std::size_t index, bool rotary) const {
  switch (kind) {
    case BasisKind::monomial:
      return fmt::format("s^{}", index);
    case BasisKind::legendre:
      return fmt::format("P{}", index);
    case BasisKind::chebyshev:
      return fmt::format("T{}", index);
    case BasisKind::fourier:
      if (index == 0) return "mean";
      return fmt::format("{}{}", index % 2 == 1 ? "cos" : "sin", (index + 1) / 2);
    case BasisKind::bspline:
      return fmt::format("B{}", index);
    case BasisKind::table_linear:
    case BasisKind::table_monotone:
      return fmt::format("@{:.10g}", rotary ? nodes[index] / kDegree : nodes[index]);
  }
  return {};
}

const char* basis_kind_name(BasisKind kind) {
  switch (kind) {
    case BasisKind::monomial:
      return "monomial";
    case BasisKind::legendre:
      return "legendre";
    case BasisKind::chebyshev:
      return "chebyshev";
    case BasisKind::fourier:
      return "fourier";
    case BasisKind::bspline:
      return "bspline";
    case BasisKind::table_linear:
      return "table-linear";
    case BasisKind::table_monotone:
      return "table-monotone";
  }
  return "";
}

}  // namespace abbe
