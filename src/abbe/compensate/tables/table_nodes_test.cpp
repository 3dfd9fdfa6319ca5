#include "abbe/compensate/tables/table_nodes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/errors/basis.h"

namespace abbe {
namespace {

struct Curve {
  std::string name;
  Basis basis;
  std::vector<double> coefficients;
};

/// One curve of every basis, of the size of real errors (mm over 0 to 600 mm).
std::vector<Curve> curves() {
  std::vector<Curve> all;
  const auto add = [&](const std::string& name, BasisKind kind, int order, std::vector<double> coefficients) {
    Basis basis;
    basis.kind = kind;
    basis.order = order;
    basis.from = 0;
    basis.to = 600;
    if (kind == BasisKind::fourier) basis.period = 75;
    if (kind == BasisKind::table_linear || kind == BasisKind::table_monotone) {
      basis.nodes = {0, 41, 133, 250, 251, 397, 600};
    }
    ASSERT_EQ(basis.size(), coefficients.size()) << name;
    all.push_back({name, basis, std::move(coefficients)});
  };
  add("monomial", BasisKind::monomial, 3, {0.002, 0.010, -0.004, 0.003});
  add("legendre", BasisKind::legendre, 6, {0, 0.012, 0.004, -0.003, 0.002, 0.001, -0.001});
  add("chebyshev", BasisKind::chebyshev, 5, {0.001, 0.008, -0.004, 0.002, 0.001, 0.0005});
  add("fourier", BasisKind::fourier, 2, {0.001, 0.002, -0.001, 0.0008, 0.0003});
  add("bspline", BasisKind::bspline, 4, {0.001, 0.004, -0.003, 0.005, 0.002, -0.001, 0.003});
  add("table-linear", BasisKind::table_linear, 0, {0, 0.004, 0.001, 0.006, 0.002, -0.003, 0.001});
  add("table-monotone", BasisKind::table_monotone, 0, {0, 0.004, 0.001, 0.006, 0.005, -0.003, 0.001});
  return all;
}

SampledFunctions sampled(const Curve& curve) {
  return [&curve](std::span<const double> positions, std::vector<std::vector<double>>& values) {
    values.assign(1, {});
    for (const double q : positions) values[0].push_back(curve.basis.evaluate(q, curve.coefficients));
  };
}

/// Largest difference between straight lines and the curve, far more densely than the search looks.
double dense_error(const Curve& curve, const TableNodes& nodes) {
  double largest = 0;
  const std::size_t places = 200000 / nodes.positions.size() + 97;
  for (std::size_t i = 0; i + 1 < nodes.positions.size(); ++i) {
    const double a = nodes.positions[i], b = nodes.positions[i + 1];
    for (std::size_t j = 0; j <= places; ++j) {
      const double share = static_cast<double>(j) / static_cast<double>(places);
      const double line = nodes.values[0][i] + share * (nodes.values[0][i + 1] - nodes.values[0][i]);
      largest = std::max(
          largest, std::abs(line - curve.basis.evaluate(std::min(a + share * (b - a), 600.0), curve.coefficients)));
    }
  }
  return largest;
}

TEST(TableNodes, StraightLinesKeepToTheLimitForEveryBasisAsDenseSamplingShows) {
  for (const Curve& curve : curves()) {
    NodeSpacing spacing;
    spacing.to = 600;
    spacing.tolerance = {1e-4};
    spacing.step_multiple = 0.001;
    const TableNodes nodes = choose_nodes(sampled(curve), spacing);
    ASSERT_TRUE(nodes.within) << curve.name;
    EXPECT_EQ(nodes.positions.front(), 0) << curve.name;
    EXPECT_EQ(nodes.positions.back(), 600) << curve.name;
    const double dense = dense_error(curve, nodes);
    EXPECT_LE(dense, nodes.error[0]) << curve.name;
    EXPECT_LE(nodes.error[0], 1e-4) << curve.name;
    EXPECT_GT(dense, 0) << curve.name;
  }
}

TEST(TableNodes, AQuadraticNeedsTheNodesThatItsCurvatureAsksFor) {
  const SampledFunctions square = [](std::span<const double> positions, std::vector<std::vector<double>>& values) {
    values.assign(1, {});
    for (const double q : positions) values[0].push_back(1e-6 * q * q);
  };
  NodeSpacing spacing;
  spacing.to = 400;
  spacing.tolerance = {1e-4};
  // f'' h^2 / 8 <= 1e-4 with f'' = 2e-6 and the margin of 1.05: h <= 19.52, 21 intervals.
  const TableNodes nodes = choose_nodes(square, spacing);
  EXPECT_EQ(nodes.positions.size(), 22U);
  spacing.step_multiple = 0.5;
  const TableNodes rounded = choose_nodes(square, spacing);
  EXPECT_EQ(rounded.positions.size(), 26U) << "400 / 25 = 16 is the first step in halves";
}

TEST(TableNodes, AGridOnAllKinksIsTakenWhereItNeedsFewerNodes) {
  Curve steps{"table-linear", {}, {}};
  steps.basis.kind = BasisKind::table_linear;
  steps.basis.to = 600;
  for (int k = 0; k <= 10; ++k) {
    steps.basis.nodes.push_back(60 * k);
    steps.coefficients.push_back(k % 2 == 0 ? 0.004 : -0.003);
  }
  NodeSpacing spacing;
  spacing.to = 600;
  spacing.tolerance = {1e-4};
  spacing.step_multiple = 0.001;
  spacing.most = 250;
  EXPECT_FALSE(choose_nodes(sampled(steps), spacing).within) << "halving intervals does not come upon it";
  spacing.kinks = steps.basis.nodes;
  const TableNodes nodes = choose_nodes(sampled(steps), spacing);
  EXPECT_TRUE(nodes.within);
  EXPECT_EQ(nodes.positions.size(), 11U);
  EXPECT_LE(dense_error(steps, nodes), 1e-15);
  spacing.most = 8;
  EXPECT_FALSE(choose_nodes(sampled(steps), spacing).within);
  // No even grid has few nodes on all of these: as without them.
  const Curve uneven = curves()[5];
  NodeSpacing other;
  other.to = 600;
  other.tolerance = {1e-4};
  const TableNodes without = choose_nodes(sampled(uneven), other);
  other.kinks = uneven.basis.nodes;
  EXPECT_LE(choose_nodes(sampled(uneven), other).positions.size(), without.positions.size());
  // Where much is allowed, fewer nodes beside the kinks do.
  spacing.tolerance = {0.1};
  spacing.most = 250;
  EXPECT_LT(choose_nodes(sampled(steps), spacing).positions.size(), 11U);
}

TEST(TableNodes, KinksAreTheNodesOfStraightLineTablesOfTheAxis) {
  ErrorSet errors;
  for (const BasisKind kind : {BasisKind::table_linear, BasisKind::table_monotone}) {
    for (const std::size_t axis : {0U, 1U}) {
      ErrorMotion motion;
      motion.axis = axis;
      motion.basis.kind = kind;
      motion.basis.nodes = {0, 10.0 + static_cast<double>(axis), 30};
      motion.coefficients = {0, 1e-3, 2e-3};
      errors.motions.push_back(motion);
    }
  }
  EXPECT_EQ(kinks_of(errors, 1), (std::vector<double>{0, 11, 30}));
  EXPECT_TRUE(kinks_of(errors, 2).empty());
}

TEST(TableNodes, TooFewNodesAreSaidWithTheErrorReached) {
  const std::vector<Curve> all = curves();
  NodeSpacing spacing;
  spacing.to = 600;
  spacing.tolerance = {1e-6};
  spacing.most = 20;
  const TableNodes nodes = choose_nodes(sampled(all[3]), spacing);
  EXPECT_FALSE(nodes.within);
  EXPECT_EQ(nodes.positions.size(), 20U);
  EXPECT_GE(nodes.error[0], dense_error(all[3], nodes));
}

TEST(TableNodes, AnAxisThatDoesNotMoveHasOneNode) {
  const std::vector<Curve> all = curves();
  NodeSpacing spacing;
  spacing.from = spacing.to = 100;
  spacing.tolerance = {1e-6};
  const TableNodes nodes = choose_nodes(sampled(all[0]), spacing);
  EXPECT_EQ(nodes.positions, std::vector<double>{100});
  EXPECT_TRUE(nodes.within);
}

}  // namespace
}  // namespace abbe
