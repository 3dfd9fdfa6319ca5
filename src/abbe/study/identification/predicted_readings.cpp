#include "abbe/study/identification/predicted_readings.h"

#include <algorithm>
#include <cmath>

namespace abbe {

PredictedReadings predict_readings(const Observations& observations, const Identification& identification,
                                   std::size_t setup) {
  // Columns of the covariance that these observations depend on.
  std::vector<std::size_t> machine, unknowns;
  std::vector<Eigen::Index> columns;
  for (std::size_t i = 0; i < identification.parameters.size(); ++i) {
    const ParameterId& id = identification.parameters[i].id;
    if (id.is_machine()) {
      machine.push_back(id.index);
      columns.push_back(static_cast<Eigen::Index>(i));
    }
  }
  for (std::size_t i = 0; i < identification.parameters.size(); ++i) {
    const ParameterId& id = identification.parameters[i].id;
    if (!id.is_machine() && id.observations == setup) {
      unknowns.push_back(id.index);
      columns.push_back(static_cast<Eigen::Index>(i));
    }
  }
  const Eigen::Index p = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd covariance(p, p);
  for (Eigen::Index i = 0; i < p; ++i) {
    for (Eigen::Index j = 0; j < p; ++j) {
      covariance(i, j) =
          identification.covariance(columns[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(j)]);
    }
  }

  PredictedReadings prediction;
  constexpr std::size_t kBlock = Observations::kBlockSize;
  const std::size_t count = observations.reading_count();
  const std::size_t rows = static_cast<std::size_t>(observations.rows());
  std::vector<double> residuals(rows * kBlock);
  Eigen::MatrixXd jacobian;
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t n = std::min(kBlock, count - first);
    jacobian.resize(static_cast<Eigen::Index>(rows * n), p);
    observations.evaluate(first, n, machine, unknowns, residuals.data(), jacobian.data(), rows * n);
    const Eigen::MatrixXd propagated = jacobian * covariance;
    for (std::size_t k = 0; k < n; ++k) {
      double square = 0, variance = 0;
      for (std::size_t row = 0; row < rows; ++row) {
        if (observations.components()[row].is_angle) continue;
        const Eigen::Index index = static_cast<Eigen::Index>(row * n + k);
        const double r = residuals[row * n + k];
        const double v = propagated.row(index).dot(jacobian.row(index));
        square += r * r;
        variance += v;
        prediction.within += std::abs(r) <= 2 * std::sqrt(std::max(v, 0.0)) ? 1U : 0U;
        ++prediction.coordinates;
      }
      prediction.error.push_back(1e-3 * std::sqrt(square));
      prediction.uncertainty.push_back(1e-3 * std::sqrt(std::max(variance, 0.0)));
    }
  }
  return prediction;
}

}  // namespace abbe
