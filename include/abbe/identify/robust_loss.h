#pragma once

#include <cstddef>
#include <vector>

namespace abbe {

enum class LossKind { none, huber, cauchy, tukey };

/// Loss of one reading with Mahalanobis norm d (root of the sum of its squared residuals) and scale s.
///
/// cost rho(d/s) s^2, so that `none` gives d^2 / 2; weight w = rho'(u) / u of the iteratively reweighted least squares:
///   huber   w = 1 for u <= c, c / u beyond
///   cauchy  w = 1 / (1 + (u / c)^2)
///   tukey   w = (1 - (u / c)^2)^2 for u <= c, 0 beyond
/// The tuning constant c gives 95 % efficiency for normal noise; it depends on the number of residuals per reading,
/// because the norm of three normal residuals is larger than that of one (see docs/identification.md).
/// Sources: Huber, Robust Statistics, 1981; Holland and Welsch, Commun. Stat. A6 (1977) 813.
struct Loss {
  LossKind kind = LossKind::none;
  double tuning = 0;  ///< c; 0: 95 % efficiency for the number of rows
  double scale = 1;   ///< s, in standard uncertainties

  double weight(double norm, int rows) const;
  double weight_slope(double norm, int rows) const;  ///< d(weight)/d(norm), 1/standard uncertainties
  double cost(double norm, int rows) const;
};

/// Tuning constant for 95 % efficiency with `rows` residuals per reading (1 to 6; beyond 6 that of 6).
double tuning_constant(LossKind kind, int rows);

/// What a robust estimate's covariance is made of, per residual: the pseudo-residual psi(r) = w(|r|) r of a reading
/// with m rows has the derivative Psi' = w I + w' r r'/|r|.
struct LossMoments {
  double slope = 1;         ///< trace Psi' / m
  double square = 1;        ///< |psi|^2 / m, squared standard uncertainties
  double slope_square = 1;  ///< trace (Psi' Psi') / m
};

/// Of one reading with that norm.
LossMoments loss_moments_at(const Loss& loss, int rows, double norm);

/// Expected values for readings whose residuals are normal with the loss's scale as standard deviation; integrated over
/// the distribution of the norm to 1e-6.
LossMoments loss_moments(const Loss& loss, int rows);

/// Median of the norm of `rows` standard normal residuals (1 to 6).
double median_norm(int rows);

/// Robust scale of readings: median of norm / median_norm(rows); 1 if the stated uncertainties are right.
double median_scale(std::vector<double> scaled_norms);

}  // namespace abbe
