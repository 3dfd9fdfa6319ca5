#include "abbe/machine/placement.h"

#include <cmath>

#include "abbe/geometry/rotation.h"

namespace abbe {

Eigen::Matrix3d rotation_xyz(const Eigen::Vector3d& angles) {
  return rotation_about(Eigen::Vector3d::UnitX(), angles.x()) * rotation_about(Eigen::Vector3d::UnitY(), angles.y()) *
         rotation_about(Eigen::Vector3d::UnitZ(), angles.z());
}

Eigen::Vector3d angles_xyz(const Eigen::Matrix3d& r) {
  const double cos_beta = std::hypot(r(0, 0), r(0, 1));
  const double beta = std::atan2(r(0, 2), cos_beta);
  if (cos_beta < 1e-12) return {0, beta, std::atan2(r(1, 0), r(1, 1))};
  return {std::atan2(-r(1, 2), r(2, 2)), beta, std::atan2(-r(0, 1), r(0, 0))};
}

Machine with_workpiece(Machine machine, const Placement& placement) {
  machine.bed_from_workpiece = machine.bed_from_workpiece * placement.table_from_workpiece;
  return machine;
}

}  // namespace abbe
