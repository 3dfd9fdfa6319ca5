#include "abbe/identify/term_selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr double kUndetermined = 1e-11;  // eigenvalue of the scaled normal matrix: below is rounding
constexpr double kSeenByBlock = 1e-7;    // share of a block's information along a direction that the others leave open
constexpr double kExactReadings = 1e-6;  // mean squared residual, in variances of the readings: rounding

/// Normal equations of one block, and of all readings that may predict it.
struct BlockSums {
  NormalEquations own, others;
  double residuals = 0;
};

/// What predicts one block with the present terms.
struct Predictor {
  Eigen::MatrixXd inverse;  ///< of the normal matrix of the others, pseudo-inverse over the present parameters
  Eigen::VectorXd step;
  double square = 0;    ///< mean squared residual of the block
  bool usable = false;  ///< the others determine what the block needs
};

NormalEquations sums_of(Problem problem, const Eigen::VectorXd& at, const IdentifyOptions& options,
                        const std::function<bool(std::size_t, std::size_t)>& takes_part, double* residuals) {
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    SelectedObservations& selected = problem.observations[o];
    const std::size_t count = selected.observations->reading_count();
    if (selected.use.empty()) selected.use.assign(count, 1);
    for (std::size_t k = 0; k < count; ++k) selected.use[k] = selected.use[k] != 0 && takes_part(o, k) ? 1 : 0;
  }
  if (residuals != nullptr) *residuals = static_cast<double>(used_residual_count(problem));
  return ReadingStream(problem, options.solver.threads, {}, options.solver.stop).sums(at, Loss{}, Wanted::normal);
}

class TermSearch {
 public:
  TermSearch(const Problem& problem, const std::vector<CandidateTerm>& candidates,
             const std::vector<TimeBlocks>& blocks, const TermSelectionOptions& options)
      : problem_(problem), candidates_(candidates), options_(options) {
    for (const CandidateTerm& candidate : candidates_) result.levels.push_back(candidate.least);
    if (!identify_base()) return;
    sum_blocks(blocks);
    predict();
    result.first_rms = result.last_rms = std::sqrt(mean_square());
    result.done = result.blocks > 0;
    if (!result.done) result.status = IdentifyStatus::rank_deficient;
  }

  /// Takes the best term, if it is worth it.
  bool take_one() {
    if (mean_square() < kExactReadings) return false;
    const std::vector<Trial> trials = tried();
    std::vector<double> dispersions;
    for (const Trial& trial : trials) dispersions.push_back(trial.dispersion);
    // The least that all candidates show: what the model lacks makes neighbours alike, whatever is tried.
    const double common = dispersions.empty() ? 1 : middle(std::move(dispersions));
    const Trial* best = nullptr;
    double best_probability = 1;
    for (const Trial& trial : trials) {
      if (trial.gain < options_.minimum_gain * mean_square() || (best != nullptr && trial.gain <= best->gain)) continue;
      const double probability = chi_square_exceedance(trial.wald / std::max({1.0, common, trial.dispersion}),
                                                       static_cast<double>(trial.columns.size()));
      if (probability * static_cast<double>(trials.size()) >= options_.significance) continue;
      // A lower order that would do as well comes first.
      if (best != nullptr && best->candidate == trial.candidate) continue;
      best = &trial;
      best_probability = probability;
    }
    if (best == nullptr) return false;
    const double before = std::sqrt(mean_square());
    for (const std::size_t column : best->columns) present_.push_back(static_cast<Index>(column));
    result.levels[best->candidate] = best->levels;
    predict();
    result.last_rms = std::sqrt(mean_square());
    result.taken.push_back({best->candidate, best->levels, before, result.last_rms, best_probability});
    return true;
  }

  TermSelection result;

 private:
  /// A candidate with one or two more levels.
  struct Trial {
    std::size_t candidate = 0, levels = 0;
    std::vector<std::size_t> columns;
    double gain = 0;        ///< fall of the mean squared residual of held-out blocks
    double wald = 0;        ///< chi-square of what is added, by the uncertainties as stated
    double dispersion = 1;  ///< how much more its estimates scatter from block to block than those say
  };

  static double middle(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  }

  std::vector<Trial> tried() {
    std::vector<Trial> trials;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      // By two levels too: an even dependence may need the second and not the first.
      for (std::size_t more = 1; more <= 2 && result.levels[c] + more <= candidates_[c].levels.size(); ++more) {
        Trial trial{.candidate = c, .levels = result.levels[c] + more, .columns = {}};
        trial.columns = added(c, trial.levels);
        ++result.tried;
        const std::vector<double> gains = gains_of(trial.columns);
        if (gains.empty() || !test(trial)) continue;
        trial.gain = mean(gains);
        trials.push_back(std::move(trial));
      }
    }
    return trials;
  }

  static double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }

  bool in_model(std::size_t parameter) const {
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      for (std::size_t l = result.levels[c]; l < candidates_[c].levels.size(); ++l) {
        const std::vector<std::size_t>& level = candidates_[c].levels[l];
        if (std::find(level.begin(), level.end(), parameter) != level.end()) return false;
      }
    }
    return true;
  }

  /// Columns that a candidate adds to reach this many levels.
  std::vector<std::size_t> added(std::size_t candidate, std::size_t levels) const {
    std::vector<std::size_t> columns;
    for (std::size_t l = result.levels[candidate]; l < levels; ++l) {
      for (const std::size_t parameter : candidates_[candidate].levels[l]) {
        columns.push_back(find_estimated(problem_, {ParameterId::kMachine, parameter}));
      }
    }
    return columns;
  }

  bool identify_base() {
    std::vector<double> values = problem_.errors.parameters();
    Problem base = problem_;
    base.machine_parameters.clear();
    for (const std::size_t parameter : problem_.machine_parameters) {
      if (in_model(parameter)) {
        base.machine_parameters.push_back(parameter);
      } else {
        values[parameter] = 0;
      }
    }
    base.errors.set_parameters(values);
    problem_.errors.set_parameters(values);
    const Identification identified = identify(base, options_.identify);
    result.status = identified.status;
    if (identified.status != IdentifyStatus::converged) return false;
    problem_.errors = base.errors;
    at_ = present_values(problem_);
    for (std::size_t i = 0; i < base.machine_parameters.size(); ++i) {
      present_.push_back(
          static_cast<Index>(find_estimated(problem_, {ParameterId::kMachine, base.machine_parameters[i]})));
    }
    for (std::size_t i = problem_.machine_parameters.size(); i < estimated_count(problem_); ++i) {
      present_.push_back(static_cast<Index>(i));
    }
    return true;
  }

  void sum_blocks(const std::vector<TimeBlocks>& blocks) {
    const std::size_t count = blocks.empty() ? 0 : blocks.front().blocks;
    for (std::size_t b = 0; b < count; ++b) {
      BlockSums sums;
      sums.own = sums_of(
          problem_, at_, options_.identify, [&](std::size_t o, std::size_t k) { return blocks[o].block[k] == b; },
          &sums.residuals);
      if (sums.residuals == 0) continue;
      sums.others = sums_of(
          problem_, at_, options_.identify,
          [&](std::size_t o, std::size_t k) {
            return blocks[o].block[k] != b && (blocks[o].near.empty() || blocks[o].near[k * count + b] == 0);
          },
          nullptr);
      add_priors(problem_, at_, sums.others);
      sums_.push_back(std::move(sums));
    }
    whole_.others = sums_of(
        problem_, at_, options_.identify, [](std::size_t, std::size_t) { return true; }, &whole_.residuals);
    whole_.own = whole_.others;
    add_priors(problem_, at_, whole_.others);
  }

  double square_of(const BlockSums& sums, const std::vector<Index>& columns, const Eigen::VectorXd& step) const {
    const Eigen::VectorXd gradient = sums.own.gradient(columns);
    const Eigen::MatrixXd normal = sums.own.normal(columns, columns);
    return (2 * sums.own.cost - 2 * gradient.dot(step) + step.dot(normal * step)) / sums.residuals;
  }

  Predictor predictor_of(const BlockSums& sums) const {
    Predictor result_of_block;
    const Eigen::MatrixXd normal = sums.others.normal(present_, present_), own = sums.own.normal(present_, present_);
    const Eigen::VectorXd scale = (normal.diagonal() + own.diagonal()).unaryExpr([](double value) {
      return value > 0 ? 1 / std::sqrt(value) : 1.0;
    });
    const SymmetricEigen<> eigen(scale.asDiagonal() * normal * scale.asDiagonal());
    const Eigen::MatrixXd axes = scale.asDiagonal() * eigen.eigenvectors();
    Eigen::VectorXd inverse = Eigen::VectorXd::Zero(axes.cols());
    result_of_block.usable = true;
    for (Index i = 0; i < axes.cols(); ++i) {
      if (eigen.eigenvalues()[i] > kUndetermined) {
        inverse[i] = 1 / eigen.eigenvalues()[i];
      } else if (axes.col(i).dot(own * axes.col(i)) > kSeenByBlock) {
        result_of_block.usable = false;
      }
    }
    result_of_block.inverse = axes * inverse.asDiagonal() * axes.transpose();
    result_of_block.step = result_of_block.inverse * sums.others.gradient(present_);
    result_of_block.square = square_of(sums, present_, result_of_block.step);
    return result_of_block;
  }

  void predict() {
    predictors_.clear();
    result.blocks = 0;
    for (const BlockSums& sums : sums_) {
      predictors_.push_back(predictor_of(sums));
      result.blocks += predictors_.back().usable ? 1U : 0U;
    }
    result.left_out = sums_.size() - result.blocks;
    whole_predictor_ = predictor_of(whole_);
  }

  /// Wald's test of further columns in the fit to all readings, with the scatter from block to block that is left when
  /// they are in the model: readings of a block may be correlated. False if they are not determined.
  bool test(Trial& trial) const {
    const std::vector<Index> columns(trial.columns.begin(), trial.columns.end());
    const NormalEquations& all = whole_.others;
    const Eigen::MatrixXd taken = whole_predictor_.inverse * all.normal(present_, columns);
    const Eigen::MatrixXd information = all.normal(columns, columns) - all.normal(columns, present_) * taken;
    const Eigen::VectorXd scale =
        information.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 1.0; });
    const SymmetricEigen<> eigen(scale.asDiagonal() * information * scale.asDiagonal());
    if (!(eigen.eigenvalues()[0] > 1e3 * kUndetermined)) return false;
    const Eigen::MatrixXd axes = scale.asDiagonal() * eigen.eigenvectors();
    const Eigen::MatrixXd inverse = axes * eigen.eigenvalues().cwiseInverse().asDiagonal() * axes.transpose();
    const Eigen::VectorXd score = all.gradient(columns) - all.normal(columns, present_) * whole_predictor_.step;
    const Eigen::VectorXd more = inverse * score, rest = whole_predictor_.step - taken * more;
    trial.wald = score.dot(more);
    const double count = static_cast<double>(columns.size());
    double scatter = 0, squares = 0;
    for (const BlockSums& sums : sums_) {
      const NormalEquations& own = sums.own;
      const Eigen::VectorXd left =
          own.gradient(columns) - own.normal(columns, present_) * rest - own.normal(columns, columns) * more;
      const Eigen::VectorXd left_present =
          own.gradient(present_) - own.normal(present_, present_) * rest - own.normal(present_, columns) * more;
      const Eigen::VectorXd score_of_block = left - taken.transpose() * left_present;
      scatter += score_of_block.dot(inverse * score_of_block) / count;
      const Eigen::MatrixXd mixed = own.normal(columns, present_) * taken;
      const Eigen::MatrixXd own_information = own.normal(columns, columns) - mixed - mixed.transpose() +
                                              taken.transpose() * own.normal(present_, present_) * taken;
      const double share = inverse.cwiseProduct(own_information).sum() / count;
      squares += share * share;
    }
    const double blocks = 1 / squares;  // so many equal ones
    if (!(blocks > 1.2)) return false;
    trial.dispersion = scatter * blocks / (blocks - 1);
    return true;
  }

  double mean_square() const {
    double sum = 0;
    for (const Predictor& one : predictors_) sum += one.usable ? one.square : 0;
    return sum / static_cast<double>(std::max<std::size_t>(1, result.blocks));
  }

  /// By how much the mean squared residual of every block falls with further columns; empty if those are not
  /// determined without some block.
  std::vector<double> gains_of(const std::vector<std::size_t>& further) const {
    const std::vector<Index> columns(further.begin(), further.end());
    std::vector<Index> all = present_;
    all.insert(all.end(), columns.begin(), columns.end());
    std::vector<double> gains;
    for (std::size_t b = 0; b < sums_.size(); ++b) {
      const Predictor& now = predictors_[b];
      if (!now.usable) continue;
      const NormalEquations& others = sums_[b].others;
      // The further columns without what the present ones explain of them.
      const Eigen::MatrixXd mixed = others.normal(present_, columns), taken = now.inverse * mixed;
      const Eigen::MatrixXd whole = others.normal(columns, columns);
      const Eigen::MatrixXd left = whole - mixed.transpose() * taken;
      const Eigen::VectorXd scale = whole.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 1.0; });
      const SymmetricEigen<> eigen(scale.asDiagonal() * left * scale.asDiagonal());
      if (!(eigen.eigenvalues()[0] > 1e3 * kUndetermined)) return {};
      const Eigen::MatrixXd axes = scale.asDiagonal() * eigen.eigenvectors();
      const Eigen::VectorXd right = others.gradient(columns) - mixed.transpose() * now.step;
      const Eigen::VectorXd more = axes * eigen.eigenvalues().cwiseInverse().asDiagonal() * (axes.transpose() * right);
      Eigen::VectorXd step(now.step.size() + more.size());
      step << now.step - taken * more, more;
      gains.push_back(now.square - square_of(sums_[b], all, step));
    }
    return gains;
  }

  Problem problem_;
  const std::vector<CandidateTerm>& candidates_;
  const TermSelectionOptions& options_;
  Eigen::VectorXd at_;          // where the sums are taken
  std::vector<Index> present_;  // parameters of the model so far, among the estimates
  std::vector<BlockSums> sums_;
  std::vector<Predictor> predictors_;
  BlockSums whole_;  // all readings
  Predictor whole_predictor_;
};

}  // namespace

TermSelection select_terms(const Problem& problem, const std::vector<CandidateTerm>& candidates,
                           const std::vector<TimeBlocks>& blocks, const TermSelectionOptions& options) {
  const Eigen::VectorXd start = present_values(problem);
  TermSearch search(problem, candidates, blocks, options);
  while (search.result.done && search.take_one()) {
  }
  set_observations(problem, start);
  return search.result;
}

}  // namespace abbe
