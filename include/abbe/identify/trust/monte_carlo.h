#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "abbe/geometry/numbered_work.h"
#include "abbe/identify/identify.h"

namespace abbe {

struct MonteCarloOptions {
  std::size_t samples = 10000;
  std::uint64_t seed = 1;
  int chord_iterations = 1;        ///< exact evaluations of the model per sample; 0: linear propagation only
  LossKind loss = LossKind::none;  ///< with which the identification was made, and every sample is
  double loss_tuning = 0;          ///< as IdentifyOptions::loss_tuning
  std::vector<double> probabilities = {0.025, 0.5, 0.975};
  int threads = 0;
  std::size_t memory_limit_bytes = std::size_t{1} << 30;  ///< for the kept Jacobian and the samples
  std::stop_token stop{};                                 ///< looked at before every batch of samples: throws Stopped
  WorkDriver work{};                                      ///< who computes the batches of samples; empty: this process
};

enum class MonteCarloStatus { not_run, done, no_solution, too_large };

struct MonteCarloResult {
  MonteCarloStatus status = MonteCarloStatus::not_run;
  std::size_t samples = 0;
  std::size_t not_settled = 0;             ///< samples whose robust fit was still moving; they are counted in
  Eigen::VectorXd mean;                    ///< [p], mm or rad
  Eigen::MatrixXd covariance;              ///< [p, p]
  Eigen::MatrixXd percentiles;             ///< [p, probabilities], mm or rad
  Eigen::VectorXd prediction_mean;         ///< [rows of P]
  Eigen::VectorXd prediction_uncertainty;  ///< [rows of P], standard
  Eigen::MatrixXd prediction_percentiles;  ///< [rows of P, probabilities]
};

/// Propagates the readings' uncertainties through the identification by simulation (JCGM 101).
///
/// Every sample adds standard normal numbers to the residuals of the model at the identified values, and is identified
/// again with the kept factor and exact residuals (chord iterations), in the same gauge and with the same loss. With a
/// robust loss the outliers that the identification listed are outliers in every sample too: gross errors of the size
/// found, in random directions; the noise of the others has the robust scale. Sample k uses
/// RandomStream(seed, k), so the result depends neither on the number of threads nor on the other samples.
/// @param problem     observations stand at the estimates, as identify() leaves them
/// @param prediction  null, or P: [rows, p], d(quantity)/d(estimate); quantities P (x - estimate) are then returned too
MonteCarloResult monte_carlo(const Problem& problem, const Identification& identification,
                             const MonteCarloOptions& options, const Eigen::MatrixXd* prediction = nullptr);

}  // namespace abbe
