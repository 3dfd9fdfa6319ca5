#include "abbe/geometry/fits/quadratic_program.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/geometry/decompositions.h"

namespace abbe::fits {
namespace {

// At the solution: the mean product of a slack and its multiplier, and the residuals.
constexpr double kComplementary = 1e-15;
constexpr double kSolved = 1e-12;
// In badly scaled problems rounding keeps the dual residual above kSolved. The iteration therefore also ends where the
// residual is below kNearlySolved and a step leaves more than kNoGain of it: further steps would divide by slacks that
// consist of rounding, and would lead away from the solution.
constexpr double kNearlySolved = 1e-6;
constexpr double kNoGain = 0.9;

}  // namespace

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd quadratic_program(const MatrixXd& rows, const VectorXd& bound, const VectorXd& cost, const MatrixXd& quadratic,
                           VectorXd& x) {
  const Index m = rows.rows();
  VectorXd s = (bound - rows * x).cwiseMax(1e-3);
  VectorXd lambda = VectorXd::Constant(m, 1.0 / static_cast<double>(m));
  double last_dual_residual = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 80; ++iteration) {
    const VectorXd dual = cost + quadratic * x + rows.transpose() * lambda;
    const VectorXd primal = rows * x + s - bound;
    const double mu = s.dot(lambda) / static_cast<double>(m);
    const double dual_residual = dual.cwiseAbs().maxCoeff();
    const bool is_rounding = dual_residual < kNearlySolved && dual_residual > kNoGain * last_dual_residual;
    if (mu < kComplementary && primal.cwiseAbs().maxCoeff() < kSolved && (dual_residual < kSolved || is_rounding))
      return lambda;
    last_dual_residual = dual_residual;
    const VectorXd ratio = lambda.cwiseQuotient(s);
    MatrixXd normal = quadratic + rows.transpose() * ratio.asDiagonal() * rows;
    normal.diagonal().array() += 1e-14 * normal.diagonal().maxCoeff();
    const Ldlt<> factor(normal);
    const auto direction = [&](const VectorXd& complement, VectorXd& dx, VectorXd& ds, VectorXd& dl) {
      const VectorXd inner = (lambda.cwiseProduct(primal) - complement).cwiseQuotient(s);
      dx = factor.solve(-dual - rows.transpose() * inner);
      ds = -primal - rows * dx;
      dl = -(complement + lambda.cwiseProduct(ds)).cwiseQuotient(s);
    };
    const auto room = [](const VectorXd& v, const VectorXd& dv) {
      double a = 1;
      for (Index i = 0; i < v.size(); ++i) {
        if (dv[i] < 0) a = std::min(a, -v[i] / dv[i]);
      }
      return a;
    };
    VectorXd dx, ds, dl;
    direction(s.cwiseProduct(lambda), dx, ds, dl);
    const double after = (s + room(s, ds) * ds).dot(lambda + room(lambda, dl) * dl) / static_cast<double>(m);
    const double centring = std::pow(after / mu, 3);
    direction((s.cwiseProduct(lambda) + ds.cwiseProduct(dl)).array() - centring * mu, dx, ds, dl);
    if (!dx.allFinite() || !dl.allFinite()) break;
    const double a = std::min(1.0, 0.995 * room(s, ds)), b = std::min(1.0, 0.995 * room(lambda, dl));
    x += a * dx;
    s += a * ds;
    lambda += b * dl;
    if (mu < 1e-14 && iteration > 60) return lambda;
  }
  return s.dot(lambda) / static_cast<double>(m) < 1e-9 ? lambda : VectorXd();
}

}  // namespace abbe::fits
