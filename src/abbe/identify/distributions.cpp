#include "abbe/identify/distributions.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace abbe {
namespace {

constexpr double kTiny = 1e-300;
constexpr double kPrecision = 1e-16;
constexpr int kMostTerms = 100000;

double away_from_zero(double value) { return std::abs(value) < kTiny ? kTiny : value; }

// Continued fraction of DLMF 8.17.22, without its front factor.
double beta_fraction(double a, double b, double x) {
  double c = 1;
  double d = 1 / away_from_zero(1 - (a + b) * x / (a + 1));
  double value = d;
  for (int m = 1; m < kMostTerms; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / away_from_zero(1 + even * d);
    c = away_from_zero(1 + even / c);
    value *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / away_from_zero(1 + odd * d);
    c = away_from_zero(1 + odd / c);
    value *= d * c;
    if (std::abs(d * c - 1) < kPrecision) break;
  }
  return value;
}

/// Where an exceedance that falls with x from 1 at 0 has a value. @param high  first guess, above 0
template <typename Exceedance>
double quantile_by_bisection(double exceedance, double high, const Exceedance& exceedance_at) {
  double low = 0;
  while (exceedance_at(high) > exceedance) high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-13 * high; ++i) {
    const double middle = (low + high) / 2;
    (exceedance_at(middle) > exceedance ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

double incomplete_gamma_upper(double a, double x) {
  if (!(x > 0)) return 1;
  if (std::isinf(x)) return 0;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < kMostTerms && std::abs(term) > kPrecision * std::abs(sum); ++n) {
      term *= x / (a + n);
      sum += term;
    }
    return 1 - front * sum;
  }
  double b = x + 1 - a;
  double c = 1 / kTiny;
  double d = 1 / b;
  double value = d;
  for (int n = 1; n < kMostTerms; ++n) {
    const double factor = -n * (n - a);
    b += 2;
    d = 1 / away_from_zero(factor * d + b);
    c = away_from_zero(b + factor / c);
    value *= d * c;
    if (std::abs(d * c - 1) < kPrecision) break;
  }
  return front * value;
}

double incomplete_beta(double a, double b, double x) {
  if (!(x > 0)) return 0;
  if (!(x < 1)) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

double chi_square_exceedance(double value, double degrees_of_freedom) {
  return incomplete_gamma_upper(degrees_of_freedom / 2, value / 2);
}

double chi_square_quantile(double exceedance, double degrees_of_freedom) {
  return quantile_by_bisection(exceedance, degrees_of_freedom + 10,
                               [&](double x) { return chi_square_exceedance(x, degrees_of_freedom); });
}

double fisher_quantile(double exceedance, double upper, double lower) {
  return quantile_by_bisection(
      exceedance, 10, [&](double x) { return incomplete_beta(lower / 2, upper / 2, lower / (lower + upper * x)); });
}

double student_exceedance(double t, double degrees_of_freedom) {
  const double tail =
      incomplete_beta(degrees_of_freedom / 2, 0.5, degrees_of_freedom / (degrees_of_freedom + t * t)) / 2;
  return t > 0 ? tail : 1 - tail;
}

double sum_exceedance(std::span<const double> values, double expected) {
  const auto n = static_cast<double>(values.size());
  if (values.size() < 3) return 1;
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  double square = 0;
  for (const double value : values) square += (value - sum / n) * (value - sum / n);
  const double deviation = std::sqrt(square / (n - 1) * n);
  if (!(deviation > 0)) return sum > expected ? 0 : 1;
  return student_exceedance((sum - expected) / deviation, n - 1);
}

}  // namespace abbe
