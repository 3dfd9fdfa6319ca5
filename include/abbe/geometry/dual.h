#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace abbe {

/// A number with its derivatives by N variables: forward-mode automatic differentiation.
///
/// Arithmetic and the functions below carry first derivatives exactly; comparisons look at the value alone. Works as
/// the scalar of Eigen's small matrices. Source: Griewank and Walther, Evaluating Derivatives (2008), ch. 3.
template <int N>
struct Dual {
  double value = 0;
  std::array<double, static_cast<std::size_t>(N)> slope{};

  Dual() = default;
  // A constant stands wherever a number does.
  Dual(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor)
  /// The variable of that index.
  static Dual variable(double value, int index) {
    Dual result(value);
    result.slope[static_cast<std::size_t>(index)] = 1;
    return result;
  }

  Dual& operator+=(const Dual& b) {
    value += b.value;
    for (std::size_t i = 0; i < slope.size(); ++i) slope[i] += b.slope[i];
    return *this;
  }
  Dual& operator-=(const Dual& b) {
    value -= b.value;
    for (std::size_t i = 0; i < slope.size(); ++i) slope[i] -= b.slope[i];
    return *this;
  }
  Dual& operator*=(const Dual& b) {
    for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = slope[i] * b.value + value * b.slope[i];
    value *= b.value;
    return *this;
  }
  Dual& operator/=(const Dual& b) {
    const double inverse = 1 / b.value;
    value *= inverse;
    for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - value * b.slope[i]) * inverse;
    return *this;
  }
  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend Dual operator+(const Dual& a) { return a; }
  friend Dual operator-(const Dual& a) { return a.chained(-a.value, -1); }

  friend bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
  friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend bool operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }

  friend Dual sqrt(const Dual& a) {
    const double root = std::sqrt(a.value);
    return a.chained(root, 0.5 / root);
  }
  friend Dual sin(const Dual& a) { return a.chained(std::sin(a.value), std::cos(a.value)); }
  friend Dual cos(const Dual& a) { return a.chained(std::cos(a.value), -std::sin(a.value)); }
  friend Dual tan(const Dual& a) {
    const double tangent = std::tan(a.value);
    return a.chained(tangent, 1 + tangent * tangent);
  }
  friend Dual asin(const Dual& a) { return a.chained(std::asin(a.value), 1 / std::sqrt(1 - a.value * a.value)); }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const double square = x.value * x.value + y.value * y.value;
    Dual result(std::atan2(y.value, x.value));
    for (std::size_t i = 0; i < result.slope.size(); ++i) {
      result.slope[i] = (x.value * y.slope[i] - y.value * x.slope[i]) / square;
    }
    return result;
  }
  friend Dual abs(const Dual& a) { return a.value < 0 ? -a : a; }

 private:
  Dual chained(double new_value, double factor) const {
    Dual result(new_value);
    for (std::size_t i = 0; i < slope.size(); ++i) result.slope[i] = factor * slope[i];
    return result;
  }
};

/// The value without derivatives, for decisions.
inline double value_of(double number) { return number; }
template <int N>
double value_of(const Dual<N>& number) {
  return number.value;
}

}  // namespace abbe

/// Lets Eigen's small matrices hold Dual numbers.
template <int N>
struct Eigen::NumTraits<abbe::Dual<N>> : Eigen::NumTraits<double> {
  using Real = abbe::Dual<N>;
  using NonInteger = abbe::Dual<N>;
  using Nested = abbe::Dual<N>;
  // NOLINTBEGIN(readability-identifier-naming): names that Eigen asks for
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = N,
    AddCost = N,
    MulCost = 3 * N
  };
  // NOLINTEND(readability-identifier-naming)
};
