#include "abbe/identify/planning_candidates.h"

#include <algorithm>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

/// Some readings of one set of observations, and where their rows begin.
struct Block {
  const SelectedObservations* selected = nullptr;
  std::size_t first = 0, count = 0;
  std::size_t row = 0;
  std::size_t first_unknown = 0;  ///< column of the first unknown of these observations
};

bool is_used(const SelectedObservations& selected, std::size_t reading) {
  return selected.use.empty() || selected.use[reading] != 0;
}

/// Divides all readings into blocks. @param first_row  is filled as PlanningCandidates::first_row
std::vector<Block> blocks_of(const Problem& problem, std::vector<std::size_t>& first_row) {
  std::vector<Block> blocks;
  std::size_t first_unknown = problem.machine_parameters.size();
  for (const SelectedObservations& selected : problem.observations) {
    const Observations& observations = *selected.observations;
    const std::size_t all = observations.reading_count(), rows = static_cast<std::size_t>(observations.rows());
    for (std::size_t first = 0; first < all; first += Observations::kBlockSize) {
      const std::size_t count = std::min(Observations::kBlockSize, all - first);
      blocks.push_back({&selected, first, count, first_row.back(), first_unknown});
      for (std::size_t k = first; k < first + count; ++k)
        if (is_used(selected, k)) first_row.push_back(first_row.back() + rows);
    }
    first_unknown += selected.unknowns.size();
  }
  return blocks;
}

void compute(const Problem& problem, const Block& block, PlanningCandidates::Rows& all) {
  if (all.cols() == 0) return;
  const SelectedObservations& selected = *block.selected;
  const Observations& observations = *selected.observations;
  const std::size_t rows = static_cast<std::size_t>(observations.rows()), count = block.count;
  const std::size_t machine = problem.machine_parameters.size(), columns = machine + selected.unknowns.size();
  const std::size_t stride = rows * Observations::kBlockSize;
  thread_local std::vector<double> residuals, jacobian;
  residuals.resize(stride);
  jacobian.resize(stride * columns);
  observations.evaluate(block.first, count, problem.machine_parameters, selected.unknowns, residuals.data(),
                        jacobian.data(), stride);
  auto target = static_cast<Index>(block.row);
  for (std::size_t k = 0; k < count; ++k) {
    if (!is_used(selected, block.first + k)) continue;
    for (std::size_t row = 0; row < rows; ++row, ++target) {
      double* const to = &all(target, 0);
      std::fill_n(to, all.cols(), 0.0);
      const double* const from = &jacobian[row * count + k];
      for (std::size_t c = 0; c < machine; ++c) to[c] = from[c * stride];
      for (std::size_t c = machine; c < columns; ++c) to[block.first_unknown + c - machine] = from[c * stride];
    }
  }
}

}  // namespace

PlanningCandidates candidate_rows(const Problem& problem, int threads) {
  PlanningCandidates candidates;
  candidates.first_row = {0};
  const std::vector<Block> blocks = blocks_of(problem, candidates.first_row);
  candidates.rows.resize(static_cast<Index>(candidates.first_row.back()), static_cast<Index>(estimated_count(problem)));
  set_observations(problem, present_values(problem));
  for_each_block(blocks.size(), threads, [&](std::size_t block) { compute(problem, blocks[block], candidates.rows); });
  return candidates;
}

}  // namespace abbe
