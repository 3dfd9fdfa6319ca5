#pragma once

#include <Eigen/Core>
#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/function_observations_test.h"

namespace abbe::test {

/// Points (x, y, z) read at poses whose readings do not stand next to each other: reading k belongs to pose k % poses.
/// Every reading sees a displacement of its pose from a direction of its own.
class PoseObservations : public FunctionObservations {
 public:
  static constexpr double kUncertainty = 0.02;

  PoseObservations(std::size_t poses, std::vector<double> data)
      : FunctionObservations(5, 3, std::move(data), kUncertainty, modelled), poses_(poses) {
    start({0.5, -0.4, 0.2, 0.9, 0});
  }
  std::vector<double> positions(std::size_t reading) const override { return {static_cast<double>(reading % poses_)}; }
  bool displacement_rows(std::size_t first, std::size_t count, double* rows_out) const override {
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t c = 0; c < 3; ++c)
          rows_out[(c * 3 + row) * count + k] =
              seen_from(first + k)(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c)) / kUncertainty;
    return true;
  }

  static Eigen::Matrix3d seen_from(std::size_t reading) {
    const double a = 0.3 * static_cast<double>(reading), c = std::cos(a), s = std::sin(a);
    Eigen::Matrix3d view;
    view << c, s, 0, -s, c, 0, 0, 0.2 * s, 1;
    return view;
  }
  static Complex modelled(std::size_t k, std::size_t row, const std::vector<Complex>& b) {
    const double t = static_cast<double>(k % 97) / 40;
    if (row == 0) return b[0] + b[1] * t;
    if (row == 1) return b[2] * t * t + b[4] * std::cos(3 * t);
    return b[3] * std::exp(-t) + b[0] * t;
  }
  /// @param factor  variance factor of the readings
  /// @param noise   standard deviation of the displacement, mm
  static std::vector<double> simulate(std::uint64_t seed, std::size_t poses, std::size_t per_pose, double factor,
                                      double noise) {
    RandomStream random(seed);
    std::vector<Eigen::Vector3d> displaced(poses);
    for (Eigen::Vector3d& one : displaced)
      for (double& value : one) value = noise * random.normal();
    const std::vector<Complex> truth = {1, -0.5, 0.3, 0.8, 0.1};
    std::vector<double> data;
    for (std::size_t k = 0; k < poses * per_pose; ++k) {
      const Eigen::Vector3d common = seen_from(k) * displaced[k % poses];
      for (std::size_t row = 0; row < 3; ++row)
        data.push_back(modelled(k, row, truth).real() + common[static_cast<Eigen::Index>(row)] +
                       std::sqrt(factor) * kUncertainty * random.normal());
    }
    return data;
  }

 private:
  std::size_t poses_;
};

/// Everything of a small problem as matrices: J and Z weighted as stated, residuals at the present point.
struct DenseReadings {
  Eigen::MatrixXd jacobian, displacement;  ///< [residuals, p], [residuals, 3 poses]; only used readings
  Eigen::VectorXd residuals;

  DenseReadings(const Observations& observations, const std::vector<std::uint8_t>& use, std::size_t poses) {
    using Index = Eigen::Index;
    const std::size_t p = observations.unknowns().size(), rows = static_cast<std::size_t>(observations.rows());
    std::vector<std::size_t> columns, used;
    for (std::size_t i = 0; i < p; ++i) columns.push_back(i);
    for (std::size_t k = 0; k < observations.reading_count(); ++k)
      if (use.empty() || use[k] != 0) used.push_back(k);
    jacobian.resize(static_cast<Index>(rows * used.size()), static_cast<Index>(p));
    residuals.resize(jacobian.rows());
    displacement = Eigen::MatrixXd::Zero(jacobian.rows(), static_cast<Index>(3 * poses));
    for (std::size_t i = 0; i < used.size(); ++i) {
      Eigen::VectorXd residual(static_cast<Index>(rows));
      Eigen::MatrixXd block(static_cast<Index>(rows), static_cast<Index>(p)), z(static_cast<Index>(rows), 3);
      observations.evaluate(used[i], 1, {}, columns, residual.data(), block.data(), rows);
      const Index at = static_cast<Index>(rows * i);
      jacobian.middleRows(at, block.rows()) = block;
      residuals.segment(at, block.rows()) = residual;
      if (!observations.displacement_rows(used[i], 1, z.data())) continue;
      const auto pose = static_cast<Index>(observations.positions(used[i])[0]);
      displacement.block(at, 3 * pose, block.rows(), 3) = z;
    }
  }
  Eigen::MatrixXd covariance(double factor, double pose) const {
    return factor * Eigen::MatrixXd::Identity(residuals.size(), residuals.size()) +
           pose * displacement * displacement.transpose();
  }
};

}  // namespace abbe::test
