#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/identify/levenberg_marquardt.h"

namespace abbe {

/// How well the readings determine the parameters, from the singular values of the column-scaled Jacobian (gauge
/// removed).
struct Observability {
  double o1 = 0;         ///< geometric mean of the singular values / sqrt(readings): Borm and Menq, IJRR 10 (1991) 51
  double o2 = 0;         ///< inverse condition number: Driels and Pathre, J. Robot. Syst. 7 (1990) 179
  double o3 = 0;         ///< smallest singular value: Nahvi, Hollerbach and Hayward, ICRA 1994, 2414
  double condition = 0;  ///< largest / smallest singular value
};

struct FitStatistics {
  double chi_square = 0;  ///< sum of squared residuals, priors included; with a robust loss without the outliers
  std::size_t residual_count = 0;   ///< priors included; with a robust loss without the outliers
  std::size_t parameter_count = 0;  ///< free ones, after the gauge
  double degrees_of_freedom = 0;
  double p_value = 0;          ///< probability of a larger chi-square if model and uncertainties are right
  double variance_factor = 0;  ///< chi-square / degrees of freedom, a posteriori; 0 without degrees of freedom
  double robust_factor = 1;    ///< factor of the covariance due to the robust loss (Huber), 1 for least squares
  Observability observability;
};

/// Z (Z'HZ)^-1 Z': covariance of the estimates within the gauge (S-transformation; Baarda 1973, Teunissen 1985).
/// @param normal  H, [p, p]
/// @param space   null or without directions: Z is the identity
/// @returns false if Z'HZ is not positive definite; covariance is then empty
bool covariance_of_estimates(const Eigen::MatrixXd& normal, const ConstrainedSpace* space, Eigen::MatrixXd& covariance);

/// The same from a factor R with R'R = H (ReadingStream::orthogonal_factor): keeps twice the digits where columns of J
/// are nearly dependent.
bool covariance_from_factor(const Eigen::MatrixXd& factor, const ConstrainedSpace* space, Eigen::MatrixXd& covariance);

/// Observability indices of the parameters left free by the gauge.
Observability observability_of(const Eigen::MatrixXd& normal, const ConstrainedSpace* space, std::size_t reading_count);

struct Correlation {
  std::size_t other = 0;  ///< index of the other parameter
  double value = 0;       ///< -1 to 1
};
/// Largest correlations of every parameter, by magnitude, at most `count` each; fixed parameters have none.
std::vector<std::vector<Correlation>> largest_correlations(const Eigen::MatrixXd& covariance, std::size_t count);

}  // namespace abbe
