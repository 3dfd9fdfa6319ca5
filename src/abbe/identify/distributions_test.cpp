#include "abbe/identify/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace abbe {
namespace {

TEST(Distributions, chi_square_agrees_with_closed_forms) {
  // Two degrees of freedom: exp(-x/2); one: erfc(sqrt(x/2)); four: exp(-x/2)(1 + x/2).
  for (const double x : {0.01, 0.5, 1.0, 3.0, 10.0, 60.0}) {
    EXPECT_NEAR(chi_square_exceedance(x, 2) / std::exp(-x / 2), 1, 1e-13);
    EXPECT_NEAR(chi_square_exceedance(x, 1) / std::erfc(std::sqrt(x / 2)), 1, 1e-12);
    EXPECT_NEAR(chi_square_exceedance(x, 4) / (std::exp(-x / 2) * (1 + x / 2)), 1, 1e-13);
  }
  EXPECT_EQ(chi_square_exceedance(0, 5), 1);
}

TEST(Distributions, quantiles_agree_with_the_printed_table) {
  // Abramowitz and Stegun, Table 26.8.
  EXPECT_NEAR(chi_square_quantile(0.05, 3), 7.81473, 5e-6);
  EXPECT_NEAR(chi_square_quantile(0.01, 10), 23.2093, 5e-5);
  EXPECT_NEAR(chi_square_quantile(0.95, 30), 18.4927, 5e-5);
}

TEST(Distributions, fisher_agrees_with_the_printed_table_and_with_its_limits) {
  // Abramowitz and Stegun, Table 26.9.
  EXPECT_NEAR(fisher_quantile(0.05, 3, 10), 3.71, 5e-3);
  EXPECT_NEAR(fisher_quantile(0.01, 6, 6), 8.47, 5e-3);
  EXPECT_NEAR(fisher_quantile(0.001, 10, 30), 4.24, 5e-3);
  // One degree above: the square of Student's t on both sides. Many below: chi-square over its degrees of freedom.
  for (const double t : {0.5, 2.0, 40.0}) {
    EXPECT_NEAR(fisher_quantile(2 * student_exceedance(t, 7), 1, 7) / (t * t), 1, 1e-10);
  }
  EXPECT_NEAR(6 * fisher_quantile(1e-6 / 3, 6, 1e8) / chi_square_quantile(1e-6 / 3, 6), 1, 1e-6);
  // Two and two: exceeded with 1 / (1 + x).
  EXPECT_NEAR(fisher_quantile(1e-9, 2, 2) / (1e9 - 1), 1, 1e-9);
}

TEST(Distributions, large_degrees_of_freedom_approach_the_normal_distribution) {
  const double n = 3e5;
  // Wilson and Hilferty.
  const double z = (std::cbrt(1.002) - (1 - 2 / (9 * n))) / std::sqrt(2 / (9 * n));
  EXPECT_NEAR(chi_square_exceedance(1.002 * n, n), std::erfc(z / std::sqrt(2.0)) / 2, 1e-6);
}

TEST(Distributions, student_agrees_with_closed_forms) {
  for (const double t : {-3.0, -0.5, 0.0, 0.7, 2.0, 12.0}) {
    EXPECT_NEAR(student_exceedance(t, 1), 0.5 - std::atan(t) / std::acos(-1.0), 1e-13);
    EXPECT_NEAR(student_exceedance(t, 2), 0.5 - t / (2 * std::sqrt(2 + t * t)), 1e-13);
  }
  EXPECT_NEAR(student_exceedance(2.228, 10), 0.025, 1e-5);
}

TEST(Distributions, a_sum_is_judged_by_the_scatter_of_its_values) {
  // t = 6 / sqrt(3) with two degrees of freedom.
  EXPECT_NEAR(sum_exceedance(std::vector<double>{1, 2, 3}, 0), 0.5 - std::sqrt(12.0 / 14) / 2, 1e-13);
  EXPECT_NEAR(sum_exceedance(std::vector<double>{1, 2, 3}, 6), 0.5, 1e-13);
  EXPECT_GT(sum_exceedance(std::vector<double>{1, 2, 3}, 7), 0.5);
  EXPECT_EQ(sum_exceedance(std::vector<double>{2, 2, 2}, 5), 0);
  EXPECT_EQ(sum_exceedance(std::vector<double>{2, 2, 2}, 6), 1);
  EXPECT_EQ(sum_exceedance(std::vector<double>{1, 2}, 0), 1) << "too few to show a scatter";
}

TEST(Distributions, incomplete_beta_is_symmetric_and_matches_powers) {
  EXPECT_NEAR(incomplete_beta(3, 1, 0.4), 0.064, 1e-15);
  EXPECT_NEAR(incomplete_beta(2.5, 4.5, 0.3) + incomplete_beta(4.5, 2.5, 0.7), 1, 1e-14);
}

}  // namespace
}  // namespace abbe
