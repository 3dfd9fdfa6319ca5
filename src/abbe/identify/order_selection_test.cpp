#include "abbe/identify/order_selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/function_observations_test.h"

namespace abbe {
namespace {

using Complex = FunctionObservations::Complex;
constexpr double kValueNoise = 0.01;
constexpr std::size_t kReadings = 150;

double position(std::size_t reading) { return static_cast<double>(reading) / kReadings; }

/// Spline or table of that many intervals over [0, 1].
Basis with_intervals(BasisKind kind, int intervals) {
  Basis basis{.kind = kind, .order = intervals, .from = 0, .to = 1};
  if (kind == BasisKind::table_linear) {
    for (int k = 0; k <= intervals; ++k) basis.nodes.push_back(static_cast<double>(k) / intervals);
  }
  return basis;
}

std::vector<double> readings(const Basis& basis, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<double> coefficients(basis.size());
  // Alternating, so that every knot is needed.
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] = (k % 2 ? 1 : -1) * random.uniform(0.5, 1.5);
  std::vector<double> data;
  for (std::size_t i = 0; i < kReadings; ++i)
    data.push_back(basis.evaluate(position(i), coefficients) + kValueNoise * random.normal());
  return data;
}

/// Problems whose unknowns are the coefficients of one basis.
class Splines {
 public:
  Splines(BasisKind kind, std::vector<double> data) : kind_(kind), data_(std::move(data)) {}

  Problem at(const std::vector<int>& orders) {
    const Basis basis = with_intervals(kind_, orders[0]);
    observations_ = std::make_unique<FunctionObservations>(
        basis.size(), 1, data_, kValueNoise, [basis](std::size_t k, std::size_t, const std::vector<Complex>& b) {
          std::vector<double> values(basis.size());
          basis.values(position(k), {}, values);
          Complex sum = 0;
          for (std::size_t i = 0; i < values.size(); ++i) sum += values[i] * b[i];
          return sum;
        });
    return function_problem({observations_.get()});
  }

 private:
  BasisKind kind_;
  std::vector<double> data_;
  std::unique_ptr<FunctionObservations> observations_;
};

TEST(OrderSelection, finds_the_number_of_intervals_of_splines_and_tables) {
  OrderGroup group;
  group.name = "X intervals";
  group.motions = {0};
  group.largest_order = 12;
  group.nested = false;
  OrderSelectionOptions options;
  options.significance = 0.01;
  int found = 0, tried = 0;
  for (const BasisKind kind : {BasisKind::bspline, BasisKind::table_linear})
    for (const int intervals : {1, 2, 4, 7})
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        Splines splines(kind, readings(with_intervals(kind, intervals), seed));
        const OrderSelection selection =
            select_orders([&](const std::vector<int>& orders) { return splines.at(orders); }, {group}, options);
        ASSERT_TRUE(selection.done);
        ++tried;
        found += selection.orders[0] == intervals;
        EXPECT_GE(selection.orders[0], intervals) << basis_kind_name(kind) << " seed " << seed;
        EXPECT_LE(selection.orders[0], 2 * intervals) << basis_kind_name(kind) << " seed " << seed;
        for (const OrderTrial& trial : selection.trials) {
          if (trial.orders != selection.orders) continue;
          EXPECT_NEAR(trial.held_out_rms, 1, 0.2);
        }
      }
  // A spline with more intervals is taken for better by chance now and then: the test's significance.
  EXPECT_GE(found, tried - 1);
}

TEST(OrderSelection, a_term_too_small_for_a_test_of_significance_is_taken_on_average) {
  constexpr int kSeeds = 30;
  // A curvature of 2.5 times its standard uncertainty, or none.
  const auto taken = [](double curvature, bool nested) {
    int count = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      RandomStream random(seed);
      const Basis basis{.kind = BasisKind::legendre, .order = 2, .from = 0, .to = 1};
      const std::vector<double> coefficients{1, -0.8, curvature * kValueNoise * std::sqrt(5.0 / kReadings)};
      std::vector<double> data;
      for (std::size_t i = 0; i < kReadings; ++i)
        data.push_back(basis.evaluate(position(i), coefficients) + kValueNoise * random.normal());
      Splines polynomials(BasisKind::legendre, data);
      const OrderGroup group{.name = "X", .motions = {0}, .start_order = 1, .largest_order = 2, .nested = nested};
      const ProblemAtOrders at = [&](const std::vector<int>& orders) { return polynomials.at(orders); };
      count += select_orders(at, {group}).orders[0] == 2;
    }
    return count;
  };
  EXPECT_GE(taken(2.5, true), 2 * kSeeds / 3);
  EXPECT_LE(taken(0, true), kSeeds / 3);
  // Groups that are not nested are raised by the test.
  EXPECT_LE(taken(2.5, false), kSeeds / 2);
}

TEST(OrderSelection, exact_readings_raise_no_order_beyond_the_truth) {
  constexpr int kPolynomialDegree = 3;
  const Basis basis{.kind = BasisKind::legendre, .order = kPolynomialDegree, .from = 0, .to = 1};
  std::vector<double> data;
  for (std::size_t i = 0; i < kReadings; ++i)
    data.push_back(basis.evaluate(position(i), std::vector<double>{1, -0.8, 0.3, 0.1}));
  for (const bool nested : {true, false}) {
    Splines polynomials(BasisKind::legendre, data);
    const OrderGroup group{.name = "X", .motions = {0}, .start_order = 1, .largest_order = 7, .nested = nested};
    const OrderSelection selection =
        select_orders([&](const std::vector<int>& orders) { return polynomials.at(orders); }, {group});
    EXPECT_EQ(selection.orders[0], kPolynomialDegree);
    // Nothing above it is even tried, where one order follows the other.
    if (nested) {
      EXPECT_EQ(selection.trials.back().orders[0], kPolynomialDegree);
    }
  }
}

TEST(OrderSelection, gross_errors_and_a_start_far_too_low_do_not_hide_the_order) {
  constexpr int kPolynomialDegree = 4;
  const auto legendre = [](int degree) {
    return Basis{.kind = BasisKind::legendre, .order = degree, .from = 0, .to = 1};
  };
  for (const LossKind loss : {LossKind::huber, LossKind::cauchy, LossKind::tukey}) {
    std::vector<double> data = readings(legendre(kPolynomialDegree), 5);
    for (std::size_t i = 3; i < data.size(); i += 30) data[i] += 100 * kValueNoise;
    Splines polynomials(BasisKind::legendre, data);
    OrderGroup group{.name = "X", .motions = {0}, .start_order = 1, .largest_order = 7};
    OrderSelectionOptions options;
    options.identify.loss = loss;
    const OrderSelection selection =
        select_orders([&](const std::vector<int>& orders) { return polynomials.at(orders); }, {group}, options);
    ASSERT_TRUE(selection.done);
    EXPECT_EQ(selection.orders[0], kPolynomialDegree);
    EXPECT_GT(selection.trials.front().held_out_rms, 3 * selection.trials.back().held_out_rms);
  }
}

TEST(OrderSelection, orders_that_cannot_be_identified_are_passed_over) {
  constexpr int kPolynomialDegree = 3;
  const std::vector<double> data =
      readings(Basis{.kind = BasisKind::legendre, .order = kPolynomialDegree, .from = 0, .to = 1}, 11);
  Splines polynomials(BasisKind::legendre, data);
  OrderGroup group{.name = "X", .motions = {0}, .start_order = 1, .largest_order = 5};
  // The first model has no readings left to be identified from.
  const ProblemAtOrders at = [&](const std::vector<int>& orders) {
    Problem problem = polynomials.at(orders);
    if (orders[0] < 2) problem.observations[0].use.assign(kReadings, 0);
    return problem;
  };
  const OrderSelection selection = select_orders(at, {group});
  ASSERT_TRUE(selection.done);
  EXPECT_EQ(selection.orders[0], kPolynomialDegree);
  EXPECT_EQ(selection.trials[0].status != IdentifyStatus::converged, true);
  EXPECT_EQ(selection.trials[1].raised, "all");
}

TEST(OrderSelection, splines_and_tables_are_groups_of_their_own) {
  Machine machine;
  machine.axes = {Axis{.name = "C", .kind = AxisKind::rotary}, Axis{.name = "X"}};
  ErrorSet errors;
  const auto add = [&](std::size_t axis, Basis basis) {
    ErrorMotion motion{axis, Component::X, std::move(basis), {}, {}};
    motion.coefficients.assign(motion.basis.size(), 1.0);
    errors.motions.push_back(motion);
  };
  add(1, with_intervals(BasisKind::bspline, 6));
  add(0, Basis{.kind = BasisKind::fourier, .order = 3, .period = 1});
  add(1, Basis{.kind = BasisKind::legendre, .order = 4, .to = 1});
  add(1, with_intervals(BasisKind::table_linear, 8));
  const std::vector<OrderGroup> groups = order_groups_by_axis(machine, errors);
  ASSERT_EQ(groups.size(), 3u);
  EXPECT_EQ(groups[0].name, "C");
  EXPECT_EQ(groups[1].name, "X");
  EXPECT_EQ(groups[1].motions, (std::vector<std::size_t>{2}));
  EXPECT_EQ(groups[2].name, "X intervals");
  EXPECT_EQ(groups[2].motions, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(groups[2].largest_order, 8);
  EXPECT_FALSE(groups[2].nested);

  Problem problem;
  problem.errors = errors;
  for (std::size_t i = 0; i < errors.parameter_count(); ++i) problem.machine_parameters.push_back(i);
  const Problem lower = at_nested_orders(problem, groups, {1, 2, 3});
  // 9 of the spline, 3 of 7 harmonics, 3 of 5 degrees, 9 of the table, 3 of the tool.
  EXPECT_EQ(lower.machine_parameters.size(), 9u + 3 + 3 + 9 + 3);
  EXPECT_EQ(lower.errors.motions[1].coefficients, (std::vector<double>{1, 1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(lower.errors.motions[0].coefficients, std::vector<double>(9, 1.0));
}

}  // namespace
}  // namespace abbe
