#include "abbe/identify/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
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
  EXPECT_NEAR(fisher_quantile(1e-9, 2, 2) / (1e9 - 1), 1, 1e-14);
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

// Reference values of mpmath with 60 digits, rounded to 20; the arguments are the nearest doubles.
struct Reference {
  double first, second, value;
};
struct ReferenceOfThree {
  double first, second, third, value;
};

TEST(Distributions, tails_agree_with_twenty_digits_for_1_and_for_a_million_degrees_of_freedom) {
  for (const Reference& r : std::initializer_list<Reference>{{1e-12, 1, 0.99999920211543919727},
                                                             {50, 1, 1.5374597944280348502e-12},
                                                             {700, 1, 2.9902269751246203369e-154},
                                                             {40, 3, 1.0655090334255860815e-8},
                                                             {300, 30, 2.6480484856308777146e-46},
                                                             {1e6, 1e6, 0.49981193680339449952},
                                                             {990000, 1e6, 0.99999999999934998288},
                                                             {1010000, 1e6, 9.0685288232620768642e-13},
                                                             {1020000, 1e6, 3.8839118311893804619e-45}}) {
    EXPECT_NEAR(chi_square_exceedance(r.first, r.second) / r.value, 1, 5e-11) << r.first << " with " << r.second;
  }
  for (const Reference& r : std::initializer_list<Reference>{{1e-08, 1, 0.49999999681690113816},
                                                             {1e-08, 2, 0.49999999646446609407},
                                                             {1e-08, 30, 0.49999999604367815106},
                                                             {1e-08, 1e6, 0.49999999601057819334},
                                                             {0.5, 1, 0.35241638234956672582},
                                                             {0.5, 2, 0.33333333333333333333},
                                                             {0.5, 30, 0.31036150244256364298},
                                                             {0.5, 1e6, 0.30853759373618569389},
                                                             {7, 1, 0.045167235300866548351},
                                                             {7, 2, 0.0099019705901965687647},
                                                             {7, 30, 4.4349793336103215849e-8},
                                                             {7, 1e6, 1.2806120556870394286e-12},
                                                             {-7, 1, 0.95483276469913345165},
                                                             {-7, 2, 0.99009802940980343124},
                                                             {-7, 30, 0.9999999556502066639},
                                                             {-7, 1e6, 0.99999999999871938794},
                                                             {1e6, 1, 3.1830988618368456824e-7},
                                                             {1e6, 2, 4.9999999999925e-13},
                                                             {1e6, 30, 1.0364534648043777589e-159}}) {
    EXPECT_NEAR(student_exceedance(r.first, r.second) / r.value, 1, 1e-14) << r.first << " with " << r.second;
  }
  EXPECT_EQ(student_exceedance(1e6, 1e6), 0) << "below the smallest double";
}

TEST(Distributions, quantiles_agree_with_twenty_digits_for_1_and_for_a_million_degrees_of_freedom) {
  for (const Reference& r : std::initializer_list<Reference>{{1e-12, 1, 50.844127911818155585},
                                                             {1e-12, 7, 70.838428255826073683},
                                                             {1e-12, 1e6, 1009980.6085140438338},
                                                             {0.0455, 1, 4.000009775604388286},
                                                             {0.0455, 7, 14.337126778914232998},
                                                             {0.0455, 1e6, 1002391.4647690494823},
                                                             {0.5, 1, 0.45493642311957275194},
                                                             {0.5, 7, 6.3458111955215175357},
                                                             {0.5, 1e6, 999999.33333341234574},
                                                             {0.999999999999, 1, 1.5707268301301795183e-24},
                                                             {0.999999999999, 7, 0.0015031355326853627525},
                                                             {0.999999999999, 1e6, 990084.03236013257633}}) {
    EXPECT_NEAR(chi_square_quantile(r.first, r.second) / r.value, 1, 1e-14) << r.first << " with " << r.second;
  }
  for (const ReferenceOfThree& r :
       std::initializer_list<ReferenceOfThree>{{1e-12, 1, 1, 4.0528473456935110208e+23},
                                               {1e-12, 1, 1e6, 50.845445919651586379},
                                               {1e-12, 1e6, 1, 6.3661945405777476241e+23},
                                               {1e-12, 3, 10, 1018.2155264543961812},
                                               {1e-12, 1e6, 1e6, 1.0141684637433974288},
                                               {0.05, 1, 1, 161.4476387975884777},
                                               {0.05, 1, 1e6, 3.8414681198431634422},
                                               {0.05, 1e6, 1, 254.31431689336853315},
                                               {0.05, 3, 10, 3.7082648190468444017},
                                               {0.05, 1e6, 1e6, 1.0032951258486101157},
                                               {0.999999999999, 1, 1, 2.467291935166677536e-24},
                                               {0.999999999999, 1, 1e6, 1.5707276154937909241e-24},
                                               {0.999999999999, 1e6, 1, 0.019667427984883157878},
                                               {0.999999999999, 3, 10, 7.690554718677631023e-9},
                                               {0.999999999999, 1e6, 1e6, 0.98602947102035549456}}) {
    EXPECT_NEAR(fisher_quantile(r.first, r.second, r.third) / r.value, 1, 1e-14)
        << r.first << " with " << r.second << " and " << r.third;
  }
}

TEST(Distributions, a_fisher_quantile_is_exceeded_with_its_probability) {
  for (int upper = 1; upper <= 40; ++upper) {
    for (int lower = 1; lower <= 40; ++lower) {
      for (const double tail : {1e-12, 1e-9, 3e-7, 1e-3, 0.3, 0.8}) {
        const double x = fisher_quantile(tail, upper, lower), share = lower / (lower + upper * x);
        EXPECT_NEAR(incomplete_beta(lower / 2.0, upper / 2.0, share) / tail, 1, 1e-10) << upper << " over " << lower;
      }
    }
  }
}

TEST(Distributions, incomplete_beta_agrees_with_twenty_digits) {
  for (const ReferenceOfThree& r :
       std::initializer_list<ReferenceOfThree>{{2, 1e6, 1e-09, 4.9966729163309083862e-7},
                                               {2, 1e6, 1e-12, 5.000001666667916466e-13},
                                               {40, 961, 0.01, 4.6885535662498059402e-13},
                                               {0.5, 0.5, 1e-16, 6.3661977236758134703e-9},
                                               {1e6, 1e6, 0.497, 1.0752901880554232049e-17}}) {
    EXPECT_NEAR(incomplete_beta(r.first, r.second, r.third) / r.value, 1, 1e-12) << r.first << ", " << r.second;
  }
}

TEST(Distributions, nothing_throws_for_arguments_outside_the_range) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double degrees : {-1.0, 0.0, nan}) {
    EXPECT_TRUE(std::isnan(chi_square_exceedance(1, degrees))) << degrees;
    EXPECT_TRUE(std::isnan(chi_square_quantile(0.5, degrees))) << degrees;
    EXPECT_TRUE(std::isnan(fisher_quantile(0.5, degrees, 3))) << degrees;
    EXPECT_TRUE(std::isnan(fisher_quantile(0.5, 3, degrees))) << degrees;
    EXPECT_TRUE(std::isnan(student_exceedance(2, degrees))) << degrees;
    EXPECT_TRUE(std::isnan(student_exceedance(0.5, degrees))) << degrees;
  }
  for (const double probability : {-0.5, 1.5, nan}) {
    EXPECT_TRUE(std::isnan(chi_square_quantile(probability, 3))) << probability;
    EXPECT_TRUE(std::isnan(fisher_quantile(probability, 3, 4))) << probability;
  }
  EXPECT_TRUE(std::isnan(student_exceedance(nan, 3)));
  EXPECT_EQ(student_exceedance(infinity, 3), 0);
  EXPECT_EQ(student_exceedance(-infinity, 3), 1);
  EXPECT_EQ(chi_square_exceedance(infinity, 3), 0);
  EXPECT_EQ(chi_square_exceedance(-1, 3), 1);
  EXPECT_EQ(incomplete_beta(2, 3, -1), 0);
  EXPECT_EQ(incomplete_beta(2, 3, 2), 1);
}

TEST(Distributions, hypergeometric_exceedance_agrees_with_counting) {
  const auto exceedance = [](std::size_t all, std::size_t marked, std::size_t drawn, std::size_t marked_drawn) {
    return std::exp(log_hypergeometric_exceedance(all, marked, drawn, marked_drawn));
  };
  // Of 10 with 4 marked, 5 are drawn: (C(4,3) C(6,2) + C(4,4) C(6,1)) / C(10,5).
  EXPECT_NEAR(exceedance(10, 4, 5, 3), 66.0 / 252, 1e-14);
  EXPECT_NEAR(exceedance(10, 4, 5, 1), 1 - 6.0 / 252, 1e-14);
  EXPECT_EQ(exceedance(10, 4, 5, 0), 1);
  EXPECT_EQ(exceedance(10, 4, 5, 5), 0);
  // All draws beyond what is not marked are marked.
  EXPECT_EQ(exceedance(10, 8, 5, 3), 1);
  EXPECT_NEAR(exceedance(1000, 4, 4, 4) * 41417124750, 1, 1e-9);
  for (std::size_t k = 1; k < 50; ++k) {
    const double down = exceedance(400, 60, 130, k), up = exceedance(400, 60, 130, k + 1);
    EXPECT_LE(up, down) << k;
  }
  // Counted with whole numbers of any length.
  EXPECT_NEAR(log_hypergeometric_exceedance(180000, 45001, 45000, 45000), -101203.47928300725, 1e-6);
  EXPECT_NEAR(log_hypergeometric_exceedance(20000, 5000, 4000, 3500), -4764.993206910998, 1e-7);
  EXPECT_NEAR(exceedance(1000, 300, 400, 180) / 3.6989358726384235774e-17, 1, 1e-12);
  EXPECT_NEAR(exceedance(100000, 1000, 5000, 75) / 0.00038426809174742368053, 1, 1e-9);
}

TEST(Distributions, holm_multiplies_by_the_tests_that_are_left) {
  // As R: p.adjust(c(0.01, 0.04, 0.03, 0.005, 0.9), "holm").
  const std::vector<double> adjusted = holm_adjusted(std::vector<double>{0.01, 0.04, 0.03, 0.005, 0.9});
  const std::vector<double> expected = {0.04, 0.09, 0.09, 0.025, 0.9};
  ASSERT_EQ(adjusted.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(adjusted[i], expected[i], 1e-15) << i;
  EXPECT_TRUE(holm_adjusted({}).empty());
  EXPECT_EQ(holm_adjusted(std::vector<double>{0.5, 0.5})[1], 1);
}

}  // namespace
}  // namespace abbe
