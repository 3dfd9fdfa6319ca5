#include "abbe/compensate/bounded_least_squares.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {
namespace {

/// Of the largest singular value: below, it is rounding, and what it would divide as well.
constexpr double kNoSingularValue = 1e-13;

/// Square systems whose smallest singular value is surely not below t; false for all others.
bool solve_directly(const SmallMatrix& a, const SmallVector& b, double t, SmallVector& y) {
  if (a.rows() == 2 && a.cols() == 2) {
    const double determinant = a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
    if (!(std::abs(determinant) > std::max(t, 1e-3 * a.norm()) * a.norm())) return false;
    y.resize(2);
    y << (b[0] * a(1, 1) - b[1] * a(0, 1)) / determinant, (a(0, 0) * b[1] - a(1, 0) * b[0]) / determinant;
    return true;
  }
  if (a.rows() == 3 && a.cols() == 3) {
    const Eigen::Matrix3d m = a;
    const double determinant = m.determinant(), square = m.squaredNorm() / 2;
    if (!(std::abs(determinant) > std::max(t, 1e-3 * m.norm()) * square)) return false;
    y = m.inverse() * Eigen::Vector3d(b);
    return true;
  }
  return false;
}

}  // namespace

SmallVector bounded_least_squares(const SmallMatrix& a, const SmallVector& b, double largest, bool& bounded) {
  bounded = false;
  const Eigen::Index n = a.cols();
  if (n == 0) return SmallVector::Zero(0);
  const double t = b.norm() / largest;
  SmallVector y;
  if (solve_directly(a, b, t, y)) return y;
  // Of fixed largest size: nothing is allocated.
  const Eigen::JacobiSVD<SmallMatrix> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  SmallVector z = SmallVector::Zero(n);
  for (Eigen::Index i = 0; i < svd.singularValues().size(); ++i) {
    const double s = svd.singularValues()[i];
    const double divisor = std::max(s * s, t * t);
    if (divisor > 0) z[i] = s * svd.matrixU().col(i).dot(b) / divisor;
    if (s < t) bounded = true;
  }
  return svd.matrixV() * z;
}

ArmVector bounded_in_order(const ArmMatrix& a, const ArmVector& b, double largest, bool& first, bool& bounded) {
  first = bounded = false;
  const Eigen::Index n = a.cols(), rest = a.rows() - 3;
  const auto bounded_part = [](const Eigen::JacobiSVD<ArmMatrix>& svd, const ArmVector& right, double most, bool& cut) {
    ArmVector z = ArmVector::Zero(svd.cols());
    const double size = right.norm();
    for (Eigen::Index i = 0; i < svd.singularValues().size(); ++i) {
      const double s = svd.singularValues()[i];
      if (s * most < size) cut = true;
      if (s <= kNoSingularValue * svd.singularValues()[0]) continue;
      // s / max(s^2, t^2) with t = |b| / most, without dividing by a bound of zero.
      const double t = most > 0 ? size / most : std::numeric_limits<double>::infinity();
      const double divisor = std::max(s * s, t * t);
      if (divisor > 0 && std::isfinite(divisor)) z[i] = s * svd.matrixU().col(i).dot(right) / divisor;
    }
    return ArmVector(svd.matrixV() * z);
  };
  const Eigen::JacobiSVD<ArmMatrix> svd(a.topRows(3), Eigen::ComputeFullU | Eigen::ComputeFullV);
  ArmVector y = bounded_part(svd, b.head(3), largest, first);
  if (rest == 0 || n <= 3) return y;
  // Columns: what leaves the first problem alone.
  const ArmMatrix free = svd.matrixV().rightCols(n - 3);
  const ArmMatrix by_free = a.bottomRows(rest) * free;
  const ArmVector right = b.tail(rest) - a.bottomRows(rest) * y;
  const double most = std::sqrt(std::max(0.0, largest * largest - y.squaredNorm()));
  const Eigen::JacobiSVD<ArmMatrix> second(by_free, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return y + free * bounded_part(second, right, most, bounded);
}

}  // namespace abbe
