#include "abbe/identify/variance_components.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace abbe {
namespace {

constexpr double kComponentsSettled = 1e-12;  // square of the step in standard uncertainties
constexpr double kLeastStep = 0.1;            // a variance falls to no less than this part of itself at once
constexpr double kNoVariance = 0.01;          // standard uncertainties of a variance that is falling to zero
constexpr double kNotSeparable = 1e-3;        // 1 - square of the correlation of the two estimates

/// Step of Fisher scoring over the variances that are free, and its square in their standard uncertainties.
struct Scoring {
  bool solved = false;
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double decrement = 0;
};

Scoring scoring(const RestrictedLikelihood& at, bool factor, bool pose) {
  Scoring result;
  const Eigen::Matrix2d& f = at.information;
  if (factor && pose) {
    const double determinant = f(0, 0) * f(1, 1) - f(0, 1) * f(0, 1);
    if (!(f(0, 0) > 0 && f(1, 1) > 0 && determinant > kNotSeparable * f(0, 0) * f(1, 1))) return result;
    result.covariance << f(1, 1), -f(0, 1), -f(0, 1), f(0, 0);
    result.covariance /= determinant;
  } else {
    const int i = factor ? 0 : 1;
    if (!(f(i, i) > 0)) return result;
    result.covariance(i, i) = 1 / f(i, i);
  }
  result.step = result.covariance * at.score;
  result.decrement = at.score.dot(result.step);
  result.solved = std::isfinite(result.decrement);
  return result;
}

class VarianceEstimation {
 public:
  VarianceEstimation(Problem& problem, const VarianceComponentChoice& choice, const IdentifyOptions& options,
                     WeighedIdentification& result)
      : given_(problem),
        errors_(problem.errors),
        start_(present_values(problem)),
        choice_(choice),
        options_(options),
        result_(result) {
    assert(choice.any() && options.loss == LossKind::none && !options.apply_variance_factor);
    result_.components.estimated = choice;
    result_.problem = problem;
    for (SelectedObservations& selected : result_.problem.observations) {
      result_.observations.push_back(
          std::make_shared<WeighedObservations>(selected.observations, selected.use, selected.common));
      selected.observations = result_.observations.back();
      poses_.push_back(&result_.observations.back()->poses());
    }
    set_observations(result_.problem, start_);
  }

  void run() {
    VarianceComponents& components = result_.components;
    if (!fit()) return;
    const FitStatistics& stated = result_.identification.statistics;
    components.stated_chi_square = stated.chi_square;
    components.stated_degrees_of_freedom = stated.degrees_of_freedom;
    components.stated_p_value = stated.p_value;
    if (!(stated.degrees_of_freedom > 0) || !(stated.chi_square > 0))
      return fail(IdentifyStatus::too_few_readings, "no residuals are left to estimate the variances of the readings");
    if (const std::string why = not_estimable(); !why.empty()) return fail(IdentifyStatus::rank_deficient, why);
    ReadingVariance& variance = components.variance;
    if (choice_.variance_factor) {
      variance.factor = stated.variance_factor;
      if (!fit()) return;
    }
    for (;;) {
      const RestrictedLikelihood at = restricted_likelihood(result_.problem, result_.identification, options_.solver);
      // At zero the pose noise stays there as long as the likelihood falls from there.
      const bool pose = choice_.pose_noise && (variance.pose > 0 || at.score[1] > 0);
      const Scoring now = scoring(at, choice_.variance_factor, pose);
      if (!now.solved) return fail(IdentifyStatus::rank_deficient, inseparable());
      if (now.decrement <= kComponentsSettled) return settle(at);
      if (components.iterations >= choice_.max_iterations)
        return fail(IdentifyStatus::no_convergence,
                    fmt::format("the variances of the readings have not settled after {} identifications",
                                components.iterations));
      variance.factor = std::max(variance.factor + now.step[0], kLeastStep * variance.factor);
      variance.pose = step_of_pose(variance.pose, now);
      if (!fit()) return;
    }
  }

 private:
  static constexpr const char* kInseparable =
      "the readings do not tell the variance factor from the pose noise: only poses with several readings do";
  static constexpr const char* kInseparableBlocks =
      "the readings do not tell the variance factor from the noise of a block of time: only blocks with several "
      "readings "
      "do";
  const char* inseparable() const { return choice_.by_block ? kInseparableBlocks : kInseparable; }

  bool fit() {
    // Derivatives by the displacement are those at the last estimates; the fit itself begins where the problem does.
    for (const std::shared_ptr<WeighedObservations>& one : result_.observations)
      one->weigh(result_.components.variance);
    result_.problem.errors = errors_;
    set_observations(result_.problem, start_);
    ++result_.components.iterations;
    result_.identification = identify(result_.problem, options_);
    given_.errors = result_.problem.errors;
    return result_.identification.status == IdentifyStatus::converged;
  }

  void fail(IdentifyStatus status, const std::string& message) {
    result_.identification.status = status;
    result_.identification.converged = false;  // at a minimum, but not with the weights that were sought
    result_.identification.message = message;
  }

  std::string not_estimable() const {
    if (!choice_.pose_noise) return "";
    std::size_t most = 0;
    for (const PoseGroups* poses : poses_) most = std::max(most, poses->most_readings());
    if (most == 0 && choice_.by_block)
      return "the readings do not see a displacement that is common to a block of time";
    if (most == 0) return "the readings do not see a displacement at their pose: they have no pose noise";
    return choice_.variance_factor && most < 2 ? inseparable() : "";
  }

  // Towards zero in steps, because an estimate that is small is not yet none.
  static double step_of_pose(double pose, const Scoring& now) {
    const double next = pose + now.step[1];
    if (next > kLeastStep * pose) return next;
    return pose < kNoVariance * std::sqrt(now.covariance(1, 1)) ? 0 : kLeastStep * pose;
  }

  void settle(const RestrictedLikelihood& at) {
    const Scoring whole = scoring(at, choice_.variance_factor, choice_.pose_noise);
    if (!whole.solved) return fail(IdentifyStatus::rank_deficient, inseparable());
    result_.components.covariance = whole.covariance;
    result_.components.pose_noise_at_zero = choice_.pose_noise && result_.components.variance.pose == 0;
    result_.components.converged = true;
  }

  Problem& given_;
  ErrorSet errors_;
  Eigen::VectorXd start_;
  VarianceComponentChoice choice_;
  IdentifyOptions options_;
  WeighedIdentification& result_;
  std::vector<const PoseGroups*> poses_;
};

}  // namespace

double VarianceComponents::variance_factor_uncertainty() const { return std::sqrt(covariance(0, 0)); }

double VarianceComponents::pose_noise() const { return std::sqrt(variance.pose); }

double VarianceComponents::pose_noise_uncertainty() const {
  const double u = std::sqrt(covariance(1, 1));
  return variance.pose > 0 ? u / (2 * pose_noise()) : std::sqrt(2 * u);
}

WeighedIdentification identify_with_variances(Problem& problem, const VarianceComponentChoice& choice,
                                              const IdentifyOptions& options) {
  WeighedIdentification result;
  VarianceEstimation(problem, choice, options, result).run();
  return result;
}

}  // namespace abbe
