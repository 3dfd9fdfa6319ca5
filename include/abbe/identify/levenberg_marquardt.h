#pragma once

#include <Eigen/Core>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "abbe/identify/normal_equations.h"
#include "abbe/identify/problem.h"
#include "abbe/identify/robust_loss.h"

namespace abbe {

/// One iteration, for the convergence history.
struct IterationRecord {
  double cost = 0;      ///< half the sum of squares (or of losses)
  double damping = 0;   ///< Levenberg-Marquardt parameter, relative; 0 for a chord iteration
  double step = 0;      ///< |D dx| / |D x|
  double gradient = 0;  ///< largest cosine between residuals and a column
  bool accepted = false;
  bool chord = false;  ///< factor kept from an earlier iteration
};

enum class IdentifyStatus {
  not_run,
  converged,         ///< at a stationary point, see solve()
  no_convergence,    ///< iteration limit reached, or no step lowers the cost
  rank_deficient,    ///< parameters that the readings cannot separate and no gauge was stated
  too_few_readings,  ///< fewer residuals and priors than parameters (after the gauge)
  not_finite,        ///< a residual or derivative is not a finite number
};

/// "converged", "no convergence", ... for people.
const char* status_text(IdentifyStatus status);

struct SolverOptions {
  int max_iterations = 100;
  double relative_cost = 1e-12;  ///< converged if actual and predicted relative decrease of the cost are below
  double gradient = 1e-10;       ///< converged if the residuals are orthogonal to every column: largest cosine below
  double step = 1e-11;           ///< converged if |D dx| < step |D x|, D: column norms of the Jacobian
  double start_damping = 1e-6;   ///< relative to the (unit) diagonal of the scaled normal matrix
  double least_damping = 0;      ///< above 0: directions may be open without a gauge, and the rank is not judged
  bool chord_iterations = true;  ///< keep the factor while it still lowers the gradient well
  int threads = 0;               ///< 0: all; the result does not depend on it
  std::stop_token stop{};        ///< looked at before every piece of a sum: solve() then throws Stopped
  Summation summation{};         ///< who sums the readings; empty: this process. The result does not depend on it
  std::function<void(const IterationRecord&)> progress{};  ///< called after every iteration
};

/// x = particular + directions * y for all y: the solutions of the gauge's equations C x = d.
struct ConstrainedSpace {
  Eigen::VectorXd particular;  ///< [p], mm or rad
  Eigen::MatrixXd directions;  ///< [p, p - q]; no columns and no rows: unconstrained
};

struct SolverResult {
  IdentifyStatus status = IdentifyStatus::not_run;
  Eigen::VectorXd estimates;  ///< [p], mm or rad
  Eigen::MatrixXd normal;     ///< [p, p] J'WJ and priors at the estimates
  double cost = 0;
  std::vector<IterationRecord> history;
};

/// Minimises the (robust) sum of squares from `start`, inside the constrained space if one is given.
///
/// Levenberg-Marquardt with Nielsen's damping in column-scaled variables (IMM-REP-1999-05; More, LNM 630 (1978) 105).
/// Converged only where g'H^-1 g / 2, what the model without damping could still gain, is no more than 1e-10 of the
/// cost (or relative_cost, if larger) or 1e-12: a stationary point to 1e-6 of the standard uncertainties.
/// @param start  [p]; its part along the constrained directions is used
SolverResult solve(const Problem& problem, const Eigen::VectorXd& start, const ConstrainedSpace* space,
                   const Loss& loss, const SolverOptions& options);

/// The same over a stream that exists already.
/// @param at_start  null, or the sums with normal matrix at `start` (without loss, or with the same one)
SolverResult solve(const ReadingStream& stream, const Eigen::VectorXd& start, const ConstrainedSpace* space,
                   const Loss& loss, const SolverOptions& options, const NormalEquations* at_start);

}  // namespace abbe
