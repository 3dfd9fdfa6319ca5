#include "abbe/errors/basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace abbe {
namespace {

std::vector<Basis> all_bases() {
  std::vector<Basis> bases;
  for (BasisKind kind : {BasisKind::monomial, BasisKind::legendre, BasisKind::chebyshev}) {
    bases.push_back({.kind = kind, .order = 6, .from = -20, .to = 180});
  }
  bases.push_back({.kind = BasisKind::fourier, .order = 4, .from = -20, .to = 180, .period = 200});
  bases.push_back({.kind = BasisKind::bspline, .order = 7, .from = -20, .to = 180});
  bases.push_back({.kind = BasisKind::bspline, .order = 7, .from = -20, .to = 180, .period = 200, .periodic = true});
  const std::vector<double> nodes{-20, 0, 15, 60, 100, 180};
  bases.push_back({.kind = BasisKind::table_linear, .from = -20, .to = 180, .nodes = nodes});
  bases.push_back(
      {.kind = BasisKind::table_linear, .from = -20, .to = 180, .period = 230, .periodic = true, .nodes = nodes});
  bases.push_back({.kind = BasisKind::table_monotone, .from = -20, .to = 180, .nodes = nodes});
  return bases;
}

std::vector<double> random_coefficients(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> coefficients(size);
  for (double& c : coefficients) c = normal(generator);
  return coefficients;
}

TEST(Basis, DerivativeByEachCoefficientIsItsFunction) {
  for (const Basis& basis : all_bases()) {
    const std::vector<double> coefficients = random_coefficients(basis.size(), 3);
    std::vector<double> functions(basis.size());
    for (double q : {-19.0, -3.0, 0.5, 33.0, 77.0, 179.0}) {
      basis.values(q, coefficients, functions);
      for (std::size_t k = 0; k < basis.size(); ++k) {
        std::vector<double> more = coefficients, less = coefficients;
        more[k] += 1e-6;
        less[k] -= 1e-6;
        const double difference = (basis.evaluate(q, more) - basis.evaluate(q, less)) / 2e-6;
        EXPECT_NEAR(functions[k], difference, 2e-8) << basis_kind_name(basis.kind) << " " << k << " at " << q;
      }
    }
  }
}

TEST(Basis, SlopeMatchesDifferences) {
  for (const Basis& basis : all_bases()) {
    const std::vector<double> coefficients = random_coefficients(basis.size(), 4);
    for (double q : {-19.0, -3.0, 0.5, 33.0, 77.0, 179.0}) {
      const double difference =
          (basis.evaluate(q + 1e-4, coefficients) - basis.evaluate(q - 1e-4, coefficients)) / 2e-4;
      EXPECT_NEAR(basis.slope(q, coefficients), difference, 1e-6) << basis_kind_name(basis.kind) << " at " << q;
    }
  }
}

TEST(Basis, PolynomialsOfEveryKindSpanTheSameFunctions) {
  // x^3 at s = 0.3 in each basis: s^3 = (3 P1 + 2 P3) / 5 = (3 T1 + T3) / 4.
  Basis basis{.kind = BasisKind::monomial, .order = 3, .from = -1, .to = 1};
  const double expected = 0.027;
  EXPECT_NEAR(basis.evaluate(0.3, std::vector<double>{0, 0, 0, 1}), expected, 1e-16);
  basis.kind = BasisKind::legendre;
  EXPECT_NEAR(basis.evaluate(0.3, std::vector<double>{0, 0.6, 0, 0.4}), expected, 1e-16);
  basis.kind = BasisKind::chebyshev;
  EXPECT_NEAR(basis.evaluate(0.3, std::vector<double>{0, 0.75, 0, 0.25}), expected, 1e-16);
}

TEST(Basis, LegendreAgreesWithTheClosedForm) {
  const Basis basis{.kind = BasisKind::legendre, .order = 4, .from = 0, .to = 1400};
  std::vector<double> p(5);
  const double q = 321.5, s = 2 * q / 1400 - 1;
  basis.values(q, p, p);
  EXPECT_NEAR(p[4], (35 * s * s * s * s - 30 * s * s + 3) / 8, 1e-15);
}

TEST(Basis, SplinesReproduceALineAndSumToOne) {
  const Basis basis{.kind = BasisKind::bspline, .order = 5, .from = 10, .to = 60};
  // Greville abscissae: the control value of spline k is the line at its centre.
  std::vector<double> line(basis.size()), one(basis.size(), 1.0);
  for (std::size_t k = 0; k < line.size(); ++k) line[k] = 2.0 * (10 + 10 * (static_cast<double>(k) - 1)) - 7;
  for (double q = 10; q <= 60; q += 2.5) {
    EXPECT_NEAR(basis.evaluate(q, line), 2 * q - 7, 1e-12);
    EXPECT_NEAR(basis.evaluate(q, one), 1, 1e-14);
  }
}

TEST(Basis, TablesPassThroughTheirNodes) {
  for (const Basis& basis : all_bases()) {
    if (basis.nodes.empty()) continue;
    const std::vector<double> coefficients = random_coefficients(basis.size(), 5);
    for (std::size_t k = 0; k < basis.nodes.size(); ++k) {
      EXPECT_NEAR(basis.evaluate(basis.nodes[k], coefficients), coefficients[k], 1e-13);
    }
  }
}

TEST(Basis, MonotoneTableDoesNotOvershoot) {
  const Basis basis{.kind = BasisKind::table_monotone, .from = 0, .to = 6, .nodes = {0, 1, 2, 3, 3.5, 6}};
  const std::vector<double> steps{0, 0, 0.1, 5, 5, 9};
  double previous = basis.evaluate(0, steps);
  for (double q = 0; q <= 6; q += 1.0 / 64) {
    const double value = basis.evaluate(q, steps);
    EXPECT_GE(value, previous - 1e-14);
    previous = value;
  }
}

TEST(Basis, PeriodicBasesCloseTheRing) {
  for (const Basis& basis : all_bases()) {
    if (!basis.periodic) continue;
    const std::vector<double> coefficients = random_coefficients(basis.size(), 6);
    for (double q : {-20.0, 3.0, 150.0, 179.5, 205.0}) {
      EXPECT_NEAR(basis.evaluate(q, coefficients), basis.evaluate(q + basis.period, coefficients), 1e-12);
      EXPECT_NEAR(basis.evaluate(q, coefficients), basis.evaluate(q - 3 * basis.period, coefficients), 1e-12);
    }
    EXPECT_TRUE(basis.covers(1e6));
  }
}

TEST(Basis, OutsideTheRangeIsNotCovered) {
  const Basis polynomial{.kind = BasisKind::legendre, .order = 2, .from = 0, .to = 100};
  EXPECT_TRUE(polynomial.covers(100));
  EXPECT_FALSE(polynomial.covers(100.001));
  EXPECT_FALSE(polynomial.covers(std::nan("")));
  const double turn = 2 * std::numbers::pi;
  EXPECT_TRUE((Basis{.kind = BasisKind::fourier, .order = 2, .from = 0, .to = turn, .period = turn}.covers(40)));
  EXPECT_FALSE((Basis{.kind = BasisKind::fourier, .order = 2, .from = 0, .to = 1, .period = turn}.covers(2)));
}

}  // namespace
}  // namespace abbe
