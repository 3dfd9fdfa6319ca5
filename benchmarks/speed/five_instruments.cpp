// Identification of 150 parameters of a trunnion mill from 50,000 readings of five instruments together: this project
// against Ceres with automatic differentiation. Same readings, residuals (checked), priors, start, tolerance and
// threads; dense normal Cholesky; covariance included.
//
//   five_instruments [--quick]     prints one line per figure; exit code 1 if a target is missed
#include <cmath>
#include <cstdio>
#include <cstring>

#include "five_instruments_ceres.h"

namespace {

using namespace abbe::benchmarks;
using abbe::benchmark_case::FiveInstrumentsCase;
using ObservationsList = std::vector<std::unique_ptr<abbe::Observations>>;

/// Largest difference of the residuals at the start, in standard uncertainties.
double compare_residuals(const ObservationsList& observed, const std::vector<double>& theirs) {
  double worst = 0;
  std::size_t at = 0;
  for (const std::unique_ptr<abbe::Observations>& one : observed) {
    for (const double ours : abbe::residuals_by_reading(*one, kThreads)) {
      if (at == theirs.size()) return INFINITY;
      // Residuals of the start are up to 1e5, differences of lengths of 1 m: agreement in relation to their size.
      worst = std::max(worst, std::abs(ours - theirs[at++]) / std::max(1.0, std::abs(ours)));
    }
  }
  return at == theirs.size() ? worst : INFINITY;
}

}  // namespace

int main(int count, char** arguments) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const bool quick = count > 1 && std::strcmp(arguments[1], "--quick") == 0;
  const int repetitions = quick ? 1 : 3;
  const FiveInstrumentsCase data(10000);
  bool good = true;

  abbe::Identification ours;
  double best = 1e9;
  for (int repetition = 0; repetition < 5 * repetitions; ++repetition) {
    const ObservationsList observed = data.observations();
    abbe::Problem problem = data.problem(observed);
    const double start = seconds();
    ours = abbe::identify(problem, our_options());
    best = std::min(best, seconds() - start);
  }
  good &= ours.status == abbe::IdentifyStatus::converged && ours.gauge.constraints.empty();
  std::printf("50000 readings of five instruments, %zu parameters: %s, %zu iterations, chi-square/dof %.4f\n",
              ours.parameters.size(), ours.message.c_str(), ours.history.size(), ours.statistics.variance_factor);
  std::printf("  this project                                    %10.1f ms\n", 1e3 * best);

  double fastest = 1e9;
  for (const CeresDerivatives derivatives : {CeresDerivatives::whole, CeresDerivatives::strides}) {
    const ObservationsList observed = data.observations();
    const abbe::Problem problem = data.problem(observed);
    CeresSolution theirs;
    double time = 1e9, solver_time = 1e9;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      CeresIdentification ceres(data, problem, derivatives);
      if (repetition == 0) {
        const double difference = compare_residuals(observed, ceres.residuals());
        good &= check("largest relative difference of residuals at the start", difference, difference < 1e-9);
      }
      theirs = ceres.solve();
      time = std::min(time, theirs.time);
      solver_time = std::min(solver_time, theirs.solver_time);
    }
    std::printf("  Ceres, %-28s             %10.1f ms, %d iterations; without covariance %.1f ms\n",
                derivatives == CeresDerivatives::whole ? "all derivatives at once" : "four at a time", 1e3 * time,
                theirs.iterations, 1e3 * solver_time);
    good &= theirs.converged;
    const double difference =
        (theirs.x - ours.estimates).cwiseQuotient(ours.standard_uncertainties).cwiseAbs().maxCoeff();
    const double spread = (theirs.uncertainty.cwiseQuotient(ours.standard_uncertainties).array() - 1).abs().maxCoeff();
    good &= check("largest difference of estimates, standard uncertainties", difference, difference < 0.02);
    good &= check("largest relative difference of uncertainties", spread, spread < 1e-4);
    fastest = std::min(fastest, time);
  }
  good &= check("times faster than the faster of the two (target 10)", fastest / best, fastest / best >= 10);
  return good ? 0 : 1;
}
