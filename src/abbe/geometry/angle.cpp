#include "abbe/geometry/angle.h"

#include <Eigen/Geometry>
#include <cmath>

namespace abbe {

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace abbe
