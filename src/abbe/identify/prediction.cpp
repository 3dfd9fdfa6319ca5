#include "abbe/identify/prediction.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

}  // namespace

Eigen::VectorXd predicted_uncertainty(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& covariance) {
  return (rows * covariance).cwiseProduct(rows).rowwise().sum().cwiseMax(0.0).cwiseSqrt();
}

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

}  // namespace abbe
