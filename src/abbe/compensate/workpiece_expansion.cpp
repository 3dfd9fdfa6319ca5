#include "abbe/compensate/workpiece_expansion.h"

#include <cmath>
#include <limits>

#include "abbe/errors/expansion.h"

namespace abbe {

double strain_variance(const WorkpieceExpansion& expansion, double factor) {
  const double of_coefficient = expansion.standard_uncertainty * factor;
  const double of_temperature =
      std::hypot(expansion.coefficient, expansion.standard_uncertainty) * expansion.temperature_uncertainty;
  return of_coefficient * of_coefficient + of_temperature * of_temperature;
}

double workpiece_factor(const Machine& machine, const WorkpieceExpansion& expansion, const PoseList& poses,
                        std::size_t pose) {
  if (expansion.temperature) return *expansion.temperature - kReferenceTemperature;
  const std::size_t j = expansion.state;
  if (j >= poses.state.size() || pose >= poses.state[j].size()) return std::numeric_limits<double>::quiet_NaN();
  return poses.state[j][pose] - machine.states.at(j).reference;
}

Eigen::Vector3d expanded_point(const WorkpieceExpansion& expansion, double factor, const Eigen::Vector3d& point) {
  return point + expansion.coefficient * factor * (point - expansion.fixed_point);
}

Eigen::Matrix3d expanded_point_covariance(const WorkpieceExpansion& expansion, double factor,
                                          const Eigen::Vector3d& point) {
  const Eigen::Vector3d arm = point - expansion.fixed_point;
  return strain_variance(expansion, factor) * arm * arm.transpose();
}

}  // namespace abbe
