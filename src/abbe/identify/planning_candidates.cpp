#include "abbe/identify/planning_candidates.h"

#include <algorithm>
#include <numeric>

namespace abbe {
namespace {

using Index = Eigen::Index;

}  // namespace

PlanningCandidates candidate_rows(const Problem& problem) {
  PlanningCandidates candidates;
  candidates.rows = PlanningCandidates::Rows::Zero(static_cast<Index>(used_residual_count(problem)),
                                                   static_cast<Index>(estimated_count(problem)));
  candidates.first_row = {0};
  set_observations(problem, present_values(problem));
  std::size_t first_unknown = problem.machine_parameters.size();
  std::vector<double> residuals, jacobian;
  for (const SelectedObservations& selected : problem.observations) {
    const Observations& observations = *selected.observations;
    const std::size_t rows = static_cast<std::size_t>(observations.rows());
    const std::size_t machine = problem.machine_parameters.size(), columns = machine + selected.unknowns.size();
    const std::size_t stride = rows * Observations::kBlockSize;
    residuals.resize(stride);
    jacobian.resize(stride * columns);
    for (std::size_t first = 0; first < observations.reading_count(); first += Observations::kBlockSize) {
      const std::size_t count = std::min(Observations::kBlockSize, observations.reading_count() - first);
      observations.evaluate(first, count, problem.machine_parameters, selected.unknowns, residuals.data(),
                            jacobian.data(), stride);
      for (std::size_t k = 0; k < count; ++k) {
        if (!selected.use.empty() && selected.use[first + k] == 0) continue;
        for (std::size_t row = 0; row < rows; ++row) {
          const Index target = static_cast<Index>(candidates.first_row.back() + row);
          for (std::size_t c = 0; c < columns; ++c)
            candidates.rows(target, static_cast<Index>(c < machine ? c : first_unknown + c - machine)) =
                jacobian[c * stride + row * count + k];
        }
        candidates.first_row.push_back(candidates.first_row.back() + rows);
      }
    }
    first_unknown += selected.unknowns.size();
  }
  return candidates;
}

}  // namespace abbe
