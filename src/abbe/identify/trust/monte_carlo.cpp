#include "abbe/identify/trust/monte_carlo.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <numeric>
#include <span>
#include <string_view>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/stopped.h"
#include "abbe/identify/sampled_fit.h"
#include "abbe/identify/trust/sample_moments.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

/// What is found of quantities over all samples. A process computes only the quantities of its own blocks, since the
/// product takes as long as many samples do, and so does sorting.
class QuantityFigures {
 public:
  /// @param factor  null: the quantities are the changes; or else, [quantities, p], they are its product with these
  QuantityFigures(const Eigen::MatrixXd& changes, const Eigen::MatrixXd* factor,
                  const std::vector<double>& probabilities)
      : changes_(changes),
        factor_(factor),
        probabilities_(probabilities),
        rows_(static_cast<std::size_t>(factor != nullptr ? factor->rows() : changes.rows())),
        found_(2 + static_cast<Index>(probabilities.size()), static_cast<Index>(rows_)) {}

  /// @param fingerprint  of what the quantities depend on
  void find(const MonteCarloOptions& options, const std::function<std::uint64_t()>& fingerprint) {
    NumberedWork work;
    work.name = "percentiles";
    work.blocks = std::max<std::size_t>(1, rows_ / kRows);
    work.threads = options.threads;
    work.for_all = true;
    work.is_kept = false;
    work.fingerprint = fingerprint;
    work.compute = [this](std::size_t block) { compute(block); };
    work.pack = [this](std::size_t block, std::vector<std::byte>& bytes) { pack_numbers(of(block), bytes); };
    work.unpack = [this](std::size_t block, std::span<const std::byte> bytes) {
      unpack_numbers(bytes, of(block));
      require_unpacked(bytes);
    };
    do_work(options.work, work);
  }

  Eigen::VectorXd mean() const { return found_.row(0).transpose(); }
  Eigen::VectorXd deviation() const { return found_.row(1).transpose(); }  ///< standard
  /// [quantities, probabilities]
  Eigen::MatrixXd percentiles() const { return found_.bottomRows(found_.rows() - 2).transpose(); }

 private:
  // Whole panels of the product, whose rounded sums are then those of the product of all rows. The last block has the
  // rest too: a single row would be multiplied in another order.
  static constexpr std::size_t kRows = 12;

  std::size_t count(std::size_t block) const {
    return (block + 1) * kRows + kRows > rows_ ? rows_ - block * kRows : kRows;
  }

  std::span<double> of(std::size_t block) {
    const auto each = static_cast<std::size_t>(found_.rows());
    return {found_.data() + each * block * kRows, each * count(block)};
  }

  void compute(std::size_t block) {
    const auto first = static_cast<Index>(block * kRows), rows = static_cast<Index>(count(block));
    Eigen::MatrixXd values(rows, changes_.cols());
    if (factor_ != nullptr) {
      values.noalias() = factor_->middleRows(first, rows) * changes_;
    } else {
      values = changes_.middleRows(first, rows);
    }
    const double n = static_cast<double>(values.cols());
    const Eigen::VectorXd mean = values.rowwise().mean();
    found_.row(0).segment(first, rows) = mean.transpose();
    found_.row(1).segment(first, rows) =
        ((values.colwise() - mean).rowwise().squaredNorm() / (n - 1)).cwiseSqrt().transpose();
    std::vector<double> sorted(static_cast<std::size_t>(values.cols()));
    for (Index row = 0; row < rows; ++row) {
      for (Index i = 0; i < values.cols(); ++i) sorted[static_cast<std::size_t>(i)] = values(row, i);
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t k = 0; k < probabilities_.size(); ++k)
        found_(2 + static_cast<Index>(k), first + row) = percentile(sorted, probabilities_[k]);
    }
  }

  /// Linear interpolation between order statistics (JCGM 101, 7.7).
  static double percentile(const std::vector<double>& sorted, double probability) {
    const double place = std::clamp(probability, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
    const std::size_t below = std::min(static_cast<std::size_t>(place), sorted.size() - 1);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    const double part = place - static_cast<double>(below);
    return sorted[below] * (1 - part) + sorted[above] * part;
  }

  const Eigen::MatrixXd& changes_;
  const Eigen::MatrixXd* factor_;
  const std::vector<double>& probabilities_;
  std::size_t rows_;
  Eigen::MatrixXd found_;  // [mean, deviation, percentiles; quantities]
};

/// Samples in batches, each of which is fitted by itself.
class SampleBatches {
 public:
  SampleBatches(const SampledFit& sampled, const Eigen::VectorXd& estimates, const MonteCarloOptions& options)
      : sampled_(sampled),
        estimates_(estimates),
        options_(options),
        noise_(sampled.length() * kSampleBatch),
        changed_(noise_.size()),
        y_(sampled.directions().cols(), static_cast<Index>(kSampleBatch)),
        changes_(estimates.size(), static_cast<Index>(options.samples)),
        open_((options.samples + kSampleBatch - 1) / kSampleBatch) {}

  const Eigen::MatrixXd& changes() const { return changes_; }  ///< [p, samples]
  std::size_t not_settled() const { return static_cast<std::size_t>(std::accumulate(open_.begin(), open_.end(), 0.0)); }

  std::uint64_t fingerprint() const {
    Digest digest;
    digest.add_text("Monte Carlo");
    digest.add_text(vector_instructions());
    digest.add(options_.samples);
    digest.add(options_.seed);
    digest.add(static_cast<std::uint64_t>(options_.chord_iterations));
    digest.add_numbers({estimates_.data(), static_cast<std::size_t>(estimates_.size())});
    sampled_.add_to(digest);
    return digest.value();
  }

  void draw_and_fit() {
    NumberedWork work;
    work.name = "Monte Carlo";
    work.blocks = open_.size();
    // The observations stand at one point at a time.
    work.in_parallel = false;
    work.for_all = true;
    work.fingerprint = [this] { return fingerprint(); };
    work.compute = [this](std::size_t batch) { compute(batch); };
    work.pack = [this](std::size_t batch, std::vector<std::byte>& bytes) {
      pack_numbers({&open_[batch], 1}, bytes);
      pack_numbers(changes_of(batch), bytes);
    };
    work.unpack = [this](std::size_t batch, std::span<const std::byte> bytes) {
      unpack_numbers(bytes, {&open_[batch], 1});
      unpack_numbers(bytes, changes_of(batch));
      require_unpacked(bytes);
    };
    do_work(options_.work, work);
  }

 private:
  std::size_t size(std::size_t batch) const { return std::min(kSampleBatch, options_.samples - batch * kSampleBatch); }

  std::span<double> changes_of(std::size_t batch) {
    const auto p = static_cast<std::size_t>(changes_.rows());
    return {changes_.data() + p * batch * kSampleBatch, p * size(batch)};
  }

  template <typename Work>
  void in_tasks(std::size_t batch_size, const Work& work) const {
    for_each_block((batch_size + kSampleTask - 1) / kSampleTask, options_.threads, [&](std::size_t task) {
      const std::size_t first = task * kSampleTask;
      work(first, std::min(kSampleTask, batch_size - first));
    });
  }

  void compute(std::size_t number) {
    stop_if_asked(options_.stop);
    const std::size_t start = number * kSampleBatch, batch = size(number), length = sampled_.length();
    std::atomic<std::size_t> not_settled{0};
    const auto fit = [&](const std::vector<double>& residuals, bool counts) {
      in_tasks(batch, [&](std::size_t first, std::size_t count) {
        const std::size_t open = sampled_.fit(residuals.data() + first * length, count,
                                              y_.middleCols(static_cast<Index>(first), static_cast<Index>(count)));
        if (counts) not_settled += open;
      });
    };
    y_.setZero();
    in_tasks(batch, [&](std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i)
        sampled_.draw(options_.seed, start + i, noise_.data() + i * length);
    });
    fit(noise_, options_.chord_iterations == 0);
    for (int iteration = 0; iteration < options_.chord_iterations; ++iteration) {
      for (std::size_t i = 0; i < batch; ++i)
        sampled_.exact(estimates_ + sampled_.directions() * y_.col(static_cast<Index>(i)), noise_.data() + i * length,
                       changed_.data() + i * length);
      fit(changed_, iteration + 1 == options_.chord_iterations);
    }
    changes_.middleCols(static_cast<Index>(start), static_cast<Index>(batch)) =
        sampled_.directions() * y_.leftCols(static_cast<Index>(batch));
    open_[number] = static_cast<double>(not_settled.load());
  }

  const SampledFit& sampled_;
  const Eigen::VectorXd& estimates_;
  const MonteCarloOptions& options_;
  std::vector<double> noise_, changed_;  // of one batch
  Eigen::MatrixXd y_;                    // free variables of one batch
  Eigen::MatrixXd changes_;
  std::vector<double> open_;  // [batches] samples that have not settled
};

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
  SampleBatches batches(sampled, estimates, options);
  batches.draw_and_fit();
  const Eigen::MatrixXd& changes = batches.changes();
  set_observations(problem, estimates);
  const auto of_changes = [&batches](std::string_view what) {
    Digest digest;
    digest.add_text(what);
    digest.add(batches.fingerprint());
    return digest;
  };
  const SampleMoments moments =
      sample_moments(changes, options.threads, options.work, [&] { return of_changes("moments").value(); });
  if (!moments.mean.allFinite()) {
    result.status = MonteCarloStatus::no_solution;
    return result;
  }
  result.samples = options.samples;
  result.not_settled = batches.not_settled();
  result.mean = estimates + moments.mean;
  result.covariance = moments.covariance;
  QuantityFigures of_estimates(changes, nullptr, options.probabilities);
  of_estimates.find(options, [&] { return of_changes("percentiles").value(); });
  result.percentiles = of_estimates.percentiles().colwise() + estimates;
  if (prediction && prediction->rows() > 0) {
    QuantityFigures predicted(changes, prediction, options.probabilities);
    predicted.find(options, [&] {
      Digest digest = of_changes("percentiles");
      digest.add_numbers({prediction->data(), static_cast<std::size_t>(prediction->size())});
      return digest.value();
    });
    result.prediction_mean = predicted.mean();
    result.prediction_uncertainty = predicted.deviation();
    result.prediction_percentiles = predicted.percentiles();
  }
  result.status = MonteCarloStatus::done;
  return result;
}

}  // namespace abbe
