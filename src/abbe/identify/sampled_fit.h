#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/digest.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {

/// A problem at its solution, ready to be identified again from simulated readings: kept Jacobian of the free
/// variables, kept factor, residuals.
///
/// Samples are whitened residuals in the order of the blocks of readings, priors behind them, padded with zeros to
/// length(). Free variables y: estimates = solution + directions() * y.
class SampledFit {
 public:
  /// @param loss  with which samples are fitted; `none`: least squares. Its scale is also that of the noise drawn.
  SampledFit(const Problem& problem, const Identification& identification, const Loss& loss, int threads);

  std::size_t bytes() const;                                         ///< of what is kept, and of a batch of samples
  std::size_t length() const { return length_; }                     ///< of a sample
  const Eigen::MatrixXd& directions() const { return directions_; }  ///< [p, free]

  /// Jacobian and factor. @returns false if the readings do not determine the free variables
  bool prepare();

  /// After prepare(): adds everything that samples depend on besides their numbers, the readings with their commands
  /// among them.
  void add_to(Digest& digest) const;

  /// Draws the errors of all readings and priors in whitened space: standard normal; with a robust loss the outliers of
  /// the identification get theirs again, of the same size in a random direction.
  void draw(std::uint64_t seed, std::size_t sample, double* errors) const;

  /// Residuals of a sample at `estimates` with the exact model: errors plus the change of the model's residuals.
  void exact(const Eigen::VectorXd& estimates, const double* errors, double* residuals) const;

  /// Fits the linearised model to `count` samples' residuals and adds the free variables found to the columns of y.
  ///
  /// Least squares is one step; a robust loss iterates with pseudo-residuals w r and the kept factor (Huber 1981, 7.8)
  /// until a step is below a thousandth of the standard uncertainties.
  /// @returns samples that did not settle
  std::size_t fit(const double* residuals, std::size_t count, Eigen::Ref<Eigen::MatrixXd> y) const;

 private:
  struct Shift {
    std::size_t first, rows, stride;  ///< rows of the reading: first + r * stride
    double size;                      ///< standard uncertainties
  };
  void model_residuals(const Eigen::VectorXd& estimates, double* out) const;
  Eigen::MatrixXd step(const double* residuals, std::size_t count, Eigen::VectorXd& decrements) const;
  std::size_t row_of(std::size_t observations, std::size_t reading, std::size_t& stride) const;
  template <typename Work>
  void for_each_reading(const Work& work) const;
  void scale_rows_for_loss(std::vector<double>& jacobian) const;
  void weigh(double* residuals) const;

  const Problem& problem_;
  ReadingStream stream_;
  Loss loss_;
  Eigen::VectorXd estimates_;
  std::vector<Shift> shifts_;
  std::vector<std::size_t> first_;
  std::size_t rows_ = 0, length_ = 0, free_ = 0, columns_ = 0;
  Eigen::MatrixXd priors_, directions_;
  std::vector<double> jacobian_, residuals_;
  Eigen::VectorXd inverse_scale_;
  Cholesky factor_;
};

/// Samples in one batch and in one piece of work; fixed, so that sums do not depend on the number of threads.
inline constexpr std::size_t kSampleBatch = 64;
inline constexpr std::size_t kSampleTask = 8;

}  // namespace abbe
