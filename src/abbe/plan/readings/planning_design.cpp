#include "abbe/plan/readings/planning_design.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/plan/readings/padded_columns.h"
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
constexpr std::size_t kBlockRows = 192;

// Below this much work in one pass a second thread, or another process, costs more than it brings.
constexpr double kWorthDividing = 2e5;

}  // namespace

PlanDesign::PlanDesign(const PlanningSpace& space, const Eigen::MatrixXd& functionals, int threads,
                       const WorkInStep& in_step, std::uint64_t fingerprint)
    : space_(space),
      threads_(threads),
      by_variance_(functionals.rows() > 0),
      v_(space.dimension()),
      leaving_(kMostPlaces) {
  const std::size_t n = space.count();
  if (by_variance_) weight_ = functionals.transpose() * functionals;
  times_.assign(n, 0);
  square_.assign(n + 1, 0);
  blocks_.push_back(0);
  std::size_t most = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t rows = space.row_count(i);
    most = std::max(most, rows);
    square_[i + 1] = square_[i] + rows * rows;
    if (space.first_row(i) + rows - space.first_row(blocks_.back()) > kBlockRows) blocks_.push_back(i);
  }
  if (blocks_.back() != n) blocks_.push_back(n);
  w_.assign(square_[n], 0);
  if (by_variance_) g_.assign(square_[n], 0);
  gain_.assign(n, 0);
  size_.assign(n, 0);
  const std::size_t columns = padded(2 * most * (by_variance_ ? 2 : 1), kColumnMultiple);
  factors_.assign(columns * space.stride(), 0);
  scratch_.resize(static_cast<Index>(v_), static_cast<Index>(most));
  const std::size_t together = padded(kMostPlaces * most, kColumnMultiple) + kColumnMultiple;
  solved_.assign(together * space.stride(), 0);
  if (by_variance_) solved_behind_.assign(solved_.size(), 0);
  pending_.reserve(2);
  x_stride_ = padded(kBlockRows + most, kColumnMultiple);
  product_memory_size_ = (std::max(columns, together) + padded(most, kColumnMultiple)) * x_stride_;
  best_.resize(block_count() * kMostPlaces);
  if (static_cast<double>(space.first_row(n)) * static_cast<double>(v_) < kWorthDividing) {
    threads_ = 1;
    shares_ = shares_.of(block_count());
  } else {
    shares_ = PlanShares(in_step, fingerprint, block_count());
  }
}

bool PlanDesign::rebuild(const std::vector<std::size_t>& chosen, double ridge) {
  std::vector<std::size_t> kept = chosen;  // may be our own list
  chosen_.swap(kept);
  std::fill(times_.begin(), times_.end(), std::size_t{0});
  cost_ = 0;
  Eigen::MatrixXd information = space_.known_information();
  information.diagonal().array() += ridge;
  for (const std::size_t candidate : chosen_) {
    ++times_[candidate];
    cost_ += space_.cost(candidate);
    const RowsMap rows(space_.row(space_.first_row(candidate)), static_cast<Index>(space_.row_count(candidate)),
                       static_cast<Index>(v_), Eigen::OuterStride<>(static_cast<Index>(space_.stride())));
    information.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  const Cholesky factor(information);
  updates_ = 0;
  if (factor.info() != Eigen::Success) return false;
  const Eigen::VectorXd diagonal = factor.diagonal();
  if (v_ > 0 && !(diagonal.minCoeff() > std::max(1e-7, space_.determined()) * diagonal.maxCoeff())) return false;
  inverse_ = factor.solve_columns(Eigen::MatrixXd::Identity(static_cast<Index>(v_), static_cast<Index>(v_)));
  inverse_ = (0.5 * (inverse_ + inverse_.transpose())).eval();
  objective_ = by_variance_ ? weight_.cwiseProduct(inverse_).sum() : -2 * diagonal.array().log().sum();
  refresh_all();
  return true;
}

void PlanDesign::refresh_all() {
  const std::size_t stride = space_.stride();
  const PaddedColumns inverse(inverse_), weight(weight_);
  for_own_blocks([&](std::size_t block) {
    const std::size_t first = space_.first_row(blocks_[block]);
    const std::size_t rows = padded(space_.first_row(blocks_[block + 1]) - first, kColumnMultiple);
    // A M^-1 and A M^-1 C, row by row.
    thread_local std::vector<double> z, zc;
    const auto multiply = [&](const double* a, const PaddedColumns& by, std::vector<double>& product) {
      product.assign(rows * stride, 0.0);
      add_cross_products(by.numbers.data(), by.count, stride, a, rows, stride, stride, product.data(), stride);
    };
    multiply(space_.row(first), inverse, z);
    if (by_variance_) multiply(z.data(), weight, zc);
    const Eigen::OuterStride<> outer(static_cast<Index>(stride));
    for (std::size_t i = blocks_[block]; i < blocks_[block + 1]; ++i) {
      const Index n = static_cast<Index>(space_.row_count(i)), v = static_cast<Index>(v_);
      const std::size_t at = (space_.first_row(i) - first) * stride;
      const RowsMap a(space_.row(space_.first_row(i)), n, v, outer), zi(z.data() + at, n, v, outer);
      Eigen::Map<Eigen::MatrixXd>(w_.data() + square_[i], n, n) = zi.lazyProduct(a.transpose());
      if (by_variance_)
        Eigen::Map<Eigen::MatrixXd>(g_.data() + square_[i], n, n) =
            RowsMap(zc.data() + at, n, v, outer).lazyProduct(zi.transpose());
      measure(i);
    }
  });
}

// Columns T and, for variances, M^-1 C T behind them. Nothing of the design changes before commit(1).
bool PlanDesign::make_update(std::size_t candidate, double sign) {
  const Index v = static_cast<Index>(v_), n = static_cast<Index>(space_.row_count(candidate));
  const std::size_t rows = static_cast<std::size_t>(n), stride = space_.stride();
  const RowsMap a(space_.row(space_.first_row(candidate)), n, v, Eigen::OuterStride<>(static_cast<Index>(stride)));
  auto solved = scratch_.leftCols(n);
  solved.noalias() = inverse_ * a.transpose();
  Small w, lower;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) w[static_cast<std::size_t>(i * n + j)] = a.row(i).dot(solved.col(j));
  if (!factorise(w.data(), rows, sign, lower)) return false;

  Update update;
  update.rows = rows;
  update.sign = sign;
  update.first = pending_.empty() ? 0 : pending_.back().end;
  update.end = update.first + rows * (by_variance_ ? 2 : 1);
  ColumnsMap t(&factors_[update.first * stride], v, n, Eigen::OuterStride<>(static_cast<Index>(stride)));
  for (Index c = 0; c < n; ++c) {
    t.col(c) = solved.col(c);
    for (Index k = 0; k < c; ++k) t.col(c) -= lower[static_cast<std::size_t>(c * n + k)] * t.col(k);
    t.col(c) /= lower[static_cast<std::size_t>(c * n + c)];
  }
  if (by_variance_) {
    auto weighted = scratch_.leftCols(n);
    weighted.noalias() = weight_ * t;
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t j = 0; j < rows; ++j)
        update.middle[i * rows + j] = t.col(static_cast<Index>(i)).dot(weighted.col(static_cast<Index>(j)));
      update.change -= sign * update.middle[i * rows + i];
    }
    ColumnsMap behind(&factors_[(update.first + rows) * stride], v, n,
                      Eigen::OuterStride<>(static_cast<Index>(stride)));
    behind.noalias() = inverse_ * weighted;
  } else {
    update.change = -log_determinant(lower, rows);
  }
  pending_.push_back(update);
  return true;
}

void PlanDesign::commit(double direction) {
  const Update& update = pending_.back();
  ColumnsMap t(&factors_[update.first * space_.stride()], static_cast<Index>(v_), static_cast<Index>(update.rows),
               Eigen::OuterStride<>(static_cast<Index>(space_.stride())));
  inverse_.noalias() -= direction * update.sign * t * t.transpose();
  objective_ += direction * update.change;
  ++updates_;
}

double* PlanDesign::product_memory() const {
  thread_local std::vector<double> numbers;
  if (numbers.size() < product_memory_size_) numbers.resize(product_memory_size_);
  return numbers.data();
}

double* PlanDesign::products(std::size_t block, const double* factors, std::size_t columns) const {
  double* x = product_memory();
  const std::size_t first = space_.first_row(blocks_[block]);
  const std::size_t rows = padded(space_.first_row(blocks_[block + 1]) - first, kColumnMultiple);
  std::fill(x, x + columns * x_stride_, 0.0);
  add_cross_products(space_.row(first), rows, space_.stride(), factors, columns, space_.stride(), space_.stride(), x,
                     x_stride_);
  return x;
}

// One candidate's W and G after an update; x: its first row in the products.
void PlanDesign::change_squares(const Update& update, const double* x, std::size_t n, double* w, double* g) const {
  const double* xs = x + update.first * x_stride_;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0;
      for (std::size_t c = 0; c < update.rows; ++c) sum += xs[i + c * x_stride_] * xs[j + c * x_stride_];
      w[i * n + j] -= update.sign * sum;
      w[j * n + i] = w[i * n + j];
    }
  if (!by_variance_) return;
  const double* ys = xs + update.rows * x_stride_;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double mixed = 0, square = 0;
      for (std::size_t c = 0; c < update.rows; ++c) {
        mixed += xs[i + c * x_stride_] * ys[j + c * x_stride_] + ys[i + c * x_stride_] * xs[j + c * x_stride_];
        double inner = 0;
        for (std::size_t d = 0; d < update.rows; ++d)
          inner += update.middle[c * update.rows + d] * xs[j + d * x_stride_];
        square += xs[i + c * x_stride_] * inner;
      }
      g[i * n + j] += square - update.sign * mixed;
      g[j * n + i] = g[i * n + j];
    }
}

void PlanDesign::pass() {
  for_own_blocks([this](std::size_t block) {
    const double* x = products(block, factors_.data(), padded(pending_.back().end, kColumnMultiple));
    const std::size_t first = space_.first_row(blocks_[block]);
    for (std::size_t i = blocks_[block]; i < blocks_[block + 1]; ++i) {
      for (const Update& update : pending_)
        change_squares(update, x + (space_.first_row(i) - first), space_.row_count(i), &w_[square_[i]],
                       by_variance_ ? &g_[square_[i]] : nullptr);
      measure(i);
    }
  });
  pending_.clear();
}

void PlanDesign::add(std::size_t candidate) {
  make_update(candidate, 1);
  commit(1);
  pass();
  chosen_.push_back(candidate);
  ++times_[candidate];
  cost_ += space_.cost(candidate);
}

bool PlanDesign::remove(std::size_t place) {
  const std::size_t candidate = chosen_[place];
  if (!make_update(candidate, -1)) return false;
  commit(1);
  pass();
  chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(place));
  --times_[candidate];
  cost_ -= space_.cost(candidate);
  return true;
}

bool PlanDesign::exchange(std::size_t place, std::size_t candidate) {
  const std::size_t before = chosen_[place];
  // Adding first: a choice without a reading to spare determines nothing once one is taken out.
  make_update(candidate, 1);
  commit(1);
  if (!make_update(before, -1)) {
    commit(-1);
    pending_.clear();
    return false;
  }
  commit(1);
  pass();
  chosen_[place] = candidate;
  --times_[before];
  ++times_[candidate];
  cost_ += space_.cost(candidate) - space_.cost(before);
  return true;
}

double PlanDesign::change_by_adding(const double* w, const double* g, std::size_t n) const {
  if (n == 1) {
    const double sum = 1 + *w;
    if (!(sum > kSmallestPivot)) return kImpossible;
    return by_variance_ ? -*g / sum : -std::log(sum);
  }
  Small lower;
  if (!factorise(w, n, 1, lower)) return kImpossible;
  return by_variance_ ? -trace_of_quotient(lower, g, n) : -log_determinant(lower, n);
}

double PlanDesign::gain(std::size_t candidate) const { return gain_[candidate]; }

void PlanDesign::measure(std::size_t candidate) {
  const std::size_t n = space_.row_count(candidate);
  const double* w = &w_[square_[candidate]];
  gain_[candidate] = change_by_adding(w, by_variance_ ? &g_[square_[candidate]] : nullptr, n);
  double trace = 0;
  for (std::size_t k = 0; k < n; ++k) trace += w[k * n + k];
  size_[candidate] = trace;
}

bool PlanDesign::allowed(std::size_t candidate, const Allowed& rules) const {
  return (!rules.eligible || rules.eligible->empty() || (*rules.eligible)[candidate] != 0) &&
         (!rules.group || rules.full[(*rules.group)[candidate]] == 0) && times_[candidate] < rules.repeats &&
         space_.cost(candidate) <= rules.most_cost;
}

ScoredCandidate PlanDesign::scored(std::size_t candidate, double change, const Allowed& rules) const {
  const double unit = rules.per_cost ? space_.cost(candidate) : 1.0;
  return {candidate, change, change / unit, tie() / unit};
}

ScoredCandidate PlanDesign::best_to_add(const Allowed& rules) {
  for_own_blocks([this, &rules](std::size_t block) {
    PossibleBests& best = best_[block * kMostPlaces];
    best.clear();
    for (std::size_t i = blocks_[block]; i < blocks_[block + 1]; ++i)
      if (allowed(i, rules)) best.add(scored(i, gain(i), rules));
  });
  return best_of_blocks(1).front();
}

std::vector<ScoredCandidate> PlanDesign::best_of_blocks(std::size_t places) const {
  std::vector<PossibleBests> lists(places);
  for (std::size_t k = 0; k < shares_.own_count(); ++k)
    for (std::size_t place = 0; place < places; ++place)
      lists[place].append(best_[shares_.own(k) * kMostPlaces + place]);
  if (shares_.any()) lists = lists_of(shares_.merged(bytes_of(lists), merge_possible_bests));
  std::vector<ScoredCandidate> best;
  for (const PossibleBests& list : lists) best.push_back(list.best());
  return best;
}

}  // namespace abbe
