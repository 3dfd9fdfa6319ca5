#include "abbe/runtime/frozen_functions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/runtime/frozen_layout.h"

namespace abbe {
namespace {

/// How far beyond its range an error motion is still followed, so that a correction does not meet the end of it: mm or
/// rad, and part of the range.
constexpr double kBeyond = 1;
constexpr double kPartBeyond = 0.005;

/// Coefficients of the Chebyshev sum through the values at the Chebyshev points; for a polynomial, it itself.
std::vector<double> chebyshev_coefficients(const ErrorMotion& motion) {
  const Basis& basis = motion.basis;
  const std::size_t n = basis.size();
  std::vector<double> sums(n, 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    const double angle = std::numbers::pi * (static_cast<double>(j) + 0.5) / static_cast<double>(n);
    const double position = 0.5 * (basis.from + basis.to) + 0.5 * (basis.to - basis.from) * std::cos(angle);
    const double value = basis.evaluate(position, motion.coefficients);
    for (std::size_t k = 0; k < n; ++k)
      sums[k] += (k == 0 ? 1.0 : 2.0) / static_cast<double>(n) * value * std::cos(static_cast<double>(k) * angle);
  }
  return sums;
}

std::vector<double> piece_nodes(const Basis& basis) {
  if (basis.kind != BasisKind::bspline) {
    std::vector<double> nodes = basis.nodes;
    if (basis.periodic) nodes.push_back(nodes.front() + basis.period);
    return nodes;
  }
  std::vector<double> nodes;
  const double length = basis.periodic ? basis.period : basis.to - basis.from;
  for (int k = 0; k <= basis.order; ++k) nodes.push_back(basis.from + length * k / basis.order);
  return nodes;
}

/// Coefficients of the cubic pieces, rising powers of the part u of each interval, from four values in it.
std::vector<double> piece_coefficients(const ErrorMotion& motion, const std::vector<double>& nodes) {
  std::vector<double> all;
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    double f[4];
    for (int k = 0; k < 4; ++k) {
      const double place = nodes[i] + (nodes[i + 1] - nodes[i]) * k / 3.0;
      f[k] = motion.basis.evaluate(place, motion.coefficients);
    }
    // The end belongs to the next interval, where the value is the same: all these functions are continuous.
    const double d1 = f[1] - f[0], d2 = f[2] - 2 * f[1] + f[0], d3 = f[3] - 3 * f[2] + 3 * f[1] - f[0];
    // Newton's form in v = 3 u.
    all.insert(all.end(), {f[0], 3 * d1 - 1.5 * d2 + d3, 4.5 * (d2 - d3), 4.5 * d3});
  }
  return all;
}

FrozenFunctions empty_functions(const ErrorMotion& motion) {
  const Basis& basis = motion.basis;
  FrozenFunctions functions;
  functions.axis = motion.axis;
  functions.everywhere = basis.covers(basis.from - 1e5) && basis.covers(basis.to + 1e5);
  const double range = basis.to - basis.from;
  double beyond = std::min(kBeyond, kPartBeyond * range);
  switch (basis.kind) {
    case BasisKind::monomial:
    case BasisKind::legendre:
    case BasisKind::chebyshev:
      functions.kind = 0;
      functions.first = basis.from;
      functions.second = basis.to;
      break;
    case BasisKind::fourier:
      functions.kind = 1;
      functions.first = basis.period;
      break;
    case BasisKind::bspline:
    case BasisKind::table_linear:
    case BasisKind::table_monotone:
      functions.kind = 2;
      functions.first = functions.everywhere ? basis.period : 0;
      functions.nodes = piece_nodes(basis);
      beyond = std::min(beyond, 0.05 * range / static_cast<double>(functions.nodes.size()));
      break;
  }
  functions.lowest = functions.everywhere ? 0 : basis.from - beyond;
  functions.highest = functions.everywhere ? 0 : basis.to + beyond;
  return functions;
}

bool same_functions(const FrozenFunctions& a, const FrozenFunctions& b) {
  return a.axis == b.axis && a.kind == b.kind && a.everywhere == b.everywhere && a.lowest == b.lowest &&
         a.highest == b.highest && a.first == b.first && a.second == b.second && a.nodes == b.nodes;
}

std::string not_frozen(const Machine& machine, const ErrorMotion& motion, const char* why) {
  return fmt::format("{}: {}", error_motion_name(machine, motion.axis, motion.component), why);
}

}  // namespace

std::vector<FrozenFunctions> frozen_functions(const Machine& machine, const ErrorSet& errors, std::string& problem) {
  std::vector<FrozenFunctions> all;
  problem.clear();
  for (const ErrorMotion& motion : errors.motions) {
    FrozenFunctions functions = empty_functions(motion);
    std::vector<double> coefficients = motion.coefficients;
    if (functions.kind == 0) coefficients = chebyshev_coefficients(motion);
    if (functions.kind == 2) coefficients = piece_coefficients(motion, functions.nodes);
    if (functions.kind != 2 && coefficients.size() > frozen::kMostFunctions) {
      problem = not_frozen(machine, motion, "more than 64 functions");
      return {};
    }
    if (functions.kind == 2 && functions.nodes.size() > frozen::kMostIntervals) {
      problem = not_frozen(machine, motion, "more than 4095 intervals");
      return {};
    }
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const FrozenFunctions& other) { return same_functions(other, functions); });
    FrozenFunctions& place = found == all.end() ? all.emplace_back(std::move(functions)) : *found;
    if (place.rows.size() < coefficients.size()) place.rows.resize(coefficients.size());
    for (std::size_t k = 0; k < coefficients.size(); ++k)
      place.rows[k][static_cast<std::size_t>(motion.component)] += coefficients[k];
  }
  if (all.size() > frozen::kMostGroups) problem = "more than 96 different sets of functions";
  std::stable_sort(all.begin(), all.end(),
                   [](const FrozenFunctions& a, const FrozenFunctions& b) { return a.axis < b.axis; });
  return all;
}

}  // namespace abbe
