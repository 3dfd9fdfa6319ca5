#include "abbe/compensate/bounded_least_squares.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

/// Columns of u and v turned in pairs until those of u are at right angles (one-sided Jacobi): u = a v, to full
/// relative accuracy of the singular values, which a'a would have lost.
void turn_to_right_angles(SmallMatrix& u, SmallMatrix& v) {
  for (int sweep = 0; sweep < 30; ++sweep) {
    bool turned = false;
    for (Eigen::Index i = 0; i < u.cols(); ++i) {
      for (Eigen::Index k = i + 1; k < u.cols(); ++k) {
        const double ii = u.col(i).squaredNorm(), kk = u.col(k).squaredNorm(), ik = u.col(i).dot(u.col(k));
        if (ik == 0 || std::abs(ik) <= 1e-16 * std::sqrt(ii * kk)) continue;
        turned = true;
        const double zeta = (kk - ii) / (2 * ik);
        const double t = (zeta >= 0 ? 1 : -1) / (std::abs(zeta) + std::hypot(1, zeta));
        const double c = 1 / std::hypot(1, t), s = c * t;
        for (SmallMatrix* matrix : {&u, &v}) {
          const SmallVector first = matrix->col(i);
          matrix->col(i) = c * first - s * matrix->col(k);
          matrix->col(k) = s * first + c * matrix->col(k);
        }
      }
    }
    if (!turned) return;
  }
}

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
  SmallMatrix u = a;
  SmallMatrix v = SmallMatrix::Identity(n, n);
  turn_to_right_angles(u, v);
  SmallVector z(n);
  // Fewer equations than unknowns leave zero columns: directions without influence, not bounded ones.
  const double rounding = 1e-15 * a.norm();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double s = u.col(i).norm();
    const double divisor = std::max(s * s, t * t);
    z[i] = divisor > 0 ? u.col(i).dot(b) / divisor : 0;
    if (s < t && (a.rows() >= n || s > rounding)) bounded = true;
  }
  return v * z;
}

}  // namespace abbe
