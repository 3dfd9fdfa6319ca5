#include <algorithm>
#include <cmath>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/plan/readings/planning_design.h"
#include "abbe/plan/readings/planning_small.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
using planning::factorise;
using planning::kSmallestPivot;
using planning::log_determinant;
using planning::Small;
using planning::trace_of_quotient;
using RowsMap = Eigen::Map<const PlanningCandidates::Rows, 0, Eigen::OuterStride<>>;
using ColumnsMap = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
// An eigenvalue of W_j nearer to one has no digits left below it.
constexpr double kSafelyBelowOne = 1 - 1e-6;

}  // namespace

std::vector<ScoredCandidate> PlanDesign::best_instead(std::span<const std::size_t> places,
                                                      std::span<const Allowed> rules) {
  leaving_count_ = places.size();
  std::size_t column = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    leaving_.at(k).column = column;
    prepare(places[k], rules[k], leaving_[k]);
    column += leaving_[k].rows;
  }
  leaving_columns_ = padded(column, kColumnMultiple);
  for_own_blocks([&](std::size_t block) { best_in_block(block, rules); });
  return best_of_blocks(places.size());
}

void PlanDesign::prepare(std::size_t place, const Allowed& rules, Leaving& leaving) {
  const std::size_t before = chosen_[place], stride = space_.stride();
  leaving.candidate = before;
  leaving.rows = space_.row_count(before);
  leaving.least = kImpossible;
  const Index v = static_cast<Index>(v_), n = static_cast<Index>(leaving.rows);
  const Eigen::OuterStride<> outer(static_cast<Index>(stride));
  const RowsMap a(space_.row(space_.first_row(before)), n, v, outer);
  ColumnsMap solved(&solved_[leaving.column * stride], v, n, outer);
  solved.noalias() = inverse_ * a.transpose();
  auto weighted = scratch_.leftCols(n);
  if (by_variance_) {
    weighted.noalias() = weight_ * solved;
    ColumnsMap(&solved_behind_[leaving.column * stride], v, n, outer).noalias() = inverse_ * weighted;
  }
  find_squares(before, solved, weighted, leaving.squares);
  const Eigen::Map<const Eigen::MatrixXd> w(leaving.squares.w.data(), n, n);
  const double largest = SymmetricEigen<>(w, Eigen::EigenvaluesOnly).eigenvalues()[n - 1];
  leaving.loss = loss_of(leaving.squares, leaving.rows);
  leaving.bounded = leaving.loss < kImpossible && largest < kSafelyBelowOne && !rules.per_cost;
  leaving.root_loss = std::sqrt(std::max(leaving.loss, 0.0));
  leaving.stretch = leaving.bounded ? 1 / (1 - largest) : 0;
  // Before any products: |W_ij|^2 <= lambda_j trace W_i.
  leaving.size = std::max(largest, 0.0) * leaving.stretch;
}

void PlanDesign::find_squares(std::size_t candidate, Eigen::Ref<const Eigen::MatrixXd> solved,
                              Eigen::Ref<const Eigen::MatrixXd> weighted, Squares& squares) const {
  const Index v = static_cast<Index>(v_), n = static_cast<Index>(space_.row_count(candidate));
  const RowsMap a(space_.row(space_.first_row(candidate)), n, v,
                  Eigen::OuterStride<>(static_cast<Index>(space_.stride())));
  const auto fill = [n](const auto& value, Small& to) {
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j <= i; ++j)
        to[static_cast<std::size_t>(i * n + j)] = to[static_cast<std::size_t>(j * n + i)] = value(i, j);
  };
  fill([&](Index i, Index j) { return a.row(i).dot(solved.col(j)); }, squares.w);
  if (by_variance_) fill([&](Index i, Index j) { return solved.col(i).dot(weighted.col(j)); }, squares.g);
}

double PlanDesign::loss_of(const Squares& squares, std::size_t n) const {
  Small lower;
  if (!factorise(squares.w.data(), n, -1, lower)) return kImpossible;
  return by_variance_ ? trace_of_quotient(lower, squares.g.data(), n) : -log_determinant(lower, n);
}

std::vector<double> PlanDesign::losses() const {
  std::vector<double> result;
  Squares squares;
  Eigen::MatrixXd solved, weighted;
  for (const std::size_t candidate : chosen_) {
    const RowsMap a(space_.row(space_.first_row(candidate)), static_cast<Index>(space_.row_count(candidate)),
                    static_cast<Index>(v_), Eigen::OuterStride<>(static_cast<Index>(space_.stride())));
    solved.noalias() = inverse_ * a.transpose();
    if (by_variance_) weighted.noalias() = weight_ * solved;
    find_squares(candidate, solved, weighted, squares);
    result.push_back(loss_of(squares, space_.row_count(candidate)));
  }
  return result;
}

bool PlanDesign::may_be_better(std::size_t candidate, const Leaving& leaving, double square, double limit) const {
  if (!leaving.bounded) return true;
  const double gain = -gain_[candidate];
  double least = leaving.loss;
  if (by_variance_) {
    const double sum = std::sqrt(std::max(gain, 0.0)) + std::sqrt(square) * leaving.root_loss;
    least -= sum * sum;
  } else {
    // log det(I + S) <= n log(1 + trace(S) / n)
    const double n = static_cast<double>(std::min(leaving.rows, space_.row_count(candidate)));
    least -= gain + n * std::log1p(square / n);
  }
  return least < limit;
}

double PlanDesign::limit_of(const Leaving& leaving, const Allowed& rules) const {
  if (rules.per_cost) return rules.ceiling;
  // Twice the tie, because bounds are rounded.
  return std::min(rules.ceiling, leaving.least.load(std::memory_order_relaxed) + 2 * tie());
}

void PlanDesign::best_in_block(std::size_t block, std::span<const Allowed> rules) {
  const double* x = nullptr;
  for (std::size_t k = 0; k < leaving_count_; ++k) {
    Leaving& leaving = leaving_[k];
    PossibleBests& best = best_[block * kMostPlaces + k];
    best.clear();
    const double limit = limit_of(leaving, rules[k]);
    bool any = false;
    for (std::size_t i = blocks_[block]; !any && i < blocks_[block + 1]; ++i)
      any = may_be_better(i, leaving, leaving.size * size_[i], limit) && allowed(i, rules[k]);
    if (!any) continue;
    if (x == nullptr) x = products(block, solved_.data(), leaving_columns_);
    best_in_block(block, x + leaving.column * x_stride_, leaving, rules[k], best);
  }
}

void PlanDesign::best_in_block(std::size_t block, const double* x, Leaving& leaving, const Allowed& rules,
                               PossibleBests& best) {
  const std::size_t first = space_.first_row(blocks_[block]);
  for (std::size_t i = blocks_[block]; i < blocks_[block + 1]; ++i) {
    if (!allowed(i, rules)) continue;
    const double* own = x + (space_.first_row(i) - first);
    double square = 0;
    for (std::size_t c = 0; c < leaving.rows; ++c)
      for (std::size_t r = 0; r < space_.row_count(i); ++r) square += own[r + c * x_stride_] * own[r + c * x_stride_];
    const double limit = limit_of(leaving, rules);
    if (!may_be_better(i, leaving, square * leaving.stretch, limit)) continue;
    const double change = change_by_exchange(leaving, i, own, limit);
    if (!(change < rules.ceiling)) continue;
    best.add(scored(i, change, rules));
    for (double known = leaving.least; change < known && !leaving.least.compare_exchange_weak(known, change);) {
    }
  }
}

const double* PlanDesign::mixed_products(std::size_t candidate, const Leaving& leaving) const {
  constexpr std::size_t kFew = 8;  // fewer are computed one by one, without padding to multiples of four
  const std::size_t rows = space_.row_count(candidate), stride = space_.stride();
  const double* const a = space_.row(space_.first_row(candidate));
  const double* const b = &solved_behind_[leaving.column * stride];
  double* x = product_memory() + leaving_columns_ * x_stride_;
  if (rows * leaving.rows < kFew) {
    const auto length = static_cast<Index>(stride);
    for (std::size_t c = 0; c < leaving.rows; ++c)
      for (std::size_t r = 0; r < rows; ++r)
        x[r + c * x_stride_] = Eigen::Map<const Eigen::VectorXd>(a + r * stride, length)
                                   .dot(Eigen::Map<const Eigen::VectorXd>(b + c * stride, length));
    return x;
  }
  const std::size_t all_rows = padded(rows, kColumnMultiple), columns = padded(leaving.rows, kColumnMultiple);
  for (std::size_t c = 0; c < columns; ++c) std::fill_n(x + c * x_stride_, all_rows, 0.0);
  add_cross_products(a, all_rows, stride, b, columns, stride, stride, x, x_stride_);
  return x;
}

// The same as change_by_exchange(), for candidates of one row.
double PlanDesign::change_by_exchange_of_one(const Leaving& leaving, std::size_t candidate, double x,
                                             double limit) const {
  const double wi = w_[square_[candidate]], sum_i = 1 + wi;
  if (!(sum_i > kSmallestPivot)) return kImpossible;
  const double k = x / sum_i, sum_j = 1 - (leaving.squares.w[0] - x * k);
  if (!(sum_j > kSmallestPivot)) return kImpossible;
  if (!by_variance_) return -std::log(sum_i * sum_j);
  const double gi = g_[square_[candidate]], gj = leaving.squares.g[0];
  const double apart = std::sqrt(std::max(gj, 0.0)) - std::abs(k) * std::sqrt(std::max(gi, 0.0));
  if (!(apart * apart / sum_j - gi / sum_i < limit)) return kImpossible;
  return (gj - 2 * *mixed_products(candidate, leaving) * k + k * gi * k) / sum_j - gi / sum_i;
}

// Adding i, then taking out j: with W_ij = A_i M^-1 A_j' and K = (I + W_i)^-1 W_ij, W_j becomes W_j - W_ij' K, and
// G_j becomes G_j - K' G_ij - G_ij' K + K' G_i K. With Q = I - W_j and the new W_j, tr(Q^-1 G_j) of the new G_j
// is at least (a - b)^2 by the triangle inequality, where a^2 = tr(Q^-1 G_j) of the old G_j and b^2 = tr(Q^-1 K' G_i
// K).
double PlanDesign::change_by_exchange(const Leaving& leaving, std::size_t candidate, const double* x,
                                      double limit) const {
  const std::size_t n = space_.row_count(candidate), m = leaving.rows;
  if (n == 1 && m == 1) return change_by_exchange_of_one(leaving, candidate, *x, limit);
  const double* wi = &w_[square_[candidate]];
  Small lower, k, wj, gj;
  if (!factorise(wi, n, 1, lower)) return kImpossible;
  for (std::size_t c = 0; c < m; ++c) {
    double* column = k.data() + c * n;
    for (std::size_t r = 0; r < n; ++r) {
      double sum = x[r + c * x_stride_];
      for (std::size_t d = 0; d < r; ++d) sum -= lower[r * n + d] * column[d];
      column[r] = sum / lower[r * n + r];
    }
    for (std::size_t r = n; r-- > 0;) {
      double sum = column[r];
      for (std::size_t d = r + 1; d < n; ++d) sum -= lower[d * n + r] * column[d];
      column[r] = sum / lower[r * n + r];
    }
  }
  const auto product = [&](const double* a, std::size_t i, const double* b, std::size_t j, std::size_t a_stride) {
    double sum = 0;
    for (std::size_t r = 0; r < n; ++r) sum += a[i * a_stride + r] * b[j * n + r];
    return sum;
  };
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      wj[i * m + j] = leaving.squares.w[i * m + j] - product(x, i, k.data(), j, x_stride_);
      wj[j * m + i] = wj[i * m + j];
    }
  Small lower_j;
  if (!factorise(wj.data(), m, -1, lower_j)) return kImpossible;
  if (!by_variance_) return -log_determinant(lower, n) - log_determinant(lower_j, m);

  const double* gi = &g_[square_[candidate]];
  Small gk, kgk;  // G_i K, K' G_i K
  for (std::size_t c = 0; c < m; ++c)
    for (std::size_t r = 0; r < n; ++r) {
      double sum = 0;
      for (std::size_t d = 0; d < n; ++d) sum += gi[r * n + d] * k[c * n + d];
      gk[c * n + r] = sum;
    }
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j <= i; ++j) kgk[i * m + j] = kgk[j * m + i] = product(gk.data(), i, k.data(), j, n);
  const auto root = [&](const double* g) { return std::sqrt(std::max(trace_of_quotient(lower_j, g, m), 0.0)); };
  const double gain = trace_of_quotient(lower, gi, n);
  const double apart = root(leaving.squares.g.data()) - root(kgk.data());
  if (!(apart * apart - gain < limit)) return kImpossible;

  const double* mixed = mixed_products(candidate, leaving);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      gj[i * m + j] = leaving.squares.g[i * m + j] - product(mixed, i, k.data(), j, x_stride_) -
                      product(mixed, j, k.data(), i, x_stride_) + kgk[i * m + j];
      gj[j * m + i] = gj[i * m + j];
    }
  return trace_of_quotient(lower_j, gj.data(), m) - gain;
}

}  // namespace abbe
