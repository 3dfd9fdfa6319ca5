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
using planning::log_determinant;
using planning::Small;
using planning::trace_of_quotient;
using RowsMap = Eigen::Map<const PlanningCandidates::Rows, 0, Eigen::OuterStride<>>;
using ColumnsMap = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
// An eigenvalue of W_j nearer to one has no digits left below it.
constexpr double kSafelyBelowOne = 1 - 1e-6;

}  // namespace

void PlanDesign::look_ahead(std::span<const std::size_t> all) {
  ahead_.clear();
  const std::span<const std::size_t> places = all.first(std::min(all.size(), kMostAhead));
  std::array<Squares, kMostAhead> squares;
  bring_squares(places, squares);
  const Index v = static_cast<Index>(v_);
  const Eigen::OuterStride<> stride(static_cast<Index>(space_.stride()));
  std::size_t columns = 0;
  for (const std::size_t place : places) {
    const std::size_t candidate = chosen_[place], n = space_.row_count(candidate);
    const RowsMap a(space_.row(space_.first_row(candidate)), static_cast<Index>(n), v, stride);
    ColumnsMap solved(&ahead_factors_[columns * space_.stride()], v, static_cast<Index>(n), stride);
    solved.noalias() = inverse_ * a.transpose();
    ahead_.push_back({place, columns, squares[ahead_.size()]});
    columns += n;
  }
  columns = padded(columns, kColumnMultiple);
  for_own_blocks([this, columns](std::size_t block) {
    std::vector<double>& x = ahead_x_[block];
    x.assign(columns * x_stride_, 0.0);
    const std::size_t first = space_.first_row(blocks_[block]);
    const std::size_t rows = padded(space_.first_row(blocks_[block + 1]) - first, kColumnMultiple);
    add_cross_products(space_.row(first), rows, space_.stride(), ahead_factors_.data(), columns, space_.stride(),
                       space_.stride(), x.data(), x_stride_);
  });
}

bool PlanDesign::looked_ahead(std::size_t place) const {
  return std::any_of(ahead_.begin(), ahead_.end(), [place](const Ahead& one) { return one.place == place; });
}

PlanDesign::Best PlanDesign::best_instead(std::size_t place, const Allowed& rules) {
  const std::size_t before = chosen_[place];
  const Index v = static_cast<Index>(v_), n = static_cast<Index>(space_.row_count(before));
  const Eigen::OuterStride<> stride(static_cast<Index>(space_.stride()));
  const RowsMap a(space_.row(space_.first_row(before)), n, v, stride);
  ColumnsMap solved(factors_.data(), v, n, stride);
  solved.noalias() = inverse_ * a.transpose();
  std::size_t end = static_cast<std::size_t>(n);
  if (by_variance_) {
    auto weighted = scratch_.leftCols(n);
    weighted.noalias() = weight_ * solved;
    ColumnsMap behind(&factors_[end * space_.stride()], v, n, stride);
    behind.noalias() = inverse_ * weighted;
    end *= 2;
  }
  ahead_at_ = kNotAhead;
  for (const Ahead& one : ahead_) {
    if (one.place != place) continue;
    ahead_at_ = one.first;
    leaving_.squares = one.squares;
  }
  if (ahead_at_ == kNotAhead) bring_squares({&place, 1}, {&leaving_.squares, 1});
  const Eigen::Map<const Eigen::MatrixXd> w(leaving_.squares.w.data(), n, n);
  const double largest = SymmetricEigen<>(w, Eigen::EigenvaluesOnly).eigenvalues()[n - 1];
  leaving_.loss = loss_of(leaving_.squares.w.data(), leaving_.squares.g.data(), static_cast<std::size_t>(n));
  leaving_.bounded = leaving_.loss < kImpossible && largest < kSafelyBelowOne && !rules.per_cost;
  leaving_.root_loss = std::sqrt(std::max(leaving_.loss, 0.0));
  leaving_.stretch = leaving_.bounded ? 1 / (1 - largest) : 0;
  // Before any products: |W_ij|^2 <= lambda_j trace W_i.
  leaving_.size = std::max(largest, 0.0) * leaving_.stretch;
  leaving_.rows = static_cast<std::size_t>(n);
  for_own_blocks([&](std::size_t block) { best_in_block(block, before, end, rules); });
  return best_of_blocks();
}

bool PlanDesign::may_be_better(std::size_t candidate, double square, double limit) const {
  if (!leaving_.bounded) return true;
  const double gain = -gain_[candidate];
  double least = leaving_.loss;
  if (by_variance_) {
    const double sum = std::sqrt(std::max(gain, 0.0)) + std::sqrt(square) * leaving_.root_loss;
    least -= sum * sum;
  } else {
    // log det(I + S) <= n log(1 + trace(S) / n)
    const double n = static_cast<double>(std::min(leaving_.rows, space_.row_count(candidate)));
    least -= gain + n * std::log1p(square / n);
  }
  return least < limit;
}

void PlanDesign::best_in_block(std::size_t block, std::size_t before, std::size_t end, const Allowed& rules) {
  best_[block] = {};
  const std::size_t n = leaving_.rows, first = space_.first_row(blocks_[block]);
  const bool any = std::any_of(&size_[blocks_[block]], &size_[blocks_[block]] + (blocks_[block + 1] - blocks_[block]),
                               [&](const double& size) {
                                 const auto i = static_cast<std::size_t>(&size - size_.data());
                                 return allowed(i, rules) && may_be_better(i, leaving_.size * size, rules.ceiling);
                               });
  if (!any) return;
  const double* x = ahead_at_ == kNotAhead ? products(block, n) : ahead_x_[block].data() + ahead_at_ * x_stride_;
  for (std::size_t i = blocks_[block]; i < blocks_[block + 1]; ++i) {
    if (!allowed(i, rules)) continue;
    const double* own = x + (space_.first_row(i) - first);
    double square = 0;
    for (std::size_t c = 0; c < n; ++c)
      for (std::size_t r = 0; r < space_.row_count(i); ++r) square += own[r + c * x_stride_] * own[r + c * x_stride_];
    if (!may_be_better(i, square * leaving_.stretch, std::min(rules.ceiling, best_[block].change))) continue;
    if (end > n) own = products_of(block, i, end);
    keep_better(i, change_by_exchange(before, i, own), rules, best_[block]);
  }
}

const double* PlanDesign::products_of(std::size_t block, std::size_t candidate, std::size_t end) {
  // Behind the columns of the whole block.
  double* x = x_[block].data() + padded(leaving_.rows, kColumnMultiple) * x_stride_;
  const std::size_t columns = padded(end, kColumnMultiple), rows = padded(space_.row_count(candidate), kColumnMultiple);
  for (std::size_t c = 0; c < columns; ++c) std::fill(x + c * x_stride_, x + c * x_stride_ + rows, 0.0);
  add_cross_products(space_.row(space_.first_row(candidate)), rows, space_.stride(), factors_.data(), columns,
                     space_.stride(), space_.stride(), x, x_stride_);
  return x;
}

// Adding i, then taking out j: with W_ij = A_i M^-1 A_j' and K = (I + W_i)^-1 W_ij, W_j becomes W_j - W_ij' K, and
// G_j becomes G_j - K' G_ij - G_ij' K + K' G_i K.
double PlanDesign::change_by_exchange(std::size_t before, std::size_t candidate, const double* x) const {
  const std::size_t n = space_.row_count(candidate), m = space_.row_count(before);
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
      wj[i * m + j] = leaving_.squares.w[i * m + j] - product(x, i, k.data(), j, x_stride_);
      wj[j * m + i] = wj[i * m + j];
    }
  Small lower_j;
  if (!factorise(wj.data(), m, -1, lower_j)) return kImpossible;
  if (!by_variance_) return -log_determinant(lower, n) - log_determinant(lower_j, m);

  const double* gi = &g_[square_[candidate]];
  const double* mixed = x + m * x_stride_;
  Small gk;  // G_i K
  for (std::size_t c = 0; c < m; ++c)
    for (std::size_t r = 0; r < n; ++r) {
      double sum = 0;
      for (std::size_t d = 0; d < n; ++d) sum += gi[r * n + d] * k[c * n + d];
      gk[c * n + r] = sum;
    }
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      gj[i * m + j] = leaving_.squares.g[i * m + j] - product(mixed, i, k.data(), j, x_stride_) -
                      product(mixed, j, k.data(), i, x_stride_) + product(gk.data(), i, k.data(), j, n);
      gj[j * m + i] = gj[i * m + j];
    }
  return trace_of_quotient(lower_j, gj.data(), m) - trace_of_quotient(lower, gi, n);
}

}  // namespace abbe
