#include "abbe/study/report/truth_in_gauge.h"

#include <Eigen/Core>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/identify/levenberg_marquardt.h"
#include "abbe/study/campaign.h"
#include "abbe/study/identification/identified_expansions.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

/// Coefficients of a motion nearest to the true motion of the same name, at positions over its range.
Eigen::VectorXd nearest_coefficients(const ErrorSet& truth, const ErrorMotion& motion) {
  const Basis& basis = motion.basis;
  const std::size_t count = 8 * basis.size() + 33;
  const std::vector<double> positions = evenly_spaced(basis.from, basis.to, count);
  Eigen::MatrixXd functions(static_cast<Index>(count), static_cast<Index>(basis.size()));
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Index>(count));
  std::vector<double> row(basis.size());
  for (std::size_t i = 0; i < count; ++i) {
    basis.values(positions[i], motion.coefficients, row);
    for (std::size_t j = 0; j < row.size(); ++j) functions(static_cast<Index>(i), static_cast<Index>(j)) = row[j];
    for (const ErrorMotion& one : truth.motions) {
      if (one.axis != motion.axis || one.component != motion.component || one.state != motion.state) continue;
      values[static_cast<Index>(i)] += one.basis.evaluate(positions[i], one.coefficients);
    }
  }
  return PivotedQr(functions).solve(values);
}

}  // namespace

std::vector<double> true_parameters(const ErrorSet& truth, const ErrorSet& model) {
  ErrorSet result = model;
  for (ErrorMotion& motion : result.motions) {
    const Eigen::VectorXd coefficients = nearest_coefficients(truth, motion);
    motion.coefficients.assign(coefficients.data(), coefficients.data() + coefficients.size());
  }
  for (LocationError& location : result.locations) {
    location.value = 0;
    for (const LocationError& one : truth.locations) {
      if (one.axis != location.axis || one.component != location.component) continue;
      if (one.state == location.state) location.value += one.value;
    }
  }
  for (Reversal& reversal : result.reversals) {
    reversal.value = 0;
    for (const Reversal& one : truth.reversals) {
      if (one.axis == reversal.axis) reversal.value += one.value;
    }
  }
  result.tool_offset_error = truth.tool_offset_error;
  return result.parameters();
}

std::optional<ErrorSet> truth_in_gauge(const Study& study, const StudyResult& result) {
  if (!result.campaign.truth) return std::nullopt;
  Problem problem = result.model.problem;
  std::vector<double> real = true_parameters(*result.campaign.truth, problem.errors);
  // What a thermometer is wrong by is no error of the machine beside its other terms.
  for (const ExpansionParameters& one : expansion_parameters(*study.identification, problem.errors)) {
    if (one.identified->expansion->is_temperature) real[one.coefficient - 1] = real[one.coefficient] = 0;
  }
  std::erase_if(problem.priors, [](const Prior& prior) { return !prior.parameter.is_machine(); });
  for (Prior& prior : problem.priors) prior.value = real[prior.parameter.index];
  for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
    for (const KnownUnknown& known : result.campaign.setups[s].true_unknowns()) {
      problem.priors.push_back({{s, known.unknown}, known.value, known.standard_uncertainty});
    }
  }
  for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
    problem.observations[s].observations = result.campaign.setups[s].exact_observations(study.machine, problem.errors);
    problem.observations[s].observations->set_parameters(problem.errors.parameters(), result.identification.setup[s]);
  }
  SolverOptions options;
  options.threads = study.threads;
  const ConstrainedSpace& space = result.identification.space;
  const SolverResult solved =
      solve(problem, result.identification.estimates, space.directions.size() > 0 ? &space : nullptr, Loss{}, options);
  if (solved.status != IdentifyStatus::converged) return std::nullopt;
  keep_estimates(problem, solved.estimates);
  return problem.errors;
}

}  // namespace abbe
