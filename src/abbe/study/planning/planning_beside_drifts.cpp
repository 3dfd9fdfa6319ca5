#include "abbe/study/planning/planning_beside_drifts.h"

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/instruments/setup_drift.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Pivot of a drift's unknown, over the largest, below which it is a combination of others.
constexpr double kDependentDrift = 1e-12;

}  // namespace

PlanningCandidates beside_drifts(const Problem& problem, const PlanningCandidates& all,
                                 const std::vector<InstrumentReadings>& readings) {
  std::vector<Index> kept, drifting;
  Index next = 0;
  for (; next < static_cast<Index>(problem.machine_parameters.size()); ++next) kept.push_back(next);
  for (std::size_t s = 0; s < readings.size(); ++s) {
    const std::size_t count = problem.observations[s].unknowns.size();
    const std::size_t of_drift = readings[s].drift != nullptr ? readings[s].drift->unknown_count() : 0;
    for (std::size_t u = 0; u < count; ++u) (u + of_drift < count ? kept : drifting).push_back(next++);
  }
  const Eigen::MatrixXd priors = prior_rows(problem);
  Eigen::MatrixXd rows(all.rows.rows() + priors.rows(), all.rows.cols());
  rows.topRows(all.rows.rows()) = all.rows;
  rows.bottomRows(priors.rows()) = priors;
  Eigen::MatrixXd others = rows(Eigen::all, kept);
  if (!drifting.empty()) {
    Eigen::MatrixXd drift = rows(Eigen::all, drifting);
    const Eigen::VectorXd norms = drift.colwise().norm().transpose();
    drift *= norms.unaryExpr([](double norm) { return norm > 0 ? 1 / norm : 0.0; }).asDiagonal();
    PivotedQr qr(drift);
    qr.set_threshold(kDependentDrift);
    const Eigen::MatrixXd basis = qr.orthonormal(qr.rank());
    // Twice, so that what is left of a column that the drift explains is rounding of this column only.
    for (int pass = 0; pass < 2; ++pass) others -= basis * (basis.transpose() * others);
  }
  PlanningCandidates result;
  result.rows = others;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(others.rows()); ++k) result.first_row.push_back(k);
  return result;
}

}  // namespace abbe
