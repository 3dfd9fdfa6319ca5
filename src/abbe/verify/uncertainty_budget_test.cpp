#include "abbe/verify/uncertainty_budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace abbe {
namespace {

/// Two kinds at three points; straight in a and b, bent in c.
Eigen::MatrixXd model(const std::vector<double>& x, double bend) {
  Eigen::MatrixXd result(2, 3);
  for (int p = 0; p < 3; ++p) {
    result(0, p) = 5 + (p + 1) * x[0] + 2 * x[1] + bend * x[3] * x[3];
    result(1, p) = x[2] - p * x[1];
  }
  return result;
}

const std::vector<BudgetInput> kInputs = {{"a", 0.1}, {"b", 0.2}, {"a", 0.3}, {"c", 1.0}};

TEST(UncertaintyBudget, BothWaysGiveWhatTheFormulaSays) {
  BudgetOptions options;
  options.runs = 4000;
  options.runs_per_cause = 1500;
  std::size_t calls = 0;
  const UncertaintyBudget budget = uncertainty_budget([](const auto& x) { return model(x, 0); }, kInputs, options,
                                                      [&](const Eigen::MatrixXd& result) {
                                                        ++calls;
                                                        EXPECT_NEAR(result(0, 0), 5, 5);
                                                      });
  EXPECT_EQ(calls, 4000U);
  ASSERT_EQ(budget.lines.size(), 3U);
  // Kind 0: (p + 1) 0.1 and 2 * 0.2 at p = 0, 1, 2; kind 1: 0.3 and p 0.2.
  const double a0 = 0.01 * (1 + 4 + 9) / 3, b0 = 0.16, a1 = 0.09, b1 = 0.04 * (0 + 1 + 4) / 3;
  EXPECT_EQ(budget.lines[0].cause, "b");
  EXPECT_EQ(budget.lines[1].cause, "a");
  EXPECT_EQ(budget.lines[1].inputs, 2U);
  EXPECT_NEAR(budget.lines[0].kinds[0].by_sensitivity, std::sqrt(b0), 1e-12);
  EXPECT_NEAR(budget.lines[0].kinds[1].by_sensitivity, std::sqrt(b1), 1e-12);
  EXPECT_NEAR(budget.lines[1].kinds[0].by_sensitivity, std::sqrt(a0), 1e-12);
  EXPECT_NEAR(budget.lines[1].kinds[1].by_sensitivity, std::sqrt(a1), 1e-12);
  EXPECT_NEAR(budget.lines[0].share, (b0 + b1) / (a0 + a1 + b0 + b1), 1e-12);
  EXPECT_NEAR(budget.total[0].by_sensitivity, std::sqrt(a0 + b0), 1e-12);
  EXPECT_EQ(budget.lines[2].share, 0);
  EXPECT_LT(budget.largest_disagreement(), 3.5);
  // Chi-square of one degree of freedom: its mean scatters by sqrt(2 / runs), the root by half of that.
  EXPECT_NEAR(budget.lines[0].kinds[0].monte_carlo_uncertainty, std::sqrt(b0) * std::sqrt(2 / 1500.0) / 2,
              0.1 * std::sqrt(b0) * std::sqrt(2 / 1500.0));
}

TEST(UncertaintyBudget, ABentModelShowsAsDisagreement) {
  const UncertaintyBudget budget = uncertainty_budget([](const auto& x) { return model(x, 0.5); }, kInputs);
  EXPECT_GT(budget.largest_disagreement(), 5);
  EXPECT_NEAR(budget.lines.back().kinds[0].by_sensitivity, 0, 1e-12);
  EXPECT_GT(budget.lines.back().kinds[0].by_monte_carlo, 0.5);
}

TEST(UncertaintyBudget, SameSeedSameNumbersAndShapesMayNotChange) {
  const auto straight = [](const std::vector<double>& x) { return model(x, 0); };
  BudgetOptions options;
  options.runs = options.runs_per_cause = 20;
  const UncertaintyBudget once = uncertainty_budget(straight, kInputs, options),
                          again = uncertainty_budget(straight, kInputs, options);
  EXPECT_EQ(once.total[0].by_monte_carlo, again.total[0].by_monte_carlo);
  options.seed = 2;
  EXPECT_NE(once.total[0].by_monte_carlo, uncertainty_budget(straight, kInputs, options).total[0].by_monte_carlo);
  int calls = 0;
  EXPECT_THROW(uncertainty_budget([&](const auto&) { return Eigen::MatrixXd::Zero(1, ++calls).eval(); }, kInputs),
               std::invalid_argument);
}

}  // namespace
}  // namespace abbe
