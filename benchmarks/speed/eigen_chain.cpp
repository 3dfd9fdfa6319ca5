#include "eigen_chain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/rotation.h"

namespace abbe::benchmarks {
namespace {

Eigen::Matrix4d matrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation;
  m.topRightCorner<3, 1>() = translation;
  return m;
}

Eigen::Matrix4d shift(const Eigen::Vector3d& translation) { return matrix(Eigen::Matrix3d::Identity(), translation); }

}  // namespace

EigenChain::EigenChain(const Machine& machine, const ErrorSet& errors) {
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    OneAxis one;
    one.rotary = axis.kind == AxisKind::rotary;
    one.sense = axis.sense();
    one.direction = axis.direction;
    one.coefficients.setZero();
    for (const ErrorMotion& term : errors.motions) {
      if (term.axis != i) continue;
      one.centre = 0.5 * (term.basis.from + term.basis.to);
      one.scale = 2 / (term.basis.to - term.basis.from);
      for (std::size_t k = 0; k < term.coefficients.size(); ++k) {
        one.coefficients(static_cast<int>(term.component), static_cast<int>(k)) = term.coefficients[k];
      }
    }
    Eigen::Vector3d tilt = Eigen::Vector3d::Zero(), centre = axis.point;
    for (const LocationError& location : errors.locations) {
      if (location.axis != i) continue;
      const int k = static_cast<int>(location.component) % 3;
      (is_rotation(location.component) ? tilt : centre)[k] += location.value;
    }
    one.to_line = matrix(rotation_from_error_angles(tilt), centre);
    one.from_line = one.to_line.inverse();
    one.to_reference = shift(axis.point);
    one.from_reference = shift(-axis.point);
    (axis.side == ChainSide::tool ? tool_side_ : workpiece_side_).push_back(one);
  }
  std::reverse(workpiece_side_.begin(), workpiece_side_.end());
  bed_from_workpiece_ = matrix(machine.bed_from_workpiece.rotation, machine.bed_from_workpiece.translation);
  bed_from_gauge_ = shift(machine.tool_reference);
}

Eigen::Matrix4d EigenChain::motion(const OneAxis& axis, double position) const {
  Eigen::Matrix<double, 9, 1> functions;
  Eigen::Matrix<double, 6, 1> e;
  if (axis.rotary) {
    functions[0] = 1;
    for (int h = 1; h <= 4; ++h) {
      functions[2 * h - 1] = std::cos(h * position);
      functions[2 * h] = std::sin(h * position);
    }
    e.noalias() = axis.coefficients * functions;
  } else {
    const double s = (position - axis.centre) * axis.scale;
    functions[0] = 1;
    functions[1] = s;
    for (int n = 2; n <= 4; ++n) functions[n] = ((2 * n - 1) * s * functions[n - 1] - (n - 1) * functions[n - 2]) / n;
    e.noalias() = axis.coefficients.leftCols<5>() * functions.head<5>();
  }
  const double sa = std::sin(e[3]), ca = std::cos(e[3]), sb = std::sin(e[4]), cb = std::cos(e[4]);
  const double sc = std::sin(e[5]), cc = std::cos(e[5]);
  Eigen::Matrix4d error;
  error << cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa, e[0],  //
      sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa, e[1],       //
      -sb, cb * sa, cb * ca, e[2],                                         //
      0, 0, 0, 1;
  const double displacement = axis.sense * position;
  if (!axis.rotary) {
    const Eigen::Vector3d way = axis.to_line.topLeftCorner<3, 3>() * (displacement * axis.direction);
    return shift(way) * axis.to_reference * error * axis.from_reference;
  }
  const Eigen::Matrix4d turn =
      matrix(Eigen::AngleAxisd(displacement, axis.direction).toRotationMatrix(), Eigen::Vector3d::Zero());
  return axis.to_reference * error * axis.from_reference * axis.to_line * turn * axis.from_line;
}

Eigen::Matrix4d EigenChain::workpiece_from_tool(const double* positions) const {
  Eigen::Matrix4d bed_from_workpiece = Eigen::Matrix4d::Identity(), bed_from_tool = Eigen::Matrix4d::Identity();
  const std::size_t n = workpiece_side_.size();
  for (std::size_t i = 0; i < n; ++i) {
    bed_from_workpiece = bed_from_workpiece * motion(workpiece_side_[i], positions[n - 1 - i]);
  }
  for (std::size_t i = 0; i < tool_side_.size(); ++i) {
    bed_from_tool = bed_from_tool * motion(tool_side_[i], positions[n + i]);
  }
  bed_from_workpiece = bed_from_workpiece * bed_from_workpiece_;
  bed_from_tool = bed_from_tool * bed_from_gauge_;
  const Eigen::Matrix3d back = bed_from_workpiece.topLeftCorner<3, 3>().transpose();
  return matrix(back, -back * bed_from_workpiece.topRightCorner<3, 1>()) * bed_from_tool;
}

}  // namespace abbe::benchmarks
