#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A workpiece that is to be right at the reference temperature of its state, 20 degC (ISO 1:2022), and is worked on or
/// measured at another one. It expands alike in all directions about its fixed point.
struct WorkpieceExpansion {
  std::size_t state = kNoState;                           ///< its temperature: measured or lag, degC
  std::optional<double> temperature{};                    ///< degC, the same at all poses; instead of a state
  double coefficient = 0;                                 ///< alpha, 1/K
  double standard_uncertainty = 0;                        ///< of the coefficient, 1/K
  double temperature_uncertainty = 0;                     ///< of the temperature that the state gives, standard, K
  Eigen::Vector3d fixed_point = Eigen::Vector3d::Zero();  ///< mm, workpiece frame: stays where it is
};

/// Variance of alpha (T - T0): u^2(alpha) (T - T0)^2 + (alpha^2 + u^2(alpha)) u^2(T), exact for independent alpha and
/// T.
double strain_variance(const WorkpieceExpansion& expansion, double factor);

/// Temperature less its reference at one pose, K; NaN where the poses do not give it.
double workpiece_factor(const Machine& machine, const WorkpieceExpansion& expansion, const PoseList& poses,
                        std::size_t pose);

/// Where a point of the workpiece is at its temperature: fixed + (1 + alpha (T - T0)) (point - fixed), mm.
Eigen::Vector3d expanded_point(const WorkpieceExpansion& expansion, double factor, const Eigen::Vector3d& point);

/// Covariance of that, mm^2: strain_variance() d d' with d = point - fixed.
Eigen::Matrix3d expanded_point_covariance(const WorkpieceExpansion& expansion, double factor,
                                          const Eigen::Vector3d& point);

}  // namespace abbe
