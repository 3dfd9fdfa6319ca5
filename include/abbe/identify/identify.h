#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/identify/covariance.h"
#include "abbe/identify/gauge.h"
#include "abbe/identify/levenberg_marquardt.h"
#include "abbe/identify/problem.h"
#include "abbe/identify/robust_loss.h"

namespace abbe {

struct IdentifyOptions {
  SolverOptions solver;
  GaugeChoice gauge = GaugeChoice::iso;
  LossKind loss = LossKind::none;       ///< none: least squares; any other starts with Cauchy and ends with this one
  double loss_tuning = 0;               ///< tuning constant of the loss; 0: 95 % efficiency for normal noise
  bool scale_from_residuals = false;    ///< robust scale from the median of the residuals instead of 1
  double outlier_norm_quantile = 1e-4;  ///< a reading is listed as outlier beyond this exceedance of its chi-square
  bool apply_variance_factor = false;   ///< multiply the covariance with chi-square / degrees of freedom; always stated
};

struct Outlier {
  std::size_t observations = 0;
  std::size_t reading = 0;
  double norm = 0;    ///< Mahalanobis norm of its residuals, standard uncertainties
  double weight = 0;  ///< final weight, 0 to 1
};

/// Result of an identification.
///
/// All of it is filled in where there is a covariance: with status converged or no_convergence, and with rank_deficient
/// if the readings only leave combinations open that no convention fixes. If they do not determine the parameters at
/// the solution, there are estimates but neither covariance nor errors. In all other cases there are no estimates.
struct Identification {
  IdentifyStatus status = IdentifyStatus::not_run;
  bool converged = false;  ///< the solver has reached a minimum with a covariance, whatever else the status says
  std::string message;     ///< one sentence for people
  std::vector<EstimatedParameter> parameters;  ///< [p]
  Eigen::VectorXd estimates;                   ///< [p], mm or rad
  Eigen::MatrixXd covariance;                  ///< [p, p]; variance 0 where the gauge fixes a parameter
  Eigen::VectorXd standard_uncertainties;      ///< [p]
  ErrorSet errors;                             ///< all errors of the machine, standard uncertainties filled in
  std::vector<std::vector<double>> setup;      ///< all unknowns of each of the observations, mm or rad
  GaugeReport gauge;
  ConstrainedSpace space;  ///< what the gauge leaves free; for further computations
  FitStatistics statistics;
  std::vector<IterationRecord> history;
  std::vector<Outlier> outliers;  ///< by norm, largest first
  double robust_scale = 1;        ///< scale used by the loss
};

/// Identifies the parameters of a problem: gauge, robust start, Levenberg-Marquardt, covariance, statistics.
///
/// Afterwards the observations stand at the estimates, problem.errors has them too; on failure they keep the start.
/// The result does not depend on the number of threads.
Identification identify(Problem& problem, const IdentifyOptions& options = {});

/// Residuals of one set of readings at the values at which its observations stand: [reading_count * rows], the rows of
/// one reading next to each other.
std::vector<double> residuals_by_reading(const Observations& observations, int threads = 0);

}  // namespace abbe
