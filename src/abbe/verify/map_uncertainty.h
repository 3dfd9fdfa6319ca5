#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "abbe/verify/error_map.h"
#include "abbe/verify/parts/deviation_block.h"

namespace abbe {

/// Standard uncertainties of the deviations of a block from the covariance of the parameters, P Cov P^T to first order.
///
/// Optionally for deviations from which the best-fit rigid motion over all poses is removed: that motion is itself a
/// function of the parameters, so its part of the uncertainty goes with it. Thread-safe.
class MapUncertainty {
 public:
  /// @throws std::invalid_argument if the covariance is not [n, n], symmetric and positive semi-definite
  MapUncertainty(const ParameterCovariance& covariance, std::size_t parameter_count, bool orientation);

  /// Sums over poses from which the removed motion's derivative follows.
  struct Sums {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::MatrixXd mixed;  ///< [6, n]
  };
  Sums no_sums() const;  ///< zero, in the sizes of sums()
  Sums sums(const DeviationModel& model, const DeviationBlock& block) const;
  void remove_rigid_motion(const Sums& total);

  /// @param uncertainty  six (three without orientation) arrays of [block.count], written
  void evaluate(const DeviationModel& model, const DeviationBlock& block,
                std::array<std::vector<double>, 6>& uncertainty, std::vector<double>& norm_uncertainty) const;

 private:
  std::vector<std::size_t> parameters_;
  Eigen::MatrixXd factor_;   ///< [n, rank], covariance = factor * factor^T
  Eigen::MatrixXd removed_;  ///< [6, n] derivative of the removed motion, or empty
  Eigen::Index rows_;        ///< 6, or 3 without orientation
};

}  // namespace abbe
