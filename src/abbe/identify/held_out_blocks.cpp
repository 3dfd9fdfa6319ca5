#include "abbe/identify/held_out_blocks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr double kUndetermined = 1e-11;  // eigenvalue of the scaled normal matrix: below is rounding
constexpr double kSeenByBlock = 1e-7;    // share of a block's information along a direction that the others leave open

NormalEquations sums_over(Problem problem, const Eigen::VectorXd& at, const IdentifyOptions& options,
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

}  // namespace

HeldOutBlocks::HeldOutBlocks(const Problem& problem, const std::vector<TimeBlocks>& blocks,
                             const IdentifyOptions& options)
    : at_(present_values(problem)) {
  const std::size_t count = blocks.empty() ? 0 : blocks.front().blocks;
  for (std::size_t b = 0; b < count; ++b) {
    BlockSums sums;
    sums.number = b;
    sums.own = sums_over(
        problem, at_, options, [&](std::size_t o, std::size_t k) { return blocks[o].block[k] == b; }, &sums.residuals);
    if (sums.residuals == 0) continue;
    sums.others = sums_over(
        problem, at_, options,
        [&](std::size_t o, std::size_t k) {
          return blocks[o].block[k] != b && (blocks[o].near.empty() || blocks[o].near[k * count + b] == 0);
        },
        nullptr);
    add_priors(problem, at_, sums.others);
    sums_.push_back(std::move(sums));
  }
  whole_.others = sums_over(
      problem, at_, options, [](std::size_t, std::size_t) { return true; }, &whole_.residuals);
  whole_.own = whole_.others;
  add_priors(problem, at_, whole_.others);
}

void HeldOutBlocks::set_present(Columns present) {
  present_ = std::move(present);
  predictors_.clear();
  for (const BlockSums& sums : sums_) predictors_.push_back(predictor_of(sums));
  whole_predictor_ = predictor_of(whole_);
}

std::size_t HeldOutBlocks::predicted() const {
  return static_cast<std::size_t>(
      std::count_if(predictors_.begin(), predictors_.end(), [](const Predictor& one) { return one.usable; }));
}

double HeldOutBlocks::mean_square() const {
  double sum = 0;
  for (const Predictor& one : predictors_) sum += one.usable ? one.square : 0;
  return sum / static_cast<double>(std::max<std::size_t>(1, predicted()));
}

std::vector<double> HeldOutBlocks::squares() const {
  std::vector<double> result;
  for (const Predictor& one : predictors_) {
    result.push_back(one.usable ? one.square : std::numeric_limits<double>::quiet_NaN());
  }
  return result;
}

Eigen::VectorXd HeldOutBlocks::estimates_without(std::size_t block) const {
  Eigen::VectorXd estimates = at_;
  estimates(present_) += predictors_.at(block).step;
  return estimates;
}

double HeldOutBlocks::square_of(const BlockSums& sums, const Columns& columns, const Eigen::VectorXd& step) const {
  const Eigen::VectorXd gradient = sums.own.gradient(columns);
  const Eigen::MatrixXd normal = sums.own.normal(columns, columns);
  return (2 * sums.own.cost - 2 * gradient.dot(step) + step.dot(normal * step)) / sums.residuals;
}

HeldOutBlocks::Predictor HeldOutBlocks::predictor_of(const BlockSums& sums) const {
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

std::optional<TermTest> HeldOutBlocks::test(const Columns& columns) const {
  const NormalEquations& all = whole_.others;
  const Eigen::MatrixXd taken = whole_predictor_.inverse * all.normal(present_, columns);
  const Eigen::MatrixXd information = all.normal(columns, columns) - all.normal(columns, present_) * taken;
  const Eigen::VectorXd scale =
      information.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 1.0; });
  const SymmetricEigen<> eigen(scale.asDiagonal() * information * scale.asDiagonal());
  if (!(eigen.eigenvalues()[0] > 1e3 * kUndetermined)) return std::nullopt;
  const Eigen::MatrixXd axes = scale.asDiagonal() * eigen.eigenvectors();
  const Eigen::MatrixXd inverse = axes * eigen.eigenvalues().cwiseInverse().asDiagonal() * axes.transpose();
  const Eigen::VectorXd score = all.gradient(columns) - all.normal(columns, present_) * whole_predictor_.step;
  const Eigen::VectorXd more = inverse * score, rest = whole_predictor_.step - taken * more;
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
  if (!(blocks > 1.2)) return std::nullopt;
  return TermTest{score.dot(more), scatter * blocks / (blocks - 1)};
}

std::vector<double> HeldOutBlocks::gains_of(const Columns& columns) const {
  Columns all = present_;
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

}  // namespace abbe
