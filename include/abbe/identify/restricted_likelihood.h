#pragma once

#include <Eigen/Core>

#include "abbe/identify/identify.h"
#include "abbe/identify/weighed_observations.h"

namespace abbe {

/// Slope and information of the restricted likelihood of (variance factor, pose variance), as in ReadingVariance.
///
/// With V the covariance of the readings, r the residuals of the weighted fit and C the covariance of the estimates,
/// in the gauge and with the priors as observations of known variance:
///
///     l = -1/2 (log |V| + log |J'V^-1 J| + r'V^-1 r),     P = V^-1 - V^-1 J C J'V^-1
///     dl/dk = -1/2 (tr(P V_k) - r'V^-1 V_k V^-1 r),       information(k, l) = 1/2 tr(P V_k P V_l)
///
/// Source: Patterson and Thompson, Biometrika 58 (1971) 545; Searle, Casella and McCulloch, Variance Components (1992),
/// 6.6; Koch, Parameter Estimation and Hypothesis Testing in Linear Models (1999), 3.6.
struct RestrictedLikelihood {
  Eigen::Vector2d score = Eigen::Vector2d::Zero();        ///< 1, 1/mm^2
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< expected; inverse: covariance of the two
  double residual_count = 0;                              ///< priors not counted
  double taken_by_parameters = 0;                         ///< degrees of freedom that the estimates take from them
};

/// Streams over the poses; no matrix of the size of the readings is formed.
/// @param problem         what the identification solved, at the estimates: all observations are WeighedObservations
///                        with the same variances
/// @param solver          threads, summation and stop
RestrictedLikelihood restricted_likelihood(const Problem& problem, const Identification& identification,
                                           const SolverOptions& solver = {});

}  // namespace abbe
