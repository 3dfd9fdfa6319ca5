#include "abbe/identify/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/identify/robust_covariance.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr int kMostScaleRounds = 12;
// Below this relative singular value the covariance is taken from an orthogonal factor instead of J'J. J'J loses
// rounding / square of it: 1e-8, or 1e-4 of the worst variance where the factor would take longer than the rest.
constexpr double kIllConditioned = 1e-4;
constexpr double kIllConditionedLarge = 1e-6;
constexpr double kLarge = 5e8;  // residuals times square of the parameters
// A gauge that costs this part of the cost along one clearly seen direction is none.
constexpr int kMostGaugeRounds = 2;
constexpr double kSeenByCost = 1e-9;
constexpr double kRestriction = 0.1;
constexpr double kNoCost = 1e-9;  // readings without noise leave rounding, which says nothing about the gauge
// A gauge may have slipped if the inverse condition of the scaled Jacobian is below the first, and below this part of
// that at the start.
constexpr double kSlippedObservability = 1e-5;
constexpr double kSlipped = 0.01;
constexpr double kOpenDamping = 1e-9;  // keeps steps along unseen directions short
constexpr double kSameCost = 1e-6;

struct GaugeAttempt {
  GaugeOrder order = GaugeOrder::convention;
  bool as_found = false;  // location errors and set-up at the values of the fit without a gauge
};
// Tried in turn at a solution that was found without a gauge. The zeros of the first two can lie where axes of the
// machine are parallel and the readings see less than they do nearby; no choice of equations is firm there. At the
// values that were found the readings see.
constexpr GaugeAttempt kGaugeAttempts[] = {
    {GaugeOrder::convention, false}, {GaugeOrder::firmest, false}, {GaugeOrder::firmest, true}};

std::vector<double> scaled_norms(const Problem& problem, const std::vector<std::vector<double>>& norms) {
  std::vector<double> result;
  for (std::size_t o = 0; o < norms.size(); ++o)
    for (const double norm : norms[o])
      if (norm >= 0) result.push_back(norm / median_norm(problem.observations[o].observations->rows()));
  return result;
}

class Run {
 public:
  Run(Problem& problem, const IdentifyOptions& options)
      : problem_(problem),
        options_(options),
        solver_(options.solver),
        stream_(problem, options.solver.threads, options.solver.summation, options.solver.stop),
        start_(present_values(problem)) {}

  Identification run() {
    result_.parameters = estimated_parameters(problem_);
    result_.gauge.parameter_count = result_.parameters.size();
    const double available = static_cast<double>(used_residual_count(problem_)) + prior_residual_count(problem_);
    if (used_reading_count(problem_) == 0 || available < static_cast<double>(start_.size()))
      return fail(IdentifyStatus::too_few_readings,
                  fmt::format("{} residuals for {} parameters", available, start_.size()));
    at_start_ = stream_.sums(start_, Loss{}, Wanted::normal);
    if (!at_start_.finite)
      return fail(IdentifyStatus::not_finite, "a residual or derivative at the start is not a finite number");
    if (!fix()) return fail(IdentifyStatus::rank_deficient, rank_message());
    const Eigen::VectorXd given = start_;
    SolverResult solved = solve_in_gauge(given);
    if (options_.gauge == GaugeChoice::iso && gauge_has_slipped(solved)) solve_before_gauge(given, solved);
    const ConstrainedSpace* space = present_space();
    if (solved.status == IdentifyStatus::not_finite || solved.status == IdentifyStatus::rank_deficient) start_ = given;
    result_.status = solved.status;
    if (solved.status == IdentifyStatus::not_finite || solved.status == IdentifyStatus::rank_deficient)
      return fail(solved.status, solved.status == IdentifyStatus::not_finite
                                     ? "a residual or derivative is not a finite number"
                                     : "the readings do not determine all parameters at the solution");
    finish(solved, space);
    return result_;
  }

 private:
  Identification fail(IdentifyStatus status, std::string message) {
    set_observations(problem_, start_);
    result_.status = status;
    result_.message = std::move(message);
    return result_;
  }

  std::string rank_message() const {
    return fmt::format("rank {} of {} parameters and no gauge stated", result_.gauge.rank_at_start, start_.size());
  }

  std::string no_convergence_message() const {
    constexpr double kFarFromNoise = 3;
    const double ratio = std::sqrt(result_.statistics.variance_factor);
    const std::string what = fmt::format("no convergence after {} iterations", result_.history.size());
    if (!(ratio > kFarFromNoise)) return what;
    return fmt::format(
        "{}; the residuals are still {:.3g} times as large as their stated uncertainties. A number of the set-up or of "
        "the machine may be wrong, such as a scale, an offset, or the direction or point of an axis",
        what, ratio);
  }

  bool fix() {
    NullSpace null_space = find_null_space(stream_, start_, at_start_);
    Eigen::VectorXd nominal = start_;
    nominal.head(static_cast<Index>(problem_.machine_parameters.size())).setZero();
    if (nominal != start_) {
      // Large start values couple unseen directions to others at second order; they are no better known for that.
      const NormalEquations sums = stream_.sums(nominal, Loss{}, Wanted::normal);
      if (sums.finite) {
        NullSpace at_nominal = find_null_space(stream_, nominal, sums);
        if (at_nominal.basis.cols() > null_space.basis.cols()) null_space = std::move(at_nominal);
      }
    }
    if (null_space.basis.cols() > 0 && options_.gauge == GaugeChoice::none) {
      result_.gauge.rank_at_start = null_space.rank;
      result_.gauge.singular_values = null_space.singular_values;
      return false;
    }
    take_gauge(null_space, start_);
    return true;
  }

  const ConstrainedSpace* present_space() const { return result_.gauge.constraints.empty() ? nullptr : &result_.space; }

  SolverResult solve_in_gauge(const Eigen::VectorXd& given) {
    for (int round = 0;; ++round) {
      const SolverResult solved = solve_now(present_space());
      if (round == kMostGaugeRounds || solved.status != IdentifyStatus::converged || !present_space() ||
          !restricts(solved))
        return solved;
      // What was unseen at the start is seen here: a property of that point, not of the problem.
      start_from(solved.estimates);
      take_gauge(find_null_space(stream_, start_, at_start_), given);
    }
  }

  SolverResult solve_now(const ConstrainedSpace* space) {
    SolverResult solved = options_.loss == LossKind::none ? least_squares(space) : robust(space);
    result_.history.insert(result_.history.end(), solved.history.begin(), solved.history.end());
    return solved;
  }

  void start_from(const Eigen::VectorXd& estimates) {
    start_ = estimates;
    at_start_ = stream_.sums(start_, Loss{}, Wanted::normal);
  }

  // True where the equations of the gauge, chosen at the start, may have become all but unable to fix what is unseen.
  // The solver then gets nowhere, or stops at a point that only this singularity makes stationary.
  bool gauge_has_slipped(const SolverResult& solved) const {
    if (!present_space() || solved.status == IdentifyStatus::not_finite) return false;
    if (solved.status != IdentifyStatus::converged) return true;
    const auto seen = [&](const Eigen::MatrixXd& normal) { return observability_of(normal, present_space(), 1).o2; };
    const double seen_there = seen(solved.normal);
    return seen_there < kSlippedObservability && seen_there < kSlipped * seen(at_start_.normal);
  }

  // First the readings, by steps that are the shortest where nothing is seen, then the gauge that suits the machine
  // found: far from the start other equations may be needed than there.
  void solve_before_gauge(const Eigen::VectorXd& given, SolverResult& solved) {
    const GaugeReport gauge = result_.gauge;
    const ConstrainedSpace space = result_.space;
    start_from(given);
    solver_.least_damping = kOpenDamping;
    const SolverResult open = solve_now(nullptr);
    solver_.least_damping = 0;
    for (const GaugeAttempt& attempt : kGaugeAttempts) {
      if (open.status != IdentifyStatus::converged) break;
      start_from(open.estimates);
      attempt_ = attempt;
      const NullSpace null_space = find_null_space(stream_, start_, at_start_);
      // A direction that is seen a little has its own minimum, which may be elsewhere.
      if (attempt.as_found && null_space.weak > 0) break;
      take_gauge(null_space, given);
      const SolverResult again = solve_in_gauge(given);
      if (again.status == IdentifyStatus::converged && again.cost <= (1 + kSameCost) * open.cost + kSameCost &&
          !gauge_has_slipped(again)) {
        solved = again;
        return;
      }
    }
    result_.gauge = gauge;
    result_.space = space;
    start_ = given;
    // Stationary, but not known to be the minimum: there is a lower point, or nothing is known of it.
    if (solved.status == IdentifyStatus::converged &&
        !(open.status == IdentifyStatus::converged && solved.cost <= (1 + kSameCost) * open.cost + kSameCost))
      solved.status = IdentifyStatus::no_convergence;
  }

  /// @param given  the start of the identification: what set-up unknowns keep that the gauge fixes
  void take_gauge(const NullSpace& null_space, const Eigen::VectorXd& given) {
    lack_of_data_ = false;
    result_.gauge.warnings.clear();
    result_.gauge.rank_at_start = null_space.rank;
    result_.gauge.weak_at_start = null_space.weak;
    result_.gauge.singular_values = null_space.singular_values;
    result_.gauge.constraints =
        fix_gauge(problem_, null_space, given, options_.gauge, attempt_.order, attempt_.as_found ? &start_ : nullptr);
    result_.space = constrained_space(result_.gauge.constraints, start_, null_space.column_norms);
    for (const GaugeConstraint& constraint : result_.gauge.constraints) {
      lack_of_data_ = lack_of_data_ || !constraint.by_convention;
      result_.gauge.warnings.push_back(fmt::format("{}; fixed by: {}", constraint.inseparable_words, constraint.words));
    }
    if (null_space.weak > 0)
      result_.gauge.warnings.push_back(fmt::format(
          "{} directions are seen by less than 3e-8 of the best one and were fixed as if unseen", null_space.weak));
  }

  // True if the equations of the gauge hold the cost up: at the solution a direction is clearly seen and has a slope.
  bool restricts(const SolverResult& solved) const {
    const NormalEquations sums = stream_.sums(solved.estimates, loss_, Wanted::gradient);
    for (const GaugeConstraint& constraint : result_.gauge.constraints) {
      const Eigen::VectorXd& n = constraint.direction;
      const double seen = n.dot(solved.normal * n);
      if (!(seen > kSeenByCost * n.cwiseAbs2().dot(solved.normal.diagonal()))) continue;
      const double slope = sums.gradient.dot(n);
      if (slope * slope / (2 * seen) > kRestriction * std::max(solved.cost, kNoCost)) return true;
    }
    return false;
  }

  SolverResult least_squares(const ConstrainedSpace* space) {
    return solve(stream_, start_, space, Loss{}, solver_, space ? nullptr : &at_start_);
  }

  double stated_or_robust_scale(const Eigen::VectorXd& at) const {
    return median_scale(scaled_norms(problem_, stream_.norms(at)));
  }

  // Cauchy with a scale that shrinks from the size of the start's residuals to that of the noise: gross outliers lose
  // their weight before the loss is asked to tell them from good readings. Then the wanted loss at the final scale.
  SolverResult robust(const ConstrainedSpace* space) {
    Eigen::VectorXd x = start_;
    double scale = std::max(1.0, stated_or_robust_scale(x));
    SolverOptions rough = solver_;
    rough.relative_cost = 1e-4;
    rough.step = 1e-6;
    rough.max_iterations = std::min(rough.max_iterations, 20);
    for (int round = 0; round < kMostScaleRounds; ++round) {
      const Loss cauchy{LossKind::cauchy, 0, scale};
      SolverResult step = solve(stream_, x, space, cauchy, rough, nullptr);
      result_.history.insert(result_.history.end(), step.history.begin(), step.history.end());
      if (step.status == IdentifyStatus::not_finite || step.status == IdentifyStatus::rank_deficient) return step;
      x = step.estimates;
      const double measured = stated_or_robust_scale(x);
      const double next = options_.scale_from_residuals ? measured : std::max(1.0, measured);
      const bool settled = next > 0.9 * scale;
      scale = std::min(scale, std::max(next, 1e-12));
      if (settled) break;
    }
    // Outliers raise the median a little; the stated uncertainties are better known than that.
    if (!options_.scale_from_residuals) scale = 1;
    loss_ = Loss{options_.loss, options_.loss_tuning, scale};
    result_.robust_scale = scale;
    return solve(stream_, x, space, loss_, solver_, nullptr);
  }

  void finish(const SolverResult& solved, const ConstrainedSpace* space) {
    result_.estimates = solved.estimates;
    std::vector<std::vector<double>> norms;
    if (options_.list_outliers || loss_.kind != LossKind::none) norms = stream_.norms(solved.estimates);
    NormalEquations unweighted;
    LossMoments moments;
    if (loss_.kind == LossKind::none) {
      unweighted.normal = solved.normal;
      unweighted.cost = solved.cost;
    } else {
      unweighted = stream_.sums(solved.estimates, Loss{}, Wanted::normal);
    }
    list_outliers(norms);
    if (loss_.kind != LossKind::none) {
      const Index free = space ? space->directions.cols() : start_.size();
      moments = robust_moments(problem_, norms, result_.outliers, loss_, static_cast<double>(free));
      result_.statistics.robust_factor = moments.square / (moments.slope * moments.slope);
    }
    statistics(unweighted, space);
    const double parameters = static_cast<double>(start_.size());
    const bool large = static_cast<double>(stream_.residual_count()) * parameters * parameters > kLarge;
    const bool ill_conditioned = result_.statistics.observability.o2 < (large ? kIllConditionedLarge : kIllConditioned);
    const Eigen::MatrixXd priors = loss_.kind == LossKind::none ? Eigen::MatrixXd() : prior_rows(problem_);
    const Eigen::MatrixXd curvature = robust_curvature(unweighted.normal, priors, moments);
    const bool known = ill_conditioned
                           ? covariance_from_factor(
                                 robust_factor(stream_.orthogonal_factor(solved.estimates, Loss{}), priors, moments),
                                 space, result_.covariance)
                           : covariance_of_estimates(curvature, space, result_.covariance);
    keep_estimates(problem_, solved.estimates);
    result_.gauge.rank_at_solution = rank_at_solution(unweighted);
    if (!known) {
      result_.covariance.resize(0, 0);
      result_.status = IdentifyStatus::rank_deficient;
      result_.message = "the readings do not determine all parameters at the solution";
      return;
    }
    if (loss_.kind != LossKind::none) spread_of_robust_estimates(priors, moments, result_.covariance);
    if (options_.apply_variance_factor && result_.statistics.variance_factor > 0 && loss_.kind == LossKind::none)
      result_.covariance *= result_.statistics.variance_factor;
    result_.standard_uncertainties = result_.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    write_errors();
    result_.converged = solved.status == IdentifyStatus::converged;
    result_.message = result_.converged ? status_text(result_.status) : no_convergence_message();
    if (lack_of_data_ && result_.status == IdentifyStatus::converged) {
      result_.status = IdentifyStatus::rank_deficient;
      result_.message =
          "the readings leave combinations of parameters open that no convention fixes; they keep their start values "
          "and predictions at other poses may be wrong";
      result_.gauge.warnings.push_back(result_.message);
    }
  }

  std::size_t rank_at_solution(const NormalEquations& sums) const {
    if (result_.gauge.constraints.empty()) return static_cast<std::size_t>(start_.size());
    // From the normal matrix alone: a count for the report, the gauge itself stands since the start.
    const Eigen::VectorXd inverse =
        sums.normal.diagonal().unaryExpr([](double square) { return square > 0 ? 1 / std::sqrt(square) : 0.0; });
    const SymmetricEigen<> eigen(inverse.asDiagonal() * sums.normal * inverse.asDiagonal(), Eigen::EigenvaluesOnly);
    const Eigen::VectorXd& values = eigen.eigenvalues();
    return static_cast<std::size_t>((values.array() > 1e-14 * values[values.size() - 1]).count());
  }

  void statistics(const NormalEquations& sums, const ConstrainedSpace* space) {
    FitStatistics& s = result_.statistics;
    s.chi_square = 2 * sums.cost;
    s.residual_count = used_residual_count(problem_) + static_cast<std::size_t>(prior_residual_count(problem_));
    if (loss_.kind != LossKind::none) {
      // A gross error says nothing about whether model and uncertainties are right for the others.
      for (const Outlier& outlier : result_.outliers) {
        s.chi_square -= outlier.norm * outlier.norm;
        s.residual_count -= static_cast<std::size_t>(problem_.observations[outlier.observations].observations->rows());
      }
    }
    s.parameter_count = static_cast<std::size_t>(start_.size()) - result_.gauge.constraints.size();
    s.degrees_of_freedom = static_cast<double>(s.residual_count) - static_cast<double>(s.parameter_count);
    if (s.degrees_of_freedom > 0) {
      s.p_value = chi_square_exceedance(s.chi_square, s.degrees_of_freedom);
      s.variance_factor = s.chi_square / s.degrees_of_freedom;
    }
    s.observability = observability_of(sums.normal, space, used_reading_count(problem_));
  }

  void list_outliers(const std::vector<std::vector<double>>& norms) {
    for (std::size_t o = 0; o < norms.size(); ++o) {
      const int rows = problem_.observations[o].observations->rows();
      const double limit = std::sqrt(chi_square_quantile(options_.outlier_norm_quantile, rows)) * result_.robust_scale;
      for (std::size_t k = 0; k < norms[o].size(); ++k)
        if (norms[o][k] > limit) result_.outliers.push_back({o, k, norms[o][k], loss_.weight(norms[o][k], rows)});
    }
    std::stable_sort(result_.outliers.begin(), result_.outliers.end(),
                     [](const Outlier& a, const Outlier& b) { return a.norm > b.norm; });
  }

  void write_errors() {
    result_.errors = problem_.errors;
    ErrorSet& errors = result_.errors;
    std::vector<double> uncertainties(errors.parameter_count(), 0.0);
    for (std::size_t i = 0; i < problem_.machine_parameters.size(); ++i)
      uncertainties[problem_.machine_parameters[i]] = result_.standard_uncertainties[static_cast<Index>(i)];
    std::size_t next = 0;
    for (ErrorMotion& motion : errors.motions) {
      const auto first = uncertainties.begin() + static_cast<std::ptrdiff_t>(next);
      motion.standard_uncertainty.assign(first, first + static_cast<std::ptrdiff_t>(motion.coefficients.size()));
      next += motion.coefficients.size();
    }
    for (LocationError& location : errors.locations) location.standard_uncertainty = uncertainties[next++];
    for (Reversal& reversal : errors.reversals) reversal.standard_uncertainty = uncertainties[next++];
    for (const SelectedObservations& selected : problem_.observations)
      result_.setup.push_back(selected.observations->unknown_values());
  }

  Problem& problem_;
  const IdentifyOptions& options_;
  SolverOptions solver_;
  GaugeAttempt attempt_;
  ReadingStream stream_;
  Eigen::VectorXd start_;
  NormalEquations at_start_;
  Loss loss_;
  bool lack_of_data_ = false;
  Identification result_;
};

}  // namespace

Identification identify(Problem& problem, const IdentifyOptions& options) { return Run(problem, options).run(); }

}  // namespace abbe
