#pragma once

// Three squareness errors from eight readings of a ball bar:
//
//   #include <abbe/identify/identify.h>
//   #include <abbe/instruments/ball_bar.h>
//   #include <abbe/instruments/instrument_simulation.h>
//   #include <abbe/machine/chain.h>
//
//   #include <cstdio>
//
//   int main() {
//     const abbe::Machine mill = abbe::parse_chain("w X' Y' b Z t").machine;
//     using enum abbe::Component;
//     abbe::ErrorSet errors;  // squareness of Y (axis 1) and Z (axis 2): EC0Y, EA0Z, EB0Z in um/m
//     errors.locations = {{1, C, 30e-6}, {2, A, -20e-6}, {2, B, 50e-6}};
//     abbe::BallBarSetup setup;  // calibrated, noise of 0.1 um; its ball in the middle of the table
//     setup.balls = {{"table", abbe::SetupPoint::exact({0, 0, 0})}};
//     const auto bar = std::make_shared<const abbe::BallBar>(setup);
//     abbe::InstrumentReadings plan;  // mm: eight poses above the ball
//     for (const double x : {-100, -40, 40, 100}) plan.append({x, 60, 100}, 0), plan.append({x, -80, 100}, 0);
//     const abbe::InstrumentReadings read = abbe::simulate_instrument(mill, errors, bar, plan, {}).readings;
//
//     errors.set_parameters({0, 0, 0, 0, 0, 0});  // three location errors, three coordinates of the tool offset
//     abbe::Problem problem = abbe::estimate_everything(mill, errors, {bar->observations(mill, errors, read)});
//     problem.machine_parameters = {0, 1, 2};  // the tool offset is known
//     const abbe::Identification found = abbe::identify(problem);
//     for (int i = 0; i < 3; ++i)
//       std::printf("%s %+.1f um/m, standard uncertainty %.1f um/m\n", found.parameters[i].name.c_str(),
//                   1e6 * found.estimates[i], 1e6 * found.standard_uncertainties[i]);
//     return found.status == abbe::IdentifyStatus::converged ? 0 : 1;
//   }
//
// It prints:
//
//   EC0Y +28.9 um/m, standard uncertainty 1.0 um/m
//   EA0Z -20.6 um/m, standard uncertainty 0.7 um/m
//   EB0Z +51.0 um/m, standard uncertainty 0.7 um/m
//
// identify holds the way from readings to errors:
//   problem.h                           what is to be identified from what, and what is known before
//   strategies.h, order_selection.h     stages; degrees and harmonics that the readings justify
//   gauge.h, covariance.h               what readings cannot tell apart; uncertainty, correlation, observability
//   trust/trust.h                       whether a result may be used; Monte Carlo and outliers beside it
//   linkage/linkage_steps.h             dials, laser engravers and scanners, step by step without a model of all errors

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
  /// False: no outliers are listed, and no memory is taken per reading; for least squares only.
  bool list_outliers = true;
  bool apply_variance_factor = false;  ///< multiply the covariance with chi-square / degrees of freedom; always stated
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
/// Measured - modelled of them, in the same order: not weighted, mm or rad as the components say.
std::vector<double> deviations_by_reading(const Observations& observations, int threads = 0);
/// Lengths of these, angles left out: [reading_count], mm; -1 where nothing but angles is read.
std::vector<double> lengths_by_reading(const Observations& observations, int threads = 0);

}  // namespace abbe
