#include "abbe/identify/normal_equations.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/stopped.h"
#include "abbe/identify/sums/factored_sums.h"
#include "abbe/identify/sums/pose_sums.h"
#include "abbe/identify/sums/reading_fingerprints.h"
#include "abbe/identify/sums/sum_check.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

struct Buffer {
  std::vector<double> values;
  double* aligned = nullptr;
};

/// Weights of the readings of a block, and what it costs.
struct BlockWeights {
  double root[Observations::kBlockSize];  ///< of the weight; 0: left out
  double cost = 0;
  bool weighted = false;  ///< a root is not 1

  /// @param use  null: all
  BlockWeights(const double* residuals, std::size_t rows, std::size_t count, const std::uint8_t* use,
               const Loss& loss) {
    for (std::size_t k = 0; k < count; ++k) {
      double square = 0;
      for (std::size_t r = 0; r < rows; ++r) square += residuals[r * count + k] * residuals[r * count + k];
      root[k] = 1;
      if (use && !use[k]) {
        root[k] = 0;
        weighted = true;
      } else if (loss.kind == LossKind::none) {
        cost += square / 2;
      } else {
        const double norm = std::sqrt(square);
        root[k] = std::sqrt(loss.weight(norm, static_cast<int>(rows)));
        cost += loss.cost(norm, static_cast<int>(rows));
        weighted = true;
      }
    }
  }

  void weigh(double* column, std::size_t rows, std::size_t count) const {
    if (!weighted) return;
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t k = 0; k < count; ++k) {
        double& value = column[r * count + k];
        // Set, not multiplied: what is left out may be no number at all.
        value = root[k] > 0 ? value * root[k] : (root[k] == 0 ? 0.0 : root[k]);
      }
  }
  /// Sets what is left out to zero.
  void leave_out(double* values, std::size_t count) const {
    if (!weighted) return;
    for (std::size_t k = 0; k < count; ++k)
      if (root[k] == 0) values[k] = 0;
  }
};

/// Takes more rows into a factor, which has no more rows than columns.
void append_to_factor(Eigen::MatrixXd& factor, const Eigen::MatrixXd& rows) {
  const Index p = factor.cols();
  Eigen::MatrixXd stacked(factor.rows() + rows.rows(), p);
  stacked << factor, rows;
  if (stacked.rows() <= p) {
    factor = std::move(stacked);
    return;
  }
  factor = Qr(stacked).upper(p);
}

}  // namespace

struct ReadingStream::Implementation {
  using Work = std::function<void(std::size_t piece, const ResidualBlock& block, double cost)>;

  const Problem& problem;
  int threads;
  Summation summation;
  std::stop_token stop;
  std::size_t parameters = 0;
  std::vector<ReadingPiece> pieces;
  std::vector<std::vector<std::size_t>> columns_of;     // per observations: where its columns stand among the estimates
  std::vector<std::unique_ptr<FactoredSums>> factored;  // per observations: null where whole columns are quicker
  std::size_t buffer_size = 0;
  std::mutex mutex;
  std::vector<std::unique_ptr<Buffer>> idle;
  ReadingPoint reference;                   // only with a summation
  std::vector<std::uint64_t> fingerprints;  // [pieces] there

  Implementation(const Problem& p, int t, Summation s, std::stop_token k)
      : problem(p), threads(t), summation(std::move(s)), stop(std::move(k)) {}

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

  void run_piece(std::size_t index, bool jacobian, const Loss& loss, const Work& work) {
    const ReadingPiece& piece = pieces[index];
    const SelectedObservations& selected = problem.observations[piece.observations];
    const std::vector<std::size_t>& columns = columns_of[piece.observations];
    const std::size_t rows = static_cast<std::size_t>(selected.observations->rows());
    const std::size_t residual_column = padded(columns.size(), kColumnMultiple);
    std::unique_ptr<Buffer> buffer = take();
    double* values = buffer->aligned;
    for (std::size_t first = piece.first; first < piece.last; first += Observations::kBlockSize) {
      const std::size_t count = std::min(Observations::kBlockSize, piece.last - first);
      const std::uint8_t* use = selected.use.empty() ? nullptr : selected.use.data() + first;
      if (use && std::all_of(use, use + count, [](std::uint8_t used) { return used == 0; })) continue;
      const std::size_t length = rows * count;
      const std::size_t stride = padded(length, kLengthMultiple);
      double* residuals = values + residual_column * stride;
      selected.observations->evaluate(first, count, problem.machine_parameters, selected.unknowns, residuals,
                                      jacobian ? values : nullptr, stride);
      const BlockWeights weights(residuals, rows, count, use, loss);
      const std::size_t used_columns = jacobian ? columns.size() : 0;
      weights.weigh(residuals, rows, count);
      for (std::size_t c = 0; c < used_columns; ++c) weights.weigh(values + c * stride, rows, count);
      const auto clear_tail = [&](double* column) { std::fill(column + length, column + stride, 0.0); };
      clear_tail(residuals);
      for (std::size_t c = 0; c < used_columns; ++c) clear_tail(values + c * stride);
      if (jacobian) std::fill(values + columns.size() * stride, residuals, 0.0);
      std::fill(residuals + stride, residuals + kColumnMultiple * stride, 0.0);
      work(index,
           {piece.observations, first, count, static_cast<int>(rows), jacobian ? values : nullptr, residuals, stride,
            &columns},
           weights.cost);
    }
    give_back(std::move(buffer));
  }

  /// Cost, gradient and normal equations of one piece.
  std::vector<double> products_of_piece(std::size_t index, SumKind kind, const Loss& loss) {
    if (kind != SumKind::cost && factored[pieces[index].observations]) return factored_products(index, kind, loss);
    const std::size_t c = columns_of[pieces[index].observations].size();
    const std::size_t residual_column = padded(c, kColumnMultiple), size = residual_column + kColumnMultiple;
    double total = 0;
    std::vector<double> products;
    run_piece(index, kind != SumKind::cost, loss, [&](std::size_t, const ResidualBlock& block, double cost) {
      total += cost;
      if (kind == SumKind::cost) return;
      if (products.empty()) products.assign(size * (kind == SumKind::normal ? size : kColumnMultiple), 0.0);
      if (kind == SumKind::normal)
        add_self_products(block.jacobian, size, block.stride, block.stride, products.data(), size);
      else
        add_cross_products(block.jacobian, residual_column, block.stride, block.residuals, kColumnMultiple,
                           block.stride, block.stride, products.data(), size);
    });
    std::vector<double> values = {total};
    if (products.empty()) return values;
    values.reserve(1 + c + (kind == SumKind::normal ? c * (c + 1) / 2 : 0));
    for (std::size_t i = 0; i < c; ++i)
      values.push_back(kind == SumKind::normal ? products[residual_column + i * size] : products[i]);
    if (kind == SumKind::normal)
      for (std::size_t i = 0; i < c; ++i)
        values.insert(values.end(), products.data() + i + i * size, products.data() + c + i * size);
    return values;
  }

  /// The same from the factors of the columns.
  std::vector<double> factored_products(std::size_t index, SumKind kind, const Loss& loss) {
    constexpr std::size_t kBlock = FactoredSums::kStride;
    const ReadingPiece& piece = pieces[index];
    const SelectedObservations& selected = problem.observations[piece.observations];
    const FactoredSums& sums = *factored[piece.observations];
    const FactoredColumns& form = sums.form();
    const std::size_t rows = static_cast<std::size_t>(selected.observations->rows());
    const bool normal = kind == SumKind::normal;
    std::unique_ptr<Buffer> buffer = take();
    double* const bases = buffer->aligned;
    double* const scratch = bases + (form.bases() + 1) * kBlock;
    double* const carriers = scratch + sums.scratch_size();
    std::vector<double> products, values = {0.0};
    for (std::size_t first = piece.first; first < piece.last; first += Observations::kBlockSize) {
      const std::size_t count = std::min(Observations::kBlockSize, piece.last - first);
      const std::uint8_t* use = selected.use.empty() ? nullptr : selected.use.data() + first;
      if (use && std::all_of(use, use + count, [](std::uint8_t used) { return used == 0; })) continue;
      const std::size_t stride = padded(rows * count, kLengthMultiple);
      double* const residuals = carriers + form.carriers() * stride;
      selected.observations->evaluate_factored(first, count, problem.machine_parameters, selected.unknowns, residuals,
                                               {form, carriers, stride, bases, kBlock});
      const BlockWeights weights(residuals, rows, count, use, loss);
      values[0] += weights.cost;
      std::fill_n(bases + form.bases() * kBlock, count, 1.0);
      for (std::size_t c = 0; c <= form.carriers(); ++c) weights.weigh(carriers + c * stride, rows, count);
      for (std::size_t b = 0; b <= form.bases(); ++b) {
        weights.leave_out(bases + b * kBlock, count);
        std::fill(bases + b * kBlock + count, bases + (b + 1) * kBlock, 0.0);
      }
      if (products.empty()) products.assign(sums.sums_size(normal), 0.0);
      sums.add(normal, carriers, stride, bases, count, scratch, products.data());
    }
    give_back(std::move(buffer));
    if (!products.empty()) sums.append(normal, products, values);
    return values;
  }

  std::vector<double> norms_of_piece(std::size_t index) {
    const ReadingPiece& piece = pieces[index];
    const std::vector<std::uint8_t>& use = problem.observations[piece.observations].use;
    std::vector<double> norms(piece.last - piece.first, -1.0);
    run_piece(index, false, Loss{}, [&](std::size_t, const ResidualBlock& block, double) {
      for (std::size_t k = 0; k < block.count; ++k) {
        if (!use.empty() && !use[block.first + k]) continue;
        double square = 0;
        for (std::size_t r = 0; r < static_cast<std::size_t>(block.rows); ++r) {
          const double residual = block.residuals[r * block.count + k];
          square += residual * residual;
        }
        norms[block.first - piece.first + k] = std::sqrt(square);
      }
    });
    return norms;
  }

  std::vector<double> factor_of_piece(std::size_t index, const Loss& loss) {
    const Index p = static_cast<Index>(parameters);
    Eigen::MatrixXd factor(0, p);
    run_piece(index, true, loss, [&](std::size_t, const ResidualBlock& block, double) {
      const Index length = static_cast<Index>(block.count) * block.rows;
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(length, p);
      for (std::size_t c = 0; c < block.estimates->size(); ++c)
        rows.col(static_cast<Index>((*block.estimates)[c])) =
            Eigen::Map<const Eigen::VectorXd>(block.jacobian + c * block.stride, length);
      append_to_factor(factor, rows);
    });
    return {factor.data(), factor.data() + factor.size()};
  }

  std::unique_ptr<FactoredSums> factors_of(const SelectedObservations& selected) const {
    std::optional<FactoredColumns> form =
        selected.observations->column_factors(problem.machine_parameters, selected.unknowns);
    if (!form) return nullptr;
    auto sums =
        std::make_unique<FactoredSums>(*std::move(form), static_cast<std::size_t>(selected.observations->rows()));
    return sums->is_quicker() ? std::move(sums) : nullptr;
  }

  void take_fingerprints_of_readings() {
    const Problem stated = as_stated(problem);
    std::vector<std::vector<double>> setups;
    for (const SelectedObservations& selected : stated.observations)
      setups.push_back(selected.observations->unknown_values());
    reference = reference_point(stated);
    if (summation.fingerprints()) {
      fingerprints = summation.fingerprints()(reference, stop);
      return;
    }
    set_observations(stated, reference);
    fingerprints.resize(pieces.size());
    take_fingerprints(stated, pieces, {0, pieces.size()}, threads, fingerprints);
    set_observations(problem, ReadingPoint{problem.errors.parameters(), setups});
  }

  /// Pieces of readings, or for sums over poses pieces of these.
  std::vector<ReadingPiece> pieces_for(SumKind kind) const {
    return kind == SumKind::poses ? divide_poses(weighed_observations(problem)) : pieces;
  }

  std::function<std::vector<double>(std::size_t index)> sum_of_poses(const std::vector<double>& covariance) const {
    const Index p = static_cast<Index>(parameters);
    const Eigen::Map<const Eigen::MatrixXd> whole(covariance.data(), p, p);
    std::vector<Eigen::MatrixXd> parts;  // per observations
    for (const std::vector<std::size_t>& own : columns_of) {
      const std::vector<Index> at(own.begin(), own.end());
      parts.emplace_back(whole(at, at));
    }
    const Problem stated = as_stated(problem);
    const std::vector<const WeighedObservations*> weighed = weighed_observations(problem);
    return [parts, stated, weighed, all = divide_poses(weighed)](std::size_t index) {
      const std::size_t o = all[index].observations;
      return sum_poses(stated.observations[o], stated.machine_parameters, weighed[o]->poses(), all[index], parts[o],
                       weighed[o]->weights().variance);
    };
  }

  SumRequest request(const ReadingPoint& point, SumKind kind, const Loss& loss,
                     const std::vector<double>& covariance) const {
    SumRequest result;
    result.kind = kind;
    result.pieces = pieces_for(kind).size();
    result.covariance = covariance;
    result.loss = loss;
    result.point = point;
    result.machine_parameters = problem.machine_parameters;
    result.reference = reference;
    for (const SelectedObservations& selected : problem.observations) {
      SetupSelection setup{selected.unknowns, selected.use, false, {}};
      const auto weighed = std::dynamic_pointer_cast<const WeighedObservations>(selected.observations);
      if (weighed) {
        // Even with the variances as stated: these are summed as whole columns, where others may use factors.
        setup.weighed = true;
        setup.weights = weighed->weights();
        const bool counts = kind == SumKind::poses || setup.weights.variance.pose > 0;
        if (counts && !setup.weights.is_known)
          throw SumError("the point at which the weights of " + weighed->name() + " were taken is not known");
        if (!counts) setup.weights = {setup.weights.variance, false, {}, {}};
      }
      result.setups.push_back(std::move(setup));
    }
    return result;
  }
};

ReadingStream::ReadingStream(const Problem& problem, int threads, Summation summation, std::stop_token stop)
    : implementation_(std::make_unique<Implementation>(problem, threads, std::move(summation), std::move(stop))) {
  Implementation& self = *implementation_;
  self.parameters = estimated_count(problem);
  self.pieces = divide_readings(problem);
  std::size_t next = problem.machine_parameters.size();
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    const SelectedObservations& selected = problem.observations[o];
    std::vector<std::size_t> columns;
    for (std::size_t i = 0; i < problem.machine_parameters.size(); ++i) columns.push_back(i);
    for (std::size_t i = 0; i < selected.unknowns.size(); ++i) columns.push_back(next++);
    const std::size_t length =
        padded(Observations::kBlockSize * static_cast<std::size_t>(selected.observations->rows()), kLengthMultiple);
    self.buffer_size = std::max(self.buffer_size, length * (padded(columns.size(), kColumnMultiple) + kColumnMultiple));
    self.columns_of.push_back(std::move(columns));
    self.factored.push_back(self.factors_of(selected));
    if (!self.factored.back()) continue;
    const FactoredSums& sums = *self.factored.back();
    self.buffer_size = std::max(self.buffer_size, (sums.form().carriers() + 2) * length + sums.scratch_size() +
                                                      (sums.form().bases() + 1) * FactoredSums::kStride);
  }
  if (self.summation) self.take_fingerprints_of_readings();
}

ReadingStream::~ReadingStream() = default;
std::size_t ReadingStream::piece_count() const { return implementation_->pieces.size(); }
const std::vector<std::size_t>& ReadingStream::columns_of(std::size_t observations) const {
  return implementation_->columns_of[observations];
}
std::size_t ReadingStream::parameter_count() const { return implementation_->parameters; }
std::size_t ReadingStream::residual_count() const { return used_residual_count(implementation_->problem); }

void ReadingStream::for_each(bool jacobian, const Loss& loss,
                             const std::function<void(std::size_t, const ResidualBlock&, double)>& work) const {
  Implementation& self = *implementation_;
  for_each_block(self.pieces.size(), self.threads,
                 [&](std::size_t index) { self.run_piece(index, jacobian, loss, work); });
}

std::vector<std::vector<double>> ReadingStream::sum_pieces(SumKind kind, const Loss& loss,
                                                           const std::vector<double>& covariance, PieceRange range,
                                                           const SumOptions& options) const {
  Implementation& self = *implementation_;
  std::function<std::vector<double>(std::size_t)> poses;
  if (kind == SumKind::poses) poses = self.sum_of_poses(covariance);
  std::vector<std::vector<double>> values(range.count());
  std::mutex progress;
  std::size_t done = 0;
  for_each_block(range.count(), options.threads, [&](std::size_t i) {
    stop_if_asked(options.stop);
    const std::size_t index = range.first + i;
    if (kind == SumKind::poses)
      values[i] = poses(index);
    else if (kind == SumKind::norms)
      values[i] = self.norms_of_piece(index);
    else if (kind == SumKind::factor)
      values[i] = self.factor_of_piece(index, loss);
    else
      values[i] = self.products_of_piece(index, kind, loss);
    if (!options.progress) return;
    const std::lock_guard lock(progress);
    options.progress(++done, range.count());
  });
  return values;
}

std::vector<std::vector<double>> ReadingStream::all_pieces(const Eigen::VectorXd& estimates, SumKind kind,
                                                           const Loss& loss,
                                                           const std::vector<double>& covariance) const {
  Implementation& self = *implementation_;
  const ReadingPoint point = reading_point(self.problem, estimates);
  if (!self.summation) {
    set_observations(self.problem, point);
    return sum_pieces(kind, loss, covariance, {0, self.pieces_for(kind).size()}, {self.threads, self.stop, {}});
  }
  stop_if_asked(self.stop);
  const SumRequest request = self.request(point, kind, loss, covariance);
  const std::vector<ReadingPiece> pieces = self.pieces_for(kind);
  const std::vector<std::uint64_t> readings =
      kind == SumKind::poses ? fingerprints_of_poses(pieces, self.pieces, self.fingerprints) : self.fingerprints;
  const Summation::Here here = [&](PieceRange range) {
    set_observations(self.problem, point);
    SumOfReadings own = begin_sum(request);
    own.range = range;
    own.readings.assign(readings.begin() + static_cast<std::ptrdiff_t>(range.first),
                        readings.begin() + static_cast<std::ptrdiff_t>(range.last));
    own.values = sum_pieces(kind, loss, covariance, range, {self.threads, self.stop, {}});
    return own;
  };
  SumOfReadings sum = self.summation(request, here, self.stop);
  check_sum(sum, request, self.problem, pieces, readings);
  set_observations(self.problem, point);
  return std::move(sum.values);
}

std::vector<std::vector<double>> ReadingStream::pose_sums(const Eigen::VectorXd& estimates,
                                                          const Eigen::MatrixXd& covariance) const {
  return all_pieces(estimates, SumKind::poses, Loss{}, {covariance.data(), covariance.data() + covariance.size()});
}

NormalEquations ReadingStream::sums(const Eigen::VectorXd& estimates, const Loss& loss, Wanted wanted) const {
  Implementation& self = *implementation_;
  const SumKind kind = wanted == Wanted::cost       ? SumKind::cost
                       : wanted == Wanted::gradient ? SumKind::gradient
                                                    : SumKind::normal;
  const std::vector<std::vector<double>> values = all_pieces(estimates, kind, loss, {});
  NormalEquations result;
  const Index p = static_cast<Index>(self.parameters);
  if (wanted != Wanted::cost) result.gradient = Eigen::VectorXd::Zero(p);
  if (wanted == Wanted::normal) result.normal = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t piece = 0; piece < values.size(); ++piece) {
    const double* value = values[piece].data();
    result.cost += *value++;
    if (values[piece].size() == 1) continue;  // no reading is used
    const std::vector<std::size_t>& columns = self.columns_of[self.pieces[piece].observations];
    for (const std::size_t column : columns) result.gradient[static_cast<Index>(column)] += *value++;
    if (wanted != Wanted::normal) continue;
    for (std::size_t i = 0; i < columns.size(); ++i)
      for (std::size_t j = i; j < columns.size(); ++j)
        result.normal(static_cast<Index>(columns[j]), static_cast<Index>(columns[i])) += *value++;
  }
  if (wanted == Wanted::normal) result.normal.triangularView<Eigen::StrictlyUpper>() = result.normal.transpose();
  add_priors(self.problem, estimates, result);
  result.finite = std::isfinite(result.cost) && result.gradient.allFinite() && result.normal.allFinite();
  return result;
}

std::vector<std::vector<double>> ReadingStream::norms(const Eigen::VectorXd& estimates) const {
  const std::vector<ReadingPiece>& pieces = implementation_->pieces;
  const std::vector<std::vector<double>> values = all_pieces(estimates, SumKind::norms, Loss{}, {});
  std::vector<std::vector<double>> result(implementation_->problem.observations.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::vector<double>& own = result[pieces[i].observations];
    own.insert(own.end(), values[i].begin(), values[i].end());
  }
  return result;
}

Eigen::MatrixXd ReadingStream::orthogonal_factor(const Eigen::VectorXd& estimates, const Loss& loss) const {
  const Index p = static_cast<Index>(implementation_->parameters);
  Eigen::MatrixXd result(0, p);
  for (const std::vector<double>& piece : all_pieces(estimates, SumKind::factor, loss, {}))
    if (!piece.empty())
      append_to_factor(result,
                       Eigen::Map<const Eigen::MatrixXd>(piece.data(), static_cast<Index>(piece.size()) / p, p));
  const Eigen::MatrixXd priors = prior_rows(implementation_->problem);
  if (priors.rows() > 0) append_to_factor(result, priors);
  if (result.rows() < p) {
    Eigen::MatrixXd square = Eigen::MatrixXd::Zero(p, p);
    square.topRows(result.rows()) = result;
    return square;
  }
  return result;
}

}  // namespace abbe
