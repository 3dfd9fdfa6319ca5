#include "abbe/identify/trust/monte_carlo.h"

#include <algorithm>
#include <atomic>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/stopped.h"
#include "abbe/identify/sampled_fit.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// Rows of `values` are quantities; linear interpolation between order statistics (JCGM 101, 7.7).
Eigen::MatrixXd percentiles_of(const Eigen::MatrixXd& values, const std::vector<double>& probabilities, int threads) {
  Eigen::MatrixXd result(values.rows(), static_cast<Index>(probabilities.size()));
  for_each_block(static_cast<std::size_t>(values.rows()), threads, [&](std::size_t row) {
    std::vector<double> sorted(static_cast<std::size_t>(values.cols()));
    for (Index i = 0; i < values.cols(); ++i) sorted[static_cast<std::size_t>(i)] = values(static_cast<Index>(row), i);
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 0; k < probabilities.size(); ++k) {
      const double place = std::clamp(probabilities[k], 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
      const std::size_t below = std::min(static_cast<std::size_t>(place), sorted.size() - 1);
      const std::size_t above = std::min(below + 1, sorted.size() - 1);
      const double part = place - static_cast<double>(below);
      result(static_cast<Index>(row), static_cast<Index>(k)) = sorted[below] * (1 - part) + sorted[above] * part;
    }
  });
  return result;
}

}  // namespace

MonteCarloResult monte_carlo(const Problem& problem, const Identification& identification,
                             const MonteCarloOptions& options, const Eigen::MatrixXd* prediction) {
  MonteCarloResult result;
  if (identification.covariance.size() == 0 || options.samples < 2) {
    result.status = MonteCarloStatus::no_solution;
    return result;
  }
  const Loss loss{options.loss, options.loss_tuning, identification.robust_scale};
  SampledFit sampled(problem, identification, loss, options.threads);
  const Eigen::VectorXd& estimates = identification.estimates;
  const Index p = estimates.size();
  if (sampled.bytes() + sizeof(double) * static_cast<std::size_t>(p) * options.samples > options.memory_limit_bytes) {
    result.status = MonteCarloStatus::too_large;
    return result;
  }
  if (!sampled.prepare()) {
    result.status = MonteCarloStatus::no_solution;
    return result;
  }
  const Eigen::MatrixXd& directions = sampled.directions();
  const std::size_t length = sampled.length();
  std::vector<double> noise(length * kSampleBatch), changed(length * kSampleBatch);
  std::atomic<std::size_t> not_settled{0};
  Eigen::MatrixXd changes(p, static_cast<Index>(options.samples));
  Eigen::MatrixXd y(directions.cols(), static_cast<Index>(kSampleBatch));
  for (std::size_t start = 0; start < options.samples; start += kSampleBatch) {
    stop_if_asked(options.stop);
    const std::size_t batch = std::min(kSampleBatch, options.samples - start);
    const auto in_tasks = [&](const auto& work) {
      for_each_block((batch + kSampleTask - 1) / kSampleTask, options.threads, [&](std::size_t task) {
        const std::size_t first = task * kSampleTask;
        work(first, std::min(kSampleTask, batch - first));
      });
    };
    y.setZero();
    in_tasks([&](std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i)
        sampled.draw(options.seed, start + i, noise.data() + i * length);
      const std::size_t open = sampled.fit(noise.data() + first * length, count,
                                           y.middleCols(static_cast<Index>(first), static_cast<Index>(count)));
      if (options.chord_iterations == 0) not_settled += open;
    });
    for (int iteration = 0; iteration < options.chord_iterations; ++iteration) {
      // The observations stand at one point at a time.
      for (std::size_t i = 0; i < batch; ++i)
        sampled.exact(estimates + directions * y.col(static_cast<Index>(i)), noise.data() + i * length,
                      changed.data() + i * length);
      in_tasks([&](std::size_t first, std::size_t count) {
        const std::size_t open = sampled.fit(changed.data() + first * length, count,
                                             y.middleCols(static_cast<Index>(first), static_cast<Index>(count)));
        if (iteration + 1 == options.chord_iterations) not_settled += open;
      });
    }
    changes.middleCols(static_cast<Index>(start), static_cast<Index>(batch)) =
        directions * y.leftCols(static_cast<Index>(batch));
  }
  set_observations(problem, estimates);
  if (!changes.allFinite()) {
    result.status = MonteCarloStatus::no_solution;
    return result;
  }
  result.samples = options.samples;
  result.not_settled = not_settled;
  const double n = static_cast<double>(options.samples);
  const Eigen::VectorXd shift = changes.rowwise().mean();
  result.mean = estimates + shift;
  const Eigen::MatrixXd centred = changes.colwise() - shift;
  result.covariance = centred * centred.transpose() / (n - 1);
  result.percentiles = percentiles_of(changes, options.probabilities, options.threads).colwise() + estimates;
  if (prediction && prediction->rows() > 0) {
    const Eigen::MatrixXd quantities = *prediction * changes;
    result.prediction_mean = quantities.rowwise().mean();
    result.prediction_uncertainty =
        ((quantities.colwise() - result.prediction_mean).rowwise().squaredNorm() / (n - 1)).cwiseSqrt();
    result.prediction_percentiles = percentiles_of(quantities, options.probabilities, options.threads);
  }
  result.status = MonteCarloStatus::done;
  return result;
}

}  // namespace abbe
