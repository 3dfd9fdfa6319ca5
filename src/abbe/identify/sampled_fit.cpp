#include "abbe/identify/sampled_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/cross_products.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr int kMostRobustSteps = 60;
constexpr double kSampleSettled = 1e-6;  // square of a step, in standard uncertainties
// Directions of outliers come from streams of their own: a changed list of outliers changes no other draw.
constexpr std::uint64_t kOutlierSeed = 0x9e3779b97f4a7c15U;

}  // namespace

SampledFit::SampledFit(const Problem& problem, const Identification& identification, const Loss& loss, int threads)
    : problem_(problem), stream_(problem, threads), loss_(loss), estimates_(identification.estimates) {
  for (const SelectedObservations& selected : problem.observations) {
    first_.push_back(rows_);
    rows_ += selected.observations->reading_count() * static_cast<std::size_t>(selected.observations->rows());
  }
  priors_ = prior_rows(problem);
  length_ = padded(rows_ + static_cast<std::size_t>(priors_.rows()), kLengthMultiple);
  directions_ = identification.space.directions.size() > 0
                    ? identification.space.directions
                    : Eigen::MatrixXd::Identity(estimates_.size(), estimates_.size());
  free_ = static_cast<std::size_t>(directions_.cols());
  columns_ = padded(free_, kColumnMultiple);
  if (loss_.kind == LossKind::none) return;
  for (const Outlier& outlier : identification.outliers) {
    Shift shift{};
    shift.rows = static_cast<std::size_t>(problem.observations[outlier.observations].observations->rows());
    shift.first = row_of(outlier.observations, outlier.reading, shift.stride);
    // What was found is the gross error and the noise together.
    const double noise = static_cast<double>(shift.rows) * loss_.scale * loss_.scale;
    shift.size = std::sqrt(std::max(outlier.norm * outlier.norm - noise, 0.0));
    shifts_.push_back(shift);
  }
}

std::size_t SampledFit::bytes() const { return sizeof(double) * length_ * (columns_ + 2 * kSampleBatch); }

std::size_t SampledFit::row_of(std::size_t observations, std::size_t reading, std::size_t& stride) const {
  const Observations& own = *problem_.observations[observations].observations;
  const std::size_t block = reading / Observations::kBlockSize * Observations::kBlockSize;
  stride = std::min(Observations::kBlockSize, own.reading_count() - block);
  return first_[observations] + block * static_cast<std::size_t>(own.rows()) + (reading - block);
}

/// work(observations, reading, first row, rows, distance between rows)
template <typename Work>
void SampledFit::for_each_reading(const Work& work) const {
  for (std::size_t o = 0; o < problem_.observations.size(); ++o) {
    const Observations& own = *problem_.observations[o].observations;
    const std::size_t rows = static_cast<std::size_t>(own.rows()), count = own.reading_count();
    for (std::size_t first = 0; first < count; first += Observations::kBlockSize) {
      const std::size_t size = std::min(Observations::kBlockSize, count - first);
      for (std::size_t k = 0; k < size; ++k) work(o, first + k, first_[o] + first * rows + k, rows, size);
    }
  }
}

bool SampledFit::prepare() {
  set_observations(problem_, estimates_);
  jacobian_.assign(length_ * columns_, 0.0);
  stream_.for_each(true, Loss{}, [&](std::size_t, const ResidualBlock& block, double) {
    const std::size_t size = block.count * static_cast<std::size_t>(block.rows);
    const std::size_t target = first_[block.observations] + block.first * static_cast<std::size_t>(block.rows);
    for (std::size_t f = 0; f < free_; ++f)
      for (std::size_t c = 0; c < block.estimates->size(); ++c) {
        const double factor = directions_(static_cast<Index>((*block.estimates)[c]), static_cast<Index>(f));
        if (factor == 0) continue;
        const double* from = block.jacobian + c * block.stride;
        double* to = jacobian_.data() + f * length_ + target;
        for (std::size_t k = 0; k < size; ++k) to[k] += factor * from[k];
      }
  });
  const Eigen::MatrixXd prior_columns = priors_ * directions_;
  for (Index f = 0; f < prior_columns.cols(); ++f)
    for (Index i = 0; i < prior_columns.rows(); ++i)
      jacobian_[static_cast<std::size_t>(f) * length_ + rows_ + static_cast<std::size_t>(i)] = prior_columns(i, f);
  residuals_.resize(length_);
  model_residuals(estimates_, residuals_.data());

  std::vector<double> products(columns_ * columns_, 0.0);
  if (loss_.kind == LossKind::none) {
    add_cross_products(jacobian_.data(), columns_, length_, jacobian_.data(), columns_, length_, length_,
                       products.data(), columns_);
  } else {
    std::vector<double> scaled = jacobian_;
    scale_rows_for_loss(scaled);
    add_cross_products(jacobian_.data(), columns_, length_, scaled.data(), columns_, length_, length_, products.data(),
                       columns_);
  }
  const Index n = static_cast<Index>(free_);
  const Eigen::MatrixXd normal =
      Eigen::Map<const Eigen::MatrixXd>(products.data(), static_cast<Index>(columns_), static_cast<Index>(columns_))
          .topLeftCorner(n, n);
  if (!normal.allFinite() || !(normal.diagonal().minCoeff() > 0)) return false;
  inverse_scale_ = normal.diagonal().cwiseSqrt().cwiseInverse();
  factor_.compute(inverse_scale_.asDiagonal() * normal * inverse_scale_.asDiagonal());
  return factor_.info() == Eigen::Success;
}

void SampledFit::add_to(Digest& digest) const {
  digest.add_numbers(jacobian_);
  digest.add_numbers(residuals_);
  digest.add_numbers({directions_.data(), static_cast<std::size_t>(directions_.size())});
  digest.add_numbers({priors_.data(), static_cast<std::size_t>(priors_.size())});
  digest.add_numbers(std::array{loss_.tuning, loss_.scale, static_cast<double>(loss_.kind)});
  for (const Shift& shift : shifts_) {
    for (const std::size_t number : {shift.first, shift.rows, shift.stride}) digest.add(number);
    digest.add_number(shift.size);
  }
  for (const SelectedObservations& selected : problem_.observations) {
    digest.add_bytes(std::as_bytes(std::span(selected.use)));
    for (std::size_t k = 0; k < selected.observations->reading_count(); ++k)
      for (const double position : selected.observations->positions(k)) digest.add_number(position);
  }
}

// Mean slope of the pseudo-residuals of every reading: with them the kept factor is that of the curvature which the
// samples have on average, and few steps settle one.
void SampledFit::scale_rows_for_loss(std::vector<double>& jacobian) const {
  std::vector<double> slope(length_, 1.0);
  std::vector<double> good;
  for (const SelectedObservations& selected : problem_.observations)
    good.push_back(loss_moments(loss_, selected.observations->rows()).slope);
  for_each_reading([&](std::size_t o, std::size_t, std::size_t first, std::size_t rows, std::size_t stride) {
    for (std::size_t r = 0; r < rows; ++r) slope[first + r * stride] = good[o];
  });
  for (const Shift& shift : shifts_) {
    const int rows = static_cast<int>(shift.rows);
    const double at_size = loss_.weight(shift.size, rows) + shift.size * loss_.weight_slope(shift.size, rows) / rows;
    for (std::size_t r = 0; r < shift.rows; ++r) slope[shift.first + r * shift.stride] = std::max(at_size, 0.0);
  }
  for (std::size_t f = 0; f < free_; ++f)
    for (std::size_t i = 0; i < length_; ++i) jacobian[f * length_ + i] *= slope[i];
}

void SampledFit::draw(std::uint64_t seed, std::size_t sample, double* errors) const {
  RandomStream random(seed, sample);
  std::fill(errors, errors + length_, 0.0);
  for (std::size_t o = 0; o < problem_.observations.size(); ++o) {
    const SelectedObservations& selected = problem_.observations[o];
    const std::size_t rows = static_cast<std::size_t>(selected.observations->rows());
    const std::size_t count = selected.observations->reading_count();
    if (selected.use.empty()) {
      for (std::size_t i = 0; i < rows * count; ++i) errors[first_[o] + i] = random.normal();
      continue;
    }
    for (std::size_t first = 0; first < count; first += Observations::kBlockSize) {
      const std::size_t size = std::min(Observations::kBlockSize, count - first);
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t k = 0; k < size; ++k)
          if (selected.use[first + k]) errors[first_[o] + first * rows + r * size + k] = random.normal();
    }
  }
  for (Index i = 0; i < priors_.rows(); ++i) errors[rows_ + static_cast<std::size_t>(i)] = random.normal();
  if (loss_.kind == LossKind::none) return;
  if (loss_.scale != 1) {
    for (std::size_t i = 0; i < rows_; ++i) errors[i] *= loss_.scale;
  }
  RandomStream turns(seed ^ kOutlierSeed, sample);
  std::vector<double> direction;
  for (const Shift& shift : shifts_) {
    direction.resize(shift.rows);
    double square = 0;
    for (double& component : direction) {
      component = turns.normal();
      square += component * component;
    }
    if (!(square > 0)) continue;
    for (std::size_t r = 0; r < shift.rows; ++r)
      errors[shift.first + r * shift.stride] += shift.size / std::sqrt(square) * direction[r];
  }
}

void SampledFit::exact(const Eigen::VectorXd& estimates, const double* errors, double* residuals) const {
  model_residuals(estimates, residuals);
  for (std::size_t i = 0; i < length_; ++i) residuals[i] += errors[i] - residuals_[i];
}

// Free variables [free, count] of the kept factor, and their squared lengths in standard uncertainties.
Eigen::MatrixXd SampledFit::step(const double* residuals, std::size_t count, Eigen::VectorXd& decrements) const {
  const std::size_t samples = padded(count, kColumnMultiple);
  std::vector<double> products(columns_ * samples, 0.0);
  add_cross_products(jacobian_.data(), columns_, length_, residuals, samples, length_, length_, products.data(),
                     columns_);
  const Eigen::MatrixXd gradient =
      Eigen::Map<const Eigen::MatrixXd>(products.data(), static_cast<Index>(columns_), static_cast<Index>(samples))
          .topLeftCorner(static_cast<Index>(free_), static_cast<Index>(count));
  Eigen::MatrixXd y = inverse_scale_.asDiagonal() * factor_.solve_columns(inverse_scale_.asDiagonal() * gradient);
  decrements = gradient.cwiseProduct(y).colwise().sum();
  return y;
}

// Multiplies the residuals of every reading by the weight of their norm; priors keep theirs.
void SampledFit::weigh(double* residuals) const {
  for_each_reading([&](std::size_t, std::size_t, std::size_t first, std::size_t rows, std::size_t stride) {
    double square = 0;
    for (std::size_t r = 0; r < rows; ++r) square += residuals[first + r * stride] * residuals[first + r * stride];
    const double weight = loss_.weight(std::sqrt(square), static_cast<int>(rows));
    for (std::size_t r = 0; r < rows; ++r) residuals[first + r * stride] *= weight;
  });
}

std::size_t SampledFit::fit(const double* residuals, std::size_t count, Eigen::Ref<Eigen::MatrixXd> y) const {
  Eigen::VectorXd decrements;
  if (loss_.kind == LossKind::none) {
    y += step(residuals, count, decrements);
    return 0;
  }
  const Index length = static_cast<Index>(length_), samples = static_cast<Index>(padded(count, kColumnMultiple));
  const Eigen::Map<const Eigen::MatrixXd> jacobian(jacobian_.data(), length, static_cast<Index>(free_));
  Eigen::MatrixXd present = Eigen::MatrixXd::Zero(length, samples), weighted = present;
  const Index used = static_cast<Index>(count);
  present.leftCols(used) = Eigen::Map<const Eigen::MatrixXd>(residuals, length, used);
  for (int i = 0; i < kMostRobustSteps; ++i) {
    weighted.leftCols(used) = present.leftCols(used);
    for (Index k = 0; k < used; ++k) weigh(weighted.col(k).data());
    const Eigen::MatrixXd change = step(weighted.data(), count, decrements);
    y += change;
    if (decrements.maxCoeff() < kSampleSettled) return 0;
    present.leftCols(used).noalias() -= jacobian * change;
  }
  return static_cast<std::size_t>((decrements.array() >= kSampleSettled).count());
}

void SampledFit::model_residuals(const Eigen::VectorXd& estimates, double* out) const {
  set_observations(problem_, estimates);
  std::fill(out + rows_, out + length_, 0.0);
  for (std::size_t o = 0; o < problem_.observations.size(); ++o) {
    const SelectedObservations& selected = problem_.observations[o];
    const std::size_t rows = static_cast<std::size_t>(selected.observations->rows());
    const std::size_t count = selected.observations->reading_count();
    for (std::size_t first = 0; first < count; first += Observations::kBlockSize) {
      const std::size_t size = std::min(Observations::kBlockSize, count - first);
      double* block = out + first_[o] + first * rows;
      selected.observations->evaluate(first, size, {}, {}, block, nullptr, rows * size);
      if (selected.use.empty()) continue;
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t k = 0; k < size; ++k)
          if (!selected.use[first + k]) block[r * size + k] = 0;
    }
  }
  const Eigen::VectorXd change = priors_ * (estimates - estimates_);
  for (Index i = 0; i < change.size(); ++i) out[rows_ + static_cast<std::size_t>(i)] = -change[i];
}

}  // namespace abbe
