#include "abbe/identify/trust/prediction.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

constexpr double kCoverageFactor = 2;
constexpr double kBeyondCoverage = 0.0455;  // of normal values: outside two standard deviations

}  // namespace

Eigen::MatrixXd machine_covariance(const Identification& identification, std::size_t machine_parameter_count) {
  const Index n = static_cast<Index>(machine_parameter_count);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  if (identification.covariance.size() == 0) return result;
  const std::vector<EstimatedParameter>& parameters = identification.parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    for (std::size_t j = 0; j < parameters.size(); ++j)
      if (parameters[i].id.is_machine() && parameters[j].id.is_machine())
        result(static_cast<Index>(parameters[i].id.index), static_cast<Index>(parameters[j].id.index)) =
            identification.covariance(static_cast<Index>(i), static_cast<Index>(j));
  return result;
}

std::vector<HeldOutReading> held_out_readings(const Problem& problem, const Identification& identification,
                                              int threads) {
  Problem held_out = problem;
  for (SelectedObservations& selected : held_out.observations) {
    if (selected.use.empty()) selected.use.assign(selected.observations->reading_count(), 1);
    for (std::uint8_t& used : selected.use) used = used ? 0 : 1;
  }
  set_observations(held_out, identification.estimates);
  const ReadingStream stream(held_out, threads);
  std::vector<std::vector<HeldOutReading>> pieces(stream.piece_count());
  const Index p = identification.estimates.size();
  stream.for_each(true, Loss{}, [&](std::size_t piece, const ResidualBlock& block, double) {
    const Index rows = block.rows;
    Eigen::MatrixXd jacobian(rows, p);
    Eigen::VectorXd residual(rows);
    for (std::size_t k = 0; k < block.count; ++k) {
      if (!held_out.observations[block.observations].use[block.first + k]) continue;
      jacobian.setZero();
      for (Index r = 0; r < rows; ++r) {
        const std::size_t at = static_cast<std::size_t>(r) * block.count + k;
        residual[r] = block.residuals[at];
        for (std::size_t c = 0; c < block.estimates->size(); ++c)
          jacobian(r, static_cast<Index>((*block.estimates)[c])) = block.jacobian[c * block.stride + at];
      }
      HeldOutReading reading;
      reading.observations = block.observations;
      reading.reading = block.first + k;
      reading.norm = residual.norm();
      Eigen::MatrixXd spread = jacobian * identification.covariance * jacobian.transpose();
      reading.prediction_ratio = std::sqrt(std::max(0.0, spread.diagonal().maxCoeff()));
      spread.diagonal().array() += 1;
      reading.normalised_square = residual.dot(Cholesky(spread).solve(residual));
      pieces[piece].push_back(reading);
    }
  });
  std::vector<HeldOutReading> result;
  for (const std::vector<HeldOutReading>& piece : pieces) result.insert(result.end(), piece.begin(), piece.end());
  return result;
}

void ReadingCoverage::add(const ReadingCoverage& more) {
  components += more.components;
  components_within += more.components_within;
  readings += more.readings;
  readings_within += more.readings_within;
}

ReadingCoverage reading_coverage(const Observations& observations, const Identification& identification,
                                 std::size_t setup, const ReadingVariance& variance) {
  std::vector<std::size_t> machine, unknowns;
  std::vector<Index> columns;
  // The order of the estimates: machine parameters, then unknowns.
  for (std::size_t i = 0; i < identification.parameters.size(); ++i) {
    const ParameterId& id = identification.parameters[i].id;
    if (!id.is_machine() && id.observations != setup) continue;
    (id.is_machine() ? machine : unknowns).push_back(id.index);
    columns.push_back(static_cast<Index>(i));
  }
  const Eigen::MatrixXd covariance = identification.covariance(columns, columns);
  const Index rows = observations.rows(), p = covariance.rows();
  const double limit = chi_square_quantile(kBeyondCoverage, static_cast<double>(rows));
  ReadingCoverage result;
  Eigen::VectorXd residual(rows);
  Eigen::MatrixXd jacobian(rows, p), displacement(rows, 3);
  for (std::size_t k = 0; k < observations.reading_count(); ++k) {
    observations.evaluate(k, 1, machine, unknowns, residual.data(), jacobian.data(), static_cast<std::size_t>(rows));
    Eigen::MatrixXd spread = jacobian * covariance * jacobian.transpose();
    spread.diagonal().array() += variance.factor;
    if (variance.pose > 0 && observations.displacement_rows(k, 1, displacement.data()))
      spread += variance.pose * displacement * displacement.transpose();
    for (Index row = 0; row < rows; ++row) {
      ++result.components;
      result.components_within += std::abs(residual[row]) <= kCoverageFactor * std::sqrt(spread(row, row)) ? 1U : 0U;
    }
    ++result.readings;
    result.readings_within += residual.dot(Cholesky(spread).solve(residual)) <= limit ? 1U : 0U;
  }
  return result;
}

}  // namespace abbe
