#include "eigen_fit.h"

#include <Eigen/Dense>
#include <cmath>

namespace abbe::benchmarks {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Residuals and Jacobian by (3 shifts, 2 tilts, radius, half angle) in the frame of the shape, those it has.
void fill(ShapeKind kind, const Matrix3Xd& q, double radius, double half_angle, MatrixXd& jacobian, VectorXd& d) {
  const double sine = std::sin(half_angle), cosine = std::cos(half_angle);
  for (Index i = 0; i < q.cols(); ++i) {
    const double x = q(0, i), y = q(1, i), z = q(2, i), across = std::hypot(x, y);
    switch (kind) {
      case ShapeKind::line2:  // the line along x
        jacobian.row(i) << -1, -x;
        d[i] = y;
        break;
      case ShapeKind::line3:
        jacobian.row(2 * i) << -1, 0, 0, -z;
        jacobian.row(2 * i + 1) << 0, -1, z, 0;
        d.segment<2>(2 * i) << x, y;
        break;
      case ShapeKind::plane:
        jacobian.row(i) << -1, -y, x;
        d[i] = z;
        break;
      case ShapeKind::circle2:
        jacobian.row(i) << -x / across, -y / across, -1;
        d[i] = across - radius;
        break;
      case ShapeKind::circle3:
        jacobian.row(2 * i) << -x / across, -y / across, 0, z * y / across, -z * x / across, -1;
        jacobian.row(2 * i + 1) << 0, 0, -1, -y, x, 0;
        d.segment<2>(2 * i) << across - radius, z;
        break;
      case ShapeKind::sphere: {
        const double length = q.col(i).norm();
        jacobian.row(i) << -x / length, -y / length, -z / length, -1;
        d[i] = length - radius;
        break;
      }
      case ShapeKind::cylinder:
        jacobian.row(i) << -x / across, -y / across, z * y / across, -z * x / across, -1;
        d[i] = across - radius;
        break;
      case ShapeKind::cone: {
        const double out = across - radius;
        const double turn = out * sine + z * cosine + radius * sine;
        jacobian.row(i) << -cosine * x / across, -cosine * y / across, y / across * turn, -x / across * turn, -cosine,
            -out * sine - z * cosine;
        d[i] = out * cosine - z * sine;
        break;
      }
    }
  }
}

}  // namespace

EigenFit eigen_fit(const Shape& start, const Matrix3Xd& points) {
  const ShapeKind kind = start.kind;
  const bool two_rows = kind == ShapeKind::line3 || kind == ShapeKind::circle3;
  const int parameters[] = {2, 4, 3, 3, 6, 4, 5, 6};  // in the order of ShapeKind
  const Index p = parameters[static_cast<int>(kind)], rows = points.cols() * (two_rows ? 2 : 1);
  const Vector3d centroid = points.rowwise().mean();
  const Matrix3Xd centred = points.colwise() - centroid;
  EigenFit fit;
  fit.shape = start;
  Vector3d origin = start.point - centroid;
  Matrix3d axes = Matrix3d::Identity();
  if (kind == ShapeKind::line2) {
    axes.col(0) = start.direction;
    axes.col(1) = Vector3d(-start.direction.y(), start.direction.x(), 0);
  } else if (kind != ShapeKind::sphere && kind != ShapeKind::circle2) {
    axes = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), start.direction).toRotationMatrix();
  }
  MatrixXd jacobian(rows, p);
  VectorXd d(rows);
  for (fit.iterations = 1; fit.iterations <= 50; ++fit.iterations) {
    const Matrix3Xd q = axes.transpose() * (centred.colwise() - origin);
    fill(kind, q, fit.shape.radius, fit.shape.half_angle, jacobian, d);
    const VectorXd step = (jacobian.transpose() * jacobian).ldlt().solve(-jacobian.transpose() * d);
    Vector3d shift = Vector3d::Zero(), tilt = Vector3d::Zero();
    switch (kind) {
      case ShapeKind::line2:
        shift.y() = step[0];
        tilt.z() = step[1];
        break;
      case ShapeKind::plane:
        shift.z() = step[0];
        tilt.head<2>() = step.segment<2>(1);
        break;
      case ShapeKind::line3:
        shift.head<2>() = step.head<2>();
        tilt.head<2>() = step.segment<2>(2);
        break;
      case ShapeKind::circle2:
        shift.head<2>() = step.head<2>();
        fit.shape.radius += step[2];
        break;
      case ShapeKind::sphere:
        shift = step.head<3>();
        fit.shape.radius += step[3];
        break;
      case ShapeKind::circle3:
        shift = step.head<3>();
        tilt.head<2>() = step.segment<2>(3);
        fit.shape.radius += step[5];
        break;
      case ShapeKind::cylinder:
      case ShapeKind::cone:
        shift.head<2>() = step.head<2>();
        tilt.head<2>() = step.segment<2>(2);
        fit.shape.radius += step[4];
        if (kind == ShapeKind::cone) fit.shape.half_angle += step[5];
        break;
    }
    origin += axes * shift;
    if (tilt.norm() > 0) axes = axes * Eigen::AngleAxisd(tilt.norm(), tilt.normalized()).toRotationMatrix();
    fit.squares = d.squaredNorm();
    if (step.cwiseAbs().maxCoeff() < 1e-10) break;
  }
  fit.shape.point = origin + centroid;
  if (kind != ShapeKind::sphere) fit.shape.direction = axes.col(kind == ShapeKind::line2 ? 0 : 2);
  return fit;
}

}  // namespace abbe::benchmarks
