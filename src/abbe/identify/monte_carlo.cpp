#include "abbe/identify/monte_carlo.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/identify/cross_products.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr std::size_t kBlock = Observations::kBlockSize;
// Samples per batch and per piece of work; fixed, so that sums do not depend on the number of threads.
constexpr std::size_t kBatch = 64;
constexpr std::size_t kTask = 8;

/// The problem at the solution: kept Jacobian of the free variables, kept factor, residuals.
class Linearisation {
 public:
  Linearisation(const Problem& problem, const Identification& identification, int threads)
      : problem_(problem), stream_(problem, threads), estimates_(identification.estimates) {
    for (const SelectedObservations& selected : problem.observations) {
      first_.push_back(rows_);
      rows_ += selected.observations->reading_count() * static_cast<std::size_t>(selected.observations->rows());
    }
    priors_ = prior_rows(problem);
    length_ = padded(rows_ + static_cast<std::size_t>(priors_.rows()), kLengthMultiple);
    directions_ = identification.space.directions.size() > 0
                      ? identification.space.directions
                      : Eigen::MatrixXd::Identity(estimates_.size(), estimates_.size());
    free_ = static_cast<std::size_t>(directions_.cols());
    columns_ = padded(free_, kColumnMultiple);
  }

  std::size_t bytes() const { return sizeof(double) * length_ * (columns_ + 2 * kBatch); }
  std::size_t length() const { return length_; }
  std::size_t columns() const { return columns_; }
  const Eigen::MatrixXd& directions() const { return directions_; }

  bool prepare() {
    set_observations(problem_, estimates_);
    jacobian_.assign(length_ * columns_, 0.0);
    stream_.for_each(true, Loss{}, [&](std::size_t, const ResidualBlock& block, double) {
      const std::size_t size = block.count * static_cast<std::size_t>(block.rows);
      const std::size_t target = first_[block.observations] + block.first * static_cast<std::size_t>(block.rows);
      for (std::size_t f = 0; f < free_; ++f)
        for (std::size_t c = 0; c < block.estimates->size(); ++c) {
          const double factor = directions_(static_cast<Index>((*block.estimates)[c]), static_cast<Index>(f));
          if (factor == 0) continue;
          const double* from = block.jacobian + c * block.stride;
          double* to = jacobian_.data() + f * length_ + target;
          for (std::size_t k = 0; k < size; ++k) to[k] += factor * from[k];
        }
    });
    const Eigen::MatrixXd prior_columns = priors_ * directions_;
    for (Index f = 0; f < prior_columns.cols(); ++f)
      for (Index i = 0; i < prior_columns.rows(); ++i)
        jacobian_[static_cast<std::size_t>(f) * length_ + rows_ + static_cast<std::size_t>(i)] = prior_columns(i, f);
    residuals_.resize(length_);
    residuals(estimates_, residuals_.data());

    std::vector<double> products(columns_ * columns_, 0.0);
    add_cross_products(jacobian_.data(), columns_, length_, jacobian_.data(), columns_, length_, length_,
                       products.data(), columns_);
    const Index n = static_cast<Index>(free_);
    const Eigen::MatrixXd normal =
        Eigen::Map<const Eigen::MatrixXd>(products.data(), static_cast<Index>(columns_), static_cast<Index>(columns_))
            .topLeftCorner(n, n);
    if (!normal.allFinite() || !(normal.diagonal().minCoeff() > 0)) return false;
    inverse_scale_ = normal.diagonal().cwiseSqrt().cwiseInverse();
    factor_.compute(inverse_scale_.asDiagonal() * normal * inverse_scale_.asDiagonal());
    return factor_.info() == Eigen::Success;
  }

  /// Standard normal numbers where there are residuals, zero elsewhere; the block order of the residuals.
  void draw(std::uint64_t seed, std::size_t sample, double* noise) const {
    RandomStream random(seed, sample);
    std::fill(noise, noise + length_, 0.0);
    for (std::size_t o = 0; o < problem_.observations.size(); ++o) {
      const SelectedObservations& selected = problem_.observations[o];
      const std::size_t rows = static_cast<std::size_t>(selected.observations->rows());
      const std::size_t count = selected.observations->reading_count();
      if (selected.use.empty()) {
        for (std::size_t i = 0; i < rows * count; ++i) noise[first_[o] + i] = random.normal();
        continue;
      }
      for (std::size_t first = 0; first < count; first += kBlock) {
        const std::size_t size = std::min(kBlock, count - first);
        for (std::size_t r = 0; r < rows; ++r)
          for (std::size_t k = 0; k < size; ++k)
            if (selected.use[first + k]) noise[first_[o] + first * rows + r * size + k] = random.normal();
      }
    }
    for (Index i = 0; i < priors_.rows(); ++i) noise[rows_ + static_cast<std::size_t>(i)] = random.normal();
  }

  /// residuals of the sample at `estimates`: noise plus the change of the model's residuals.
  void exact(const Eigen::VectorXd& estimates, const double* noise, double* sample_residuals) const {
    residuals(estimates, sample_residuals);
    for (std::size_t i = 0; i < length_; ++i) sample_residuals[i] += noise[i] - residuals_[i];
  }

  /// Adds the least-squares step of residuals of `count` samples to their free variables (columns of y).
  void step(const double* sample_residuals, std::size_t count, Eigen::Ref<Eigen::MatrixXd> y) const {
    const std::size_t samples = padded(count, kColumnMultiple);
    std::vector<double> products(columns_ * samples, 0.0);
    add_cross_products(jacobian_.data(), columns_, length_, sample_residuals, samples, length_, length_,
                       products.data(), columns_);
    const Eigen::MatrixXd gradient =
        Eigen::Map<const Eigen::MatrixXd>(products.data(), static_cast<Index>(columns_), static_cast<Index>(samples))
            .topLeftCorner(static_cast<Index>(free_), static_cast<Index>(count));
    y += inverse_scale_.asDiagonal() * factor_.solve(inverse_scale_.asDiagonal() * gradient);
  }

 private:
  void residuals(const Eigen::VectorXd& estimates, double* out) const {
    set_observations(problem_, estimates);
    std::fill(out + rows_, out + length_, 0.0);
    for (std::size_t o = 0; o < problem_.observations.size(); ++o) {
      const SelectedObservations& selected = problem_.observations[o];
      const std::size_t rows = static_cast<std::size_t>(selected.observations->rows());
      const std::size_t count = selected.observations->reading_count();
      for (std::size_t first = 0; first < count; first += kBlock) {
        const std::size_t size = std::min(kBlock, count - first);
        double* block = out + first_[o] + first * rows;
        selected.observations->evaluate(first, size, {}, {}, block, nullptr, rows * size);
        if (selected.use.empty()) continue;
        for (std::size_t r = 0; r < rows; ++r)
          for (std::size_t k = 0; k < size; ++k)
            if (!selected.use[first + k]) block[r * size + k] = 0;
      }
    }
    const Eigen::VectorXd change = priors_ * (estimates - estimates_);
    for (Index i = 0; i < change.size(); ++i) out[rows_ + static_cast<std::size_t>(i)] = -change[i];
  }

  const Problem& problem_;
  ReadingStream stream_;
  Eigen::VectorXd estimates_;
  std::vector<std::size_t> first_;
  std::size_t rows_ = 0, length_ = 0, free_ = 0, columns_ = 0;
  Eigen::MatrixXd priors_, directions_;
  std::vector<double> jacobian_, residuals_;
  Eigen::VectorXd inverse_scale_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

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
  Linearisation linear(problem, identification, options.threads);
  const Eigen::VectorXd& estimates = identification.estimates;
  const Index p = estimates.size();
  if (linear.bytes() + sizeof(double) * static_cast<std::size_t>(p) * options.samples > options.memory_limit_bytes) {
    result.status = MonteCarloStatus::too_large;
    return result;
  }
  if (!linear.prepare()) {
    result.status = MonteCarloStatus::no_solution;
    return result;
  }
  const Eigen::MatrixXd& directions = linear.directions();
  const std::size_t length = linear.length();
  std::vector<double> noise(length * kBatch), changed(length * kBatch);
  Eigen::MatrixXd changes(p, static_cast<Index>(options.samples));
  Eigen::MatrixXd y(directions.cols(), static_cast<Index>(kBatch));
  for (std::size_t start = 0; start < options.samples; start += kBatch) {
    const std::size_t batch = std::min(kBatch, options.samples - start);
    const auto in_tasks = [&](const auto& work) {
      for_each_block((batch + kTask - 1) / kTask, options.threads, [&](std::size_t task) {
        const std::size_t first = task * kTask;
        work(first, std::min(kTask, batch - first));
      });
    };
    y.setZero();
    in_tasks([&](std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i)
        linear.draw(options.seed, start + i, noise.data() + i * length);
      linear.step(noise.data() + first * length, count,
                  y.middleCols(static_cast<Index>(first), static_cast<Index>(count)));
    });
    for (int iteration = 0; iteration < options.chord_iterations; ++iteration) {
      // The observations stand at one point at a time.
      for (std::size_t i = 0; i < batch; ++i)
        linear.exact(estimates + directions * y.col(static_cast<Index>(i)), noise.data() + i * length,
                     changed.data() + i * length);
      in_tasks([&](std::size_t first, std::size_t count) {
        linear.step(changed.data() + first * length, count,
                    y.middleCols(static_cast<Index>(first), static_cast<Index>(count)));
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
