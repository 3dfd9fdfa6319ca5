#include "abbe/compensate/error_function_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace abbe {
namespace {

struct Sampled {
  double value = 0, slope = 0, bend = 0, jumps = 0;
};

/// Largest values by dense sampling; bends by differences of slopes within pieces.
Sampled sample(const Basis& basis, const std::vector<double>& c, double from, double to) {
  Sampled found;
  constexpr int kSteps = 400;
  const double step = (to - from) / kSteps;
  double before = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double q = from + step * (i + 0.5);
    found.value = std::max(found.value, std::abs(basis.evaluate(q, c)));
    const double slope = basis.slope(q, c);
    found.slope = std::max(found.slope, std::abs(slope));
    const double change = i > 0 ? std::abs(slope - before) : 0;
    if (basis.kind == BasisKind::table_linear) {
      found.jumps += change;
    } else {
      found.bend = std::max(found.bend, change / step);
    }
    before = slope;
  }
  return found;
}

std::vector<Basis> all_bases() {
  Basis legendre{.kind = BasisKind::legendre, .order = 8, .from = -200, .to = 300};
  Basis chebyshev = legendre, monomial = legendre, spline = legendre, table = legendre, monotone = legendre;
  chebyshev.kind = BasisKind::chebyshev;
  chebyshev.order = 11;
  monomial.kind = BasisKind::monomial;
  monomial.order = 5;
  spline.kind = BasisKind::bspline;
  spline.order = 7;
  table.kind = BasisKind::table_linear;
  table.nodes = {-200, -150, -30, 40, 41, 160, 300};
  monotone = table;
  monotone.kind = BasisKind::table_monotone;
  Basis fourier{.kind = BasisKind::fourier, .order = 4, .from = 0, .to = 360, .period = 360};
  Basis ring{.kind = BasisKind::bspline, .order = 9, .from = 0, .to = 360, .period = 360, .periodic = true};
  Basis closed{.kind = BasisKind::table_linear,
               .from = 10,
               .to = 300,
               .period = 360,
               .periodic = true,
               .nodes = {10, 100, 170, 300}};
  return {legendre, chebyshev, monomial, spline, table, monotone, fourier, ring, closed};
}

TEST(ErrorFunctionBound, NoSampleExceedsItAndItIsTightOverShortIntervals) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> place(-190, 290), exponent(-1.5, 2.3);
  for (const Basis& basis : all_bases()) {
    SCOPED_TRACE(basis_kind_name(basis.kind));
    double loosest_bend = 0;
    for (int n = 0; n < 300; ++n) {
      std::vector<double> c(basis.size());
      for (double& value : c) value = normal(generator);
      const double width = std::pow(10, exponent(generator));
      const double from = place(generator), to = from + width;
      const FunctionBound bound = bound_function(basis, c, from, to);
      const Sampled found = sample(basis, c, from, to);
      ASSERT_LE(found.value, bound.value * (1 + 1e-9));
      ASSERT_LE(found.slope, bound.slope * (1 + 1e-9) + 1e-13);
      ASSERT_LE(found.bend, bound.bend * (1 + 1e-6) + 1e-9);
      ASSERT_LE(found.jumps, bound.jumps * (1 + 1e-9) + 1e-12);
      if (width < 2) {
        EXPECT_LE(bound.value, found.value * 1.5 + 0.05);
        if (basis.kind == BasisKind::table_linear) {
          EXPECT_LE(bound.jumps, found.jumps + 1e-9);
          EXPECT_LE(bound.bend, 1e-6);
        } else {
          loosest_bend = std::max(loosest_bend, bound.bend / (found.bend + 1e-4));
        }
      }
    }
    EXPECT_LE(loosest_bend, 2.0);
  }
}

TEST(ErrorFunctionBound, AKinkIsCountedOnceByNeighbouringIntervals) {
  const Basis table{.kind = BasisKind::table_linear, .from = 0, .to = 30, .nodes = {0, 10, 20, 30}};
  const std::vector<double> c = {0, 1, 0, 2};
  const double left = bound_function(table, c, 0, 10).jumps, right = bound_function(table, c, 10, 20).jumps;
  EXPECT_EQ(left, 0);
  EXPECT_NEAR(right, 0.2, 1e-8);
  EXPECT_NEAR(bound_function(table, c, 1, 29).jumps, 0.2 + 0.3, 1e-8);
}

TEST(ErrorFunctionBound, BeyondAPeriodKinksCountAsOftenAsTheyArePassed) {
  const Basis closed{.kind = BasisKind::table_linear,
                     .from = 0,
                     .to = 270,
                     .period = 360,
                     .periodic = true,
                     .nodes = {0, 90, 180, 270}};
  const std::vector<double> c = {0, 1, 0, -1};
  // Jumps of 2/90 at two nodes of a turn.
  const double five_turns = 5 * 2 * 2.0 / 90;
  const FunctionBound bound = bound_function(closed, c, 1, 1 + 5 * 360);
  EXPECT_GE(bound.jumps, five_turns * (1 - 1e-12));
  EXPECT_LE(bound.jumps, 2.5 * five_turns);
  EXPECT_NEAR(bound.value, 1, 1e-6);
}

}  // namespace
}  // namespace abbe
