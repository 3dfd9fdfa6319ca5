#include "abbe/identify/levenberg_marquardt.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/stopped.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// A kept factor stays while the gradient falls by this factor (in the metric of the factor, squared) per iteration.
constexpr double kChordReduction = 0.04;
constexpr double kLargestDamping = 1e16;
// Below this predicted relative decrease the difference of two costs is rounding.
constexpr double kCostResolution = 1e-11;
constexpr double kStillFalling = 0.98;
// A point is stationary if the undamped quadratic model promises no more than this part of the cost, or no more than
// this of a standard uncertainty (squared), which readings without noise come down to.
constexpr double kStationary = 1e-10;
constexpr double kStationaryAbsolute = 1e-12;

/// The iteration's state in the free variables y of x = particular + directions y.
class Minimiser {
 public:
  Minimiser(const ReadingStream& stream, const ConstrainedSpace* space, const Loss& loss, const SolverOptions& options)
      : stream_(stream),
        space_(space && space->directions.size() > 0 ? space : nullptr),
        loss_(loss),
        options_(options) {}

  SolverResult run(const Eigen::VectorXd& start, const NormalEquations* at_start) {
    SolverResult result;
    x_ = start;
    if (space_)
      x_ = space_->particular +
           space_->directions * Ldlt<>(space_->directions.transpose() * space_->directions)
                                    .solve(space_->directions.transpose() * (start - space_->particular));
    sums_ = at_start ? *at_start : stream_.sums(x_, loss_, Wanted::normal);
    if (!sums_.finite) {
      result.status = IdentifyStatus::not_finite;
      result.estimates = start;
      return result;
    }
    take_normal(sums_.normal);
    iterate(result);
    if (!normal_is_current_) {
      sums_ = stream_.sums(x_, loss_, Wanted::normal);
      take_normal(sums_.normal);
    }
    if (result.status == IdentifyStatus::converged && options_.least_damping == 0 && !well_determined())
      result.status = IdentifyStatus::rank_deficient;
    result.estimates = x_;
    result.normal = normal_;
    result.cost = sums_.cost;
    return result;
  }

 private:
  void keep(const IterationRecord& record, SolverResult& result) const {
    result.history.push_back(record);
    if (options_.progress) options_.progress(record);
  }

  void take_normal(const Eigen::MatrixXd& normal) {
    normal_ = normal;
    reduced_ = space_ ? Eigen::MatrixXd(space_->directions.transpose() * (normal * space_->directions)) : normal;
    const Eigen::VectorXd norms = reduced_.diagonal().cwiseMax(0.0).cwiseSqrt();
    // The largest norm seen (More): keeps the trust region from following a column that vanishes for a moment.
    scale_ = scale_.size() == 0 ? norms : Eigen::VectorXd(scale_.cwiseMax(norms));
    for (Index i = 0; i < scale_.size(); ++i)
      if (!(scale_[i] > 0)) scale_[i] = 1;
    const Eigen::VectorXd inverse = scale_.cwiseInverse();
    reduced_ = (inverse.asDiagonal() * reduced_ * inverse.asDiagonal()).eval();
    normal_is_current_ = true;
    factored_ = false;
  }

  Eigen::VectorXd scaled_gradient() const {
    const Eigen::VectorXd free =
        space_ ? Eigen::VectorXd(space_->directions.transpose() * sums_.gradient) : sums_.gradient;
    return free.cwiseQuotient(scale_);
  }

  bool factor(double damping) {
    Eigen::MatrixXd damped = reduced_;
    damped.diagonal().array() += damping;
    factor_.compute(damped);
    factored_ = factor_.info() == Eigen::Success;
    factor_damping_ = damping;
    return factored_;
  }

  double least_damping() const { return std::max(options_.least_damping, 1e-15); }

  // Size of the present point in the scaled variables, as far as a step can be compared with it.
  double point_size() const {
    if (!space_) return x_.cwiseProduct(scale_).norm();
    return normal_.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseProduct(x_).norm();
  }

  bool well_determined() const {
    const Eigen::VectorXd norms = reduced_.diagonal().cwiseMax(0.0).cwiseSqrt();
    if (!(norms.minCoeff() > 0)) return false;
    const Eigen::VectorXd inverse = norms.cwiseInverse();
    const Ldlt<> factor(inverse.asDiagonal() * reduced_ * inverse.asDiagonal());
    return factor.info() == Eigen::Success && factor.diagonal().minCoeff() > 1e-15;
  }

  /// True if what is left to gain is nothing: half the square of the gradient in the metric of the covariance.
  ///
  /// Without damping. A damped step is short where the readings hardly see, whether or not the minimum is near.
  bool is_stationary(const Eigen::VectorXd& gradient) const {
    Eigen::MatrixXd normal = reduced_;
    normal.diagonal().array() += options_.least_damping;
    const Cholesky undamped(normal);
    if (undamped.info() != Eigen::Success) return true;  // and rank deficient: run() says so
    const double gain = undamped.half_solve(gradient).squaredNorm() / 2;
    return gain <= std::max(std::max(kStationary, options_.relative_cost) * sums_.cost, kStationaryAbsolute);
  }

  void iterate(SolverResult& result) {
    double damping = options_.start_damping;
    double growth = 2;
    double last_decrement = -1;  // of the previous step with this factor; negative: factor is new
    bool chord = false;
    result.status = IdentifyStatus::no_convergence;
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      stop_if_asked(options_.stop);
      const Eigen::VectorXd gradient = scaled_gradient();
      const double residual_norm = std::sqrt(2 * sums_.cost);
      IterationRecord record;
      record.cost = sums_.cost;
      record.gradient = residual_norm > 0 ? gradient.cwiseAbs().maxCoeff() / residual_norm : 0;
      const auto finish = [&] {
        keep(record, result);
        result.status = IdentifyStatus::converged;
      };
      if (record.gradient <= options_.gradient && is_stationary(gradient)) return finish();

      if (!chord) {
        bool solvable = factor(damping);
        while (!solvable && damping < kLargestDamping) {
          damping = std::max(damping * 10, least_damping());
          solvable = factor(damping);
        }
        if (!solvable) break;
      }
      const Eigen::VectorXd step = factor_.solve(gradient);
      const double decrement = step.dot(gradient);
      const double predicted = (decrement + factor_damping_ * step.squaredNorm()) / 2;
      record.damping = chord ? 0 : damping;
      record.chord = chord;
      record.step = step.norm() / std::max(point_size(), 1e-300);

      if (chord && last_decrement >= 0 && decrement > kChordReduction * last_decrement) {
        // The factor is too old: build it anew here, at no loss of ground.
        sums_ = stream_.sums(x_, loss_, Wanted::normal);
        take_normal(sums_.normal);
        chord = false;
        last_decrement = -1;
        continue;
      }
      if (predicted <= options_.relative_cost * sums_.cost || record.step <= options_.step) {
        if (is_stationary(gradient)) return finish();
        // The damping alone made the step short.
        if (factor_damping_ <= 1e-2 && factor_damping_ > least_damping()) {
          damping = std::max(damping * 1e-3, least_damping());
          chord = false;
          last_decrement = -1;
          continue;
        }
        if (record.step <= options_.step && factor_damping_ > 1e-2) {
          keep(record, result);
          break;
        }
      }

      const Eigen::VectorXd free_step = step.cwiseQuotient(scale_);
      const Eigen::VectorXd trial =
          space_ ? Eigen::VectorXd(x_ + space_->directions * free_step) : Eigen::VectorXd(x_ + free_step);
      const bool expect_chord = options_.chord_iterations && factor_damping_ <= 1e-3 && (chord || last_ratio_is_good_);
      NormalEquations next = stream_.sums(trial, loss_, expect_chord ? Wanted::gradient : Wanted::normal);
      const double ratio = next.finite && predicted > 0 ? (sums_.cost - next.cost) / predicted : -1;
      record.accepted = ratio > 0;
      keep(record, result);
      if (next.finite && predicted <= kCostResolution * sums_.cost) {
        // The cost no longer resolves the step; the gradient does. Go on while it falls.
        const Eigen::VectorXd free =
            space_ ? Eigen::VectorXd(space_->directions.transpose() * next.gradient) : next.gradient;
        const Eigen::VectorXd scaled = free.cwiseQuotient(scale_);
        const bool falls = factor_.solve(scaled).dot(scaled) < kStillFalling * decrement;
        if (!falls && is_stationary(gradient)) {
          result.status = IdentifyStatus::converged;
          return;
        }
        if (!falls) {
          damping = std::max(damping, least_damping()) * growth;
          growth *= 2;
          if (damping > kLargestDamping) break;
          chord = false;
          last_decrement = -1;
          continue;
        }
        x_ = trial;
        sums_ = std::move(next);
        normal_is_current_ = false;
        chord = expect_chord;
        last_decrement = expect_chord ? decrement : -1;
        if (!expect_chord) take_normal(sums_.normal);
        damping = std::max(damping * 0.1, least_damping());
        continue;
      }
      if (!record.accepted) {
        if (chord) {
          sums_ = stream_.sums(x_, loss_, Wanted::normal);
          take_normal(sums_.normal);
          chord = false;
          last_decrement = -1;
        }
        last_ratio_is_good_ = false;
        damping = std::max(damping, least_damping()) * growth;
        growth *= 2;
        if (damping > kLargestDamping) break;
        continue;
      }
      x_ = trial;
      sums_ = std::move(next);
      damping *= std::max(1.0 / 3.0, 1 - std::pow(2 * std::min(ratio, 2.0) - 1, 3));
      if (ratio > 0.9 && ratio < 1.1) damping *= 0.1;
      damping = std::max(damping, options_.least_damping);
      growth = 2;
      last_ratio_is_good_ = std::abs(ratio - 1) < 0.1;
      normal_is_current_ = false;
      if (expect_chord) {
        last_decrement = decrement;
        chord = true;
      } else {
        take_normal(sums_.normal);
        chord = false;
        last_decrement = -1;
      }
    }
  }

  const ReadingStream& stream_;
  const ConstrainedSpace* space_;
  const Loss& loss_;
  const SolverOptions& options_;
  Eigen::VectorXd x_;
  NormalEquations sums_;
  Eigen::MatrixXd normal_;   // [p, p] at the point of the factor
  Eigen::MatrixXd reduced_;  // free variables, column-scaled
  Eigen::VectorXd scale_;
  Cholesky factor_;
  double factor_damping_ = 0;
  bool factored_ = false;
  bool normal_is_current_ = false;
  bool last_ratio_is_good_ = false;
};

}  // namespace

const char* status_text(IdentifyStatus status) {
  switch (status) {
    case IdentifyStatus::not_run:
      return "not run";
    case IdentifyStatus::converged:
      return "converged";
    case IdentifyStatus::no_convergence:
      return "no convergence";
    case IdentifyStatus::rank_deficient:
      return "rank deficient";
    case IdentifyStatus::too_few_readings:
      return "too few readings";
    case IdentifyStatus::not_finite:
      return "not finite";
  }
  return "unknown";
}

SolverResult solve(const Problem& problem, const Eigen::VectorXd& start, const ConstrainedSpace* space,
                   const Loss& loss, const SolverOptions& options) {
  const ReadingStream stream(problem, options.threads, options.summation, options.stop);
  return solve(stream, start, space, loss, options, nullptr);
}

SolverResult solve(const ReadingStream& stream, const Eigen::VectorXd& start, const ConstrainedSpace* space,
                   const Loss& loss, const SolverOptions& options, const NormalEquations* at_start) {
  return Minimiser(stream, space, loss, options).run(start, at_start);
}

}  // namespace abbe
