#include "abbe/identify/normal_equations.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
// More pieces than this cost more memory and reduction than they gain in balance.
constexpr std::size_t kMostPieces = 48;

struct Piece {
  std::size_t observations = 0;
  std::size_t first = 0;  // reading
  std::size_t last = 0;   // one past the last reading
};

struct Buffer {
  std::vector<double> values;
  double* aligned = nullptr;
};

}  // namespace

struct ReadingStream::Implementation {
  const Problem& problem;
  int threads;
  std::size_t parameters = 0;
  std::vector<Piece> pieces;
  std::vector<std::vector<std::size_t>> columns;  // per observations: where its columns stand among the estimates
  std::size_t buffer_size = 0;
  std::mutex mutex;
  std::vector<std::unique_ptr<Buffer>> idle;

  Implementation(const Problem& p, int t) : problem(p), threads(t) {}

  std::unique_ptr<Buffer> take() {
    {
      const std::lock_guard lock(mutex);
      if (!idle.empty()) {
        std::unique_ptr<Buffer> buffer = std::move(idle.back());
        idle.pop_back();
        return buffer;
      }
    }
    auto buffer = std::make_unique<Buffer>();
    buffer->values.assign(buffer_size + kLengthMultiple, 0.0);
    const auto address = reinterpret_cast<std::uintptr_t>(buffer->values.data());
    buffer->aligned = buffer->values.data() + (64 - address % 64) % 64 / sizeof(double);
    return buffer;
  }

  void give_back(std::unique_ptr<Buffer> buffer) {
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(buffer));
  }
};

ReadingStream::ReadingStream(const Problem& problem, int threads)
    : implementation_(std::make_unique<Implementation>(problem, threads)) {
  Implementation& self = *implementation_;
  self.parameters = estimated_count(problem);
  std::size_t blocks = 0;
  for (const SelectedObservations& selected : problem.observations)
    blocks += (selected.observations->reading_count() + Observations::kBlockSize - 1) / Observations::kBlockSize;
  const std::size_t readings_per_piece =
      Observations::kBlockSize * std::max<std::size_t>(1, (blocks + kMostPieces - 1) / kMostPieces);
  std::size_t next = problem.machine_parameters.size();
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    const SelectedObservations& selected = problem.observations[o];
    const std::size_t count = selected.observations->reading_count();
    for (std::size_t first = 0; first < count; first += readings_per_piece)
      self.pieces.push_back({o, first, std::min(count, first + readings_per_piece)});
    std::vector<std::size_t> columns;
    for (std::size_t i = 0; i < problem.machine_parameters.size(); ++i) columns.push_back(i);
    for (std::size_t i = 0; i < selected.unknowns.size(); ++i) columns.push_back(next++);
    const std::size_t length =
        padded(Observations::kBlockSize * static_cast<std::size_t>(selected.observations->rows()), kLengthMultiple);
    self.buffer_size = std::max(self.buffer_size, length * (padded(columns.size(), kColumnMultiple) + kColumnMultiple));
    self.columns.push_back(std::move(columns));
  }
}

ReadingStream::~ReadingStream() = default;
std::size_t ReadingStream::piece_count() const { return implementation_->pieces.size(); }
std::size_t ReadingStream::parameter_count() const { return implementation_->parameters; }
std::size_t ReadingStream::residual_count() const { return used_residual_count(implementation_->problem); }

void ReadingStream::for_each(bool jacobian, const Loss& loss,
                             const std::function<void(std::size_t, const ResidualBlock&, double)>& work) const {
  Implementation& self = *implementation_;
  const auto run_piece = [&](std::size_t index) {
    const Piece& piece = self.pieces[index];
    const SelectedObservations& selected = self.problem.observations[piece.observations];
    const std::vector<std::size_t>& columns = self.columns[piece.observations];
    const std::size_t rows = static_cast<std::size_t>(selected.observations->rows());
    const std::size_t residual_column = padded(columns.size(), kColumnMultiple);
    std::unique_ptr<Buffer> buffer = self.take();
    double* values = buffer->aligned;
    std::vector<double> weight_root(Observations::kBlockSize);
    for (std::size_t first = piece.first; first < piece.last; first += Observations::kBlockSize) {
      const std::size_t count = std::min(Observations::kBlockSize, piece.last - first);
      const std::uint8_t* use = selected.use.empty() ? nullptr : selected.use.data() + first;
      if (use && std::all_of(use, use + count, [](std::uint8_t used) { return used == 0; })) continue;
      const std::size_t length = rows * count;
      const std::size_t stride = padded(length, kLengthMultiple);
      double* residuals = values + residual_column * stride;
      selected.observations->evaluate(first, count, self.problem.machine_parameters, selected.unknowns, residuals,
                                      jacobian ? values : nullptr, stride);
      double cost = 0;
      bool weighted = false;
      for (std::size_t k = 0; k < count; ++k) {
        double square = 0;
        for (std::size_t r = 0; r < rows; ++r) square += residuals[r * count + k] * residuals[r * count + k];
        weight_root[k] = 1;
        if (use && !use[k]) {
          weight_root[k] = 0;
          weighted = true;
        } else if (loss.kind == LossKind::none) {
          cost += square / 2;
        } else {
          const double norm = std::sqrt(square);
          weight_root[k] = std::sqrt(loss.weight(norm, static_cast<int>(rows)));
          cost += loss.cost(norm, static_cast<int>(rows));
          weighted = true;
        }
      }
      const std::size_t used_columns = jacobian ? columns.size() : 0;
      const auto weigh = [&](double* column) {
        for (std::size_t r = 0; r < rows; ++r)
          for (std::size_t k = 0; k < count; ++k) {
            double& value = column[r * count + k];
            // Set, not multiplied: what is left out may be no number at all.
            value = weight_root[k] > 0 ? value * weight_root[k] : (weight_root[k] == 0 ? 0.0 : weight_root[k]);
          }
      };
      if (weighted) {
        weigh(residuals);
        for (std::size_t c = 0; c < used_columns; ++c) weigh(values + c * stride);
      }
      const auto clear_tail = [&](double* column) { std::fill(column + length, column + stride, 0.0); };
      clear_tail(residuals);
      for (std::size_t c = 0; c < used_columns; ++c) clear_tail(values + c * stride);
      if (jacobian) std::fill(values + columns.size() * stride, residuals, 0.0);
      std::fill(residuals + stride, residuals + kColumnMultiple * stride, 0.0);
      work(index,
           {piece.observations, first, count, static_cast<int>(rows), jacobian ? values : nullptr, residuals, stride,
            &columns},
           cost);
    }
    self.give_back(std::move(buffer));
  };
  for_each_block(self.pieces.size(), self.threads, run_piece);
}

NormalEquations ReadingStream::sums(const Eigen::VectorXd& estimates, const Loss& loss, Wanted wanted) const {
  Implementation& self = *implementation_;
  set_observations(self.problem, estimates);
  struct Partial {
    std::vector<double> products;
    double cost = 0;
  };
  std::vector<Partial> partial(self.pieces.size());
  for_each(wanted != Wanted::cost, loss, [&](std::size_t piece, const ResidualBlock& block, double cost) {
    Partial& mine = partial[piece];
    mine.cost += cost;
    if (wanted == Wanted::cost) return;
    const std::size_t columns = padded(block.estimates->size(), kColumnMultiple);
    const std::size_t size = columns + kColumnMultiple;
    if (mine.products.empty()) mine.products.assign(size * (wanted == Wanted::normal ? size : kColumnMultiple), 0.0);
    if (wanted == Wanted::normal)
      add_self_products(block.jacobian, size, block.stride, block.stride, mine.products.data(), size);
    else
      add_cross_products(block.jacobian, columns, block.stride, block.residuals, kColumnMultiple, block.stride,
                         block.stride, mine.products.data(), size);
  });

  NormalEquations result;
  const Index p = static_cast<Index>(self.parameters);
  if (wanted != Wanted::cost) result.gradient = Eigen::VectorXd::Zero(p);
  if (wanted == Wanted::normal) result.normal = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t piece = 0; piece < partial.size(); ++piece) {
    const Partial& one = partial[piece];
    result.cost += one.cost;
    if (one.products.empty()) continue;
    const std::vector<std::size_t>& columns = self.columns[self.pieces[piece].observations];
    const std::size_t residual_column = padded(columns.size(), kColumnMultiple);
    const std::size_t size = residual_column + kColumnMultiple;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const Index ii = static_cast<Index>(columns[i]);
      result.gradient[ii] += wanted == Wanted::normal ? one.products[residual_column + i * size] : one.products[i];
      if (wanted == Wanted::normal)
        for (std::size_t j = i; j < columns.size(); ++j)
          result.normal(static_cast<Index>(columns[j]), ii) += one.products[j + i * size];
    }
  }
  if (wanted == Wanted::normal) result.normal.triangularView<Eigen::StrictlyUpper>() = result.normal.transpose();
  add_priors(self.problem, estimates, result);
  result.finite = std::isfinite(result.cost) && result.gradient.allFinite() && result.normal.allFinite();
  return result;
}

std::vector<std::vector<double>> ReadingStream::norms(const Eigen::VectorXd& estimates) const {
  const Problem& problem = implementation_->problem;
  set_observations(problem, estimates);
  std::vector<std::vector<double>> result;
  for (const SelectedObservations& selected : problem.observations)
    result.emplace_back(selected.observations->reading_count(), -1.0);
  for_each(false, Loss{}, [&](std::size_t, const ResidualBlock& block, double) {
    const std::vector<std::uint8_t>& use = problem.observations[block.observations].use;
    for (std::size_t k = 0; k < block.count; ++k) {
      if (!use.empty() && !use[block.first + k]) continue;
      double square = 0;
      for (std::size_t r = 0; r < static_cast<std::size_t>(block.rows); ++r) {
        const double residual = block.residuals[r * block.count + k];
        square += residual * residual;
      }
      result[block.observations][block.first + k] = std::sqrt(square);
    }
  });
  return result;
}

Eigen::MatrixXd ReadingStream::orthogonal_factor(const Eigen::VectorXd& estimates, const Loss& loss) const {
  Implementation& self = *implementation_;
  set_observations(self.problem, estimates);
  const Index p = static_cast<Index>(self.parameters);
  std::vector<Eigen::MatrixXd> factors(self.pieces.size());
  const auto append = [p](Eigen::MatrixXd& factor, const Eigen::MatrixXd& rows) {
    Eigen::MatrixXd stacked(factor.rows() + rows.rows(), p);
    stacked << factor, rows;
    if (stacked.rows() <= p) {
      factor = std::move(stacked);
      return;
    }
    factor = Qr(stacked).upper(p);
  };
  for_each(true, loss, [&](std::size_t piece, const ResidualBlock& block, double) {
    if (factors[piece].cols() == 0) factors[piece].resize(0, p);
    const Index length = static_cast<Index>(block.count) * block.rows;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(length, p);
    for (std::size_t c = 0; c < block.estimates->size(); ++c)
      rows.col(static_cast<Index>((*block.estimates)[c])) =
          Eigen::Map<const Eigen::VectorXd>(block.jacobian + c * block.stride, length);
    append(factors[piece], rows);
  });
  Eigen::MatrixXd result(0, p);
  for (const Eigen::MatrixXd& factor : factors)
    if (factor.rows() > 0) append(result, factor);
  const Eigen::MatrixXd priors = prior_rows(self.problem);
  if (priors.rows() > 0) append(result, priors);
  if (result.rows() < p) {
    Eigen::MatrixXd square = Eigen::MatrixXd::Zero(p, p);
    square.topRows(result.rows()) = result;
    return square;
  }
  return result;
}

}  // namespace abbe
