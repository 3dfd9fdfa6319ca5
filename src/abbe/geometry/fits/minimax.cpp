#include "abbe/geometry/fits/minimax.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/fits/quadratic_program.h"

namespace abbe::fits {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Values and gradients by the free steps.
struct Linearised {
  VectorXd value;     // [m]
  MatrixXd gradient;  // [m, p]
};

Linearised linearise(const ShapeFrame& frame, const std::vector<SignedPoint>& points, const std::vector<int>& free) {
  Linearised l;
  const auto m = static_cast<Index>(points.size()), p = static_cast<Index>(free.size());
  l.value.resize(m);
  l.gradient.resize(m, p);
  for (Index k = 0; k < m; ++k) {
    const SignedPoint& s = points[static_cast<std::size_t>(k)];
    const PointSlopes slopes = point_slopes(frame, s.point);
    l.value[k] = s.sign * slopes.distance;
    for (Index j = 0; j < p; ++j) l.gradient(k, j) = s.sign * slopes.slope[free[static_cast<std::size_t>(j)]];
  }
  return l;
}

/// Rows of a linear program: a distance from a line or circle in space is the largest of its components in all
/// directions across it, and is replaced by many of them, densest about its own; any other is one row.
struct Cuts {
  VectorXd value;            // [rows]
  MatrixXd gradient;         // [rows, p]
  std::vector<Index> owner;  // [rows] index of the point
};

Cuts cut(const ShapeFrame& frame, const std::vector<SignedPoint>& points, const std::vector<int>& free) {
  const auto m = static_cast<Index>(points.size()), p = static_cast<Index>(free.size());
  Cuts cuts;
  if (rows_per_point(frame.kind) == 1) {
    Linearised l = linearise(frame, points, free);
    cuts = {std::move(l.value), std::move(l.gradient), {}};
    for (Index k = 0; k < m; ++k) cuts.owner.push_back(k);
    return cuts;
  }
  constexpr int kAround = 24;
  constexpr double kNear[] = {0, -0.01, 0.01, -0.03, 0.03, -0.1, 0.1};
  constexpr Index kRows = kAround + std::size(kNear);
  cuts.value.resize(kRows * m);
  cuts.gradient.resize(kRows * m, p);
  for (Index k = 0; k < m; ++k) {
    const std::array<PointSlopes, 2> parts = point_components(frame, points[static_cast<std::size_t>(k)].point);
    const double own = std::atan2(parts[1].distance, parts[0].distance);
    for (Index r = 0; r < kRows; ++r) {
      const double angle = r < kAround ? own + (static_cast<double>(r) + 0.5) * 2 * std::numbers::pi / kAround
                                       : own + kNear[r - kAround];
      const double c = std::cos(angle), s = std::sin(angle);
      cuts.value[kRows * k + r] = c * parts[0].distance + s * parts[1].distance;
      for (Index j = 0; j < p; ++j) {
        const int step = free[static_cast<std::size_t>(j)];
        cuts.gradient(kRows * k + r, j) = c * parts[0].slope[step] + s * parts[1].slope[step];
      }
      cuts.owner.push_back(k);
    }
  }
  return cuts;
}

double largest(const ShapeFrame& frame, const std::vector<SignedPoint>& points) {
  double value = -std::numeric_limits<double>::infinity();
  for (const SignedPoint& s : points) value = std::max(value, s.sign * point_slopes(frame, s.point).distance);
  return value;
}

Step step_of(const VectorXd& y, const std::vector<int>& free) {
  Step step = Step::Zero();
  for (std::size_t j = 0; j < free.size(); ++j) step[free[j]] = y[static_cast<Index>(j)];
  return step;
}

/// Leaves out points until the columns (gradient, 1) of the rest are independent, the combination unchanged
/// (Caratheodory).
void reduce(const Linearised& l, const VectorXd& scale, std::vector<Index>& active, std::vector<double>& multiplier) {
  while (active.size() > 1) {
    MatrixXd columns(l.gradient.cols() + 1, static_cast<Index>(active.size()));
    for (std::size_t k = 0; k < active.size(); ++k) {
      columns.col(static_cast<Index>(k)) << l.gradient.row(active[k]).transpose().cwiseProduct(scale), 1;
    }
    FullLu<> lu(columns);
    lu.set_threshold(1e-9);
    if (lu.rank() == columns.cols()) return;
    const VectorXd z = lu.kernel().col(0);
    double a = std::numeric_limits<double>::infinity();
    std::size_t leaves = 0;
    const double sense = z.maxCoeff() > 0 ? 1 : -1;
    for (std::size_t k = 0; k < active.size(); ++k) {
      const double down = sense * z[static_cast<Index>(k)];
      if (down > 1e-14 && multiplier[k] / down < a) a = multiplier[k] / down, leaves = k;
    }
    for (std::size_t k = 0; k < active.size(); ++k) multiplier[k] -= a * sense * z[static_cast<Index>(k)];
    active.erase(active.begin() + static_cast<std::ptrdiff_t>(leaves));
    multiplier.erase(multiplier.begin() + static_cast<std::ptrdiff_t>(leaves));
  }
}

/// Appends points that touch as well, without multiplier, while the columns (gradient, 1) stay independent.
void extend(const Linearised& l, const VectorXd& scale, const VectorXd& slack, std::vector<Index>& active,
            std::vector<double>& multiplier) {
  const Index p = l.gradient.cols();
  MatrixXd columns(p + 1, 0);
  const auto append = [&](Index k) {
    MatrixXd more(p + 1, columns.cols() + 1);
    more.leftCols(columns.cols()) = columns;
    more.col(columns.cols()) << l.gradient.row(k).transpose().cwiseProduct(scale), 1;
    FullLu<> lu(more);
    lu.set_threshold(1e-6);
    if (lu.rank() < more.cols()) return false;
    columns = more;
    return true;
  };
  for (const Index k : active) append(k);
  std::vector<Index> touching;
  for (Index k = 0; k < slack.size(); ++k) {
    if (slack[k] < 1e-6 && std::find(active.begin(), active.end(), k) == active.end()) touching.push_back(k);
  }
  std::sort(touching.begin(), touching.end(), [&](Index a, Index b) { return slack[a] < slack[b]; });
  for (const Index k : touching) {
    if (columns.cols() > p) return;
    if (!append(k)) continue;
    active.push_back(k);
    multiplier.push_back(0);
  }
}

/// Second derivatives of the combination of the active values, by differences of their slopes. Where the combined slope
/// is zero it does not matter that each slope is by steps of its own frame.
MatrixXd curvature(const ShapeFrame& frame, const std::vector<SignedPoint>& active,
                   const std::vector<double>& multiplier, const std::vector<int>& free, double size) {
  const auto p = static_cast<Index>(free.size());
  // The distance from a line or circle in space bends over its own length.
  double extent = size;
  if (rows_per_point(frame.kind) == 2) {
    for (const SignedPoint& s : active) extent = std::min(extent, point_slopes(frame, s.point).distance);
  }
  const auto slope = [&](const VectorXd& y) {
    const ShapeFrame at = moved(frame, step_of(y, free));
    VectorXd sum = VectorXd::Zero(p);
    for (std::size_t k = 0; k < active.size(); ++k) {
      const PointSlopes slopes = point_slopes(at, active[k].point);
      for (Index j = 0; j < p; ++j) {
        sum[j] += multiplier[k] * active[k].sign * slopes.slope[free[static_cast<std::size_t>(j)]];
      }
    }
    return sum;
  };
  MatrixXd w(p, p);
  for (Index j = 0; j < p; ++j) {
    const int k = free[static_cast<std::size_t>(j)];
    const double reach = 1e-4 * extent / (k == kTilt1 || k == kTilt2 || k == kHalfAngle ? size : 1);
    w.col(j) = (slope(VectorXd::Unit(p, j) * reach) - slope(-VectorXd::Unit(p, j) * reach)) / (2 * reach);
  }
  return (w + w.transpose()) / 2;
}

/// What is left of a symmetric matrix without its negative eigenvalues.
MatrixXd convex_part(const MatrixXd& symmetric) {
  const SymmetricEigen<> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

/// True if the combination of the active values bends upwards wherever they all stay equal to first order.
bool is_minimum(const MatrixXd& curvature, const MatrixXd& gradient, double size) {
  FullLu<> lu(gradient);
  lu.set_threshold(1e-7);
  if (lu.kernel_dimension() == 0) return true;
  const MatrixXd z = Qr(lu.kernel()).orthonormal(lu.kernel_dimension());
  const SymmetricEigen<> eigen(z.transpose() * curvature * z, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[0] > 1e-7 / size;
}

/// Newton on: combined gradient zero, multipliers sum to one, active values equal.
/// @return true at a strict local minimum of the largest active value, whatever the sign of the multipliers
bool newton(Minimax& answer, const std::vector<SignedPoint>& active, const std::vector<int>& free, double size,
            std::vector<double> multiplier) {
  const auto p = static_cast<Index>(free.size()), a = static_cast<Index>(active.size());
  ShapeFrame frame = answer.frame;
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Linearised l = linearise(frame, active, free);
    const MatrixXd w = curvature(frame, active, multiplier, free, size);
    MatrixXd k = MatrixXd::Zero(p + 1 + a, p + 1 + a);
    k.topLeftCorner(p, p) = w;
    k.topRightCorner(p, a) = l.gradient.transpose();
    k.block(p, p + 1, 1, a).setConstant(-1);
    k.bottomLeftCorner(a, p) = l.gradient;
    k.block(p + 1, p, a, 1).setConstant(-1);
    VectorXd right = VectorXd::Zero(p + 1 + a);
    right[p] = -1;
    right.tail(a) = -l.value;
    // Rows and columns of like size: angles move the surface by the extent.
    VectorXd unit = VectorXd::Ones(p + 1 + a);
    for (Index j = 0; j < p; ++j) unit[j] = 1 / std::max(l.gradient.col(j).cwiseAbs().maxCoeff(), 1e-300);
    const FullLu<> lu(unit.asDiagonal() * k * unit.asDiagonal());
    const VectorXd solved = unit.asDiagonal() * lu.solve(unit.asDiagonal() * right);
    if (!solved.allFinite()) return false;
    const VectorXd y = solved.head(p);
    for (Index i = 0; i < a; ++i) multiplier[static_cast<std::size_t>(i)] = solved[p + 1 + i];
    const double length = p > 0 ? y.cwiseQuotient(unit.head(p)).cwiseAbs().maxCoeff() / size : 0;
    if (length > 0.1) return false;
    if (iteration > 0 && (length < 1e-15 || (length < 1e-12 && length > 0.3 * before))) {
      const MatrixXd scaled = unit.head(p).asDiagonal() * w * unit.head(p).asDiagonal();
      if (!is_minimum(scaled, l.gradient * unit.head(p).asDiagonal(), size)) return false;
      const MatrixXd inverse = unit.asDiagonal() * MatrixXd(lu.inverse()) * unit.asDiagonal();
      answer.response = -inverse.block(0, p + 1, p + 1, a);
      answer.optimality =
          (l.gradient.transpose() * Eigen::Map<const VectorXd>(multiplier.data(), a)).cwiseProduct(unit.head(p)).norm();
      answer.frame = frame;
      answer.value = solved[p];
      answer.multipliers = multiplier;
      return true;
    }
    before = length;
    frame = moved(frame, step_of(y, free));
  }
  return false;
}

/// Newton's method; points whose multiplier becomes negative do not touch and are left out.
bool polish(Minimax& answer, const std::vector<SignedPoint>& points, const std::vector<int>& free, double size,
            std::vector<double> multiplier) {
  while (answer.active.size() > 1) {
    std::vector<SignedPoint> active;
    for (const std::size_t k : answer.active) active.push_back(points[k]);
    Minimax trial = answer;
    if (!newton(trial, active, free, size, multiplier)) return false;
    const auto least = std::min_element(trial.multipliers.begin(), trial.multipliers.end());
    if (*least > -1e-9) {
      answer = trial;
      return true;
    }
    const auto at = least - trial.multipliers.begin();
    answer.active.erase(answer.active.begin() + at);
    multiplier.erase(multiplier.begin() + at);
  }
  return false;
}

}  // namespace

Minimax minimise_largest(const ShapeFrame& start, const std::vector<SignedPoint>& points, const std::vector<int>& free,
                         double size) {
  Minimax answer;
  answer.frame = start;
  const auto p = static_cast<Index>(free.size()), points_count = static_cast<Index>(points.size());
  // So many steps by linear programs; where they do not end it, the way bends: along a curved valley, straight steps
  // would go to and fro between its sides.
  constexpr int kStraight = 6;
  double reach = 1;
  // Second derivatives of the combination of the points that touched last.
  MatrixXd bend = MatrixXd::Zero(p, p);
  for (int iteration = 0; iteration < 1000; ++iteration) {
    const Cuts cuts = cut(answer.frame, points, free);
    const Index m = cuts.value.size();
    const double top = cuts.value.maxCoeff();
    const double lowest = rows_per_point(start.kind) == 2 ? 0 : cuts.value.minCoeff();
    const double spread = std::max(top - lowest, 1e-12 * size);
    VectorXd scale(p);
    for (Index j = 0; j < p; ++j) scale[j] = 1 / std::max(cuts.gradient.col(j).cwiseAbs().maxCoeff(), 1e-300);
    MatrixXd rows = MatrixXd::Zero(m + 2 * p, p + 1);
    VectorXd bound(m + 2 * p), x = VectorXd::Zero(p + 1);
    rows.topLeftCorner(m, p) = cuts.gradient * scale.asDiagonal();
    rows.block(0, p, m, 1).setConstant(-1);
    bound.head(m) = -(cuts.value.array() - top) / spread;
    rows.block(m, 0, p, p).setIdentity();
    rows.block(m + p, 0, p, p) = -MatrixXd::Identity(p, p);
    bound.tail(2 * p).setConstant(reach);
    x[p] = 1;
    MatrixXd quadratic = MatrixXd::Zero(p + 1, p + 1);
    quadratic.topLeftCorner(p, p) = spread * convex_part(scale.asDiagonal() * bend * scale.asDiagonal());
    const VectorXd lambda = quadratic_program(rows, bound, VectorXd::Unit(p + 1, p), quadratic, x);
    if (lambda.size() == 0) {
      bend.setZero();
      reach *= 0.3;
      if (reach < 1e-13) return answer;
      continue;
    }
    // The points that touch, and Newton from here: only an answer that is optimal for all points is taken.
    const VectorXd row_slack = bound.head(m) - rows.topRows(m) * x;
    VectorXd slack = VectorXd::Constant(points_count, std::numeric_limits<double>::infinity());
    VectorXd share = VectorXd::Zero(points_count);
    for (Index k = 0; k < m; ++k) {
      const Index point = cuts.owner[static_cast<std::size_t>(k)];
      slack[point] = std::min(slack[point], row_slack[k]);
      share[point] += lambda[k];
    }
    std::vector<Index> active;
    std::vector<double> multiplier;
    for (Index k = 0; k < points_count; ++k) {
      if (share[k] > 1e-7) {
        active.push_back(k);
        multiplier.push_back(share[k]);
      }
    }
    const ShapeFrame trial = moved(answer.frame, step_of((x.head(p).cwiseProduct(scale) * spread).eval(), free));
    const double value = largest(trial, points);
    const double predicted = -(x[p] + x.dot(quadratic * x) / 2) * spread, gained = top - value;
    const Linearised l = linearise(gained > 0 ? trial : answer.frame, points, free);
    reduce(l, scale, active, multiplier);
    // Alone, the points with multipliers may leave directions open that others, which touch without one, close.
    for (const bool with_all : {false, true}) {
      if (with_all) extend(l, scale, slack, active, multiplier);
      Minimax ended = answer;
      ended.frame = gained > 0 ? trial : answer.frame;
      ended.active.assign(active.begin(), active.end());
      if (!polish(ended, points, free, size, multiplier)) continue;
      const double tolerance = 3e-13 * size;
      if (largest(ended.frame, points) <= ended.value + tolerance && ended.value <= std::min(top, value) + tolerance) {
        ended.converged = true;
        return ended;
      }
    }
    if (gained > 0) answer.frame = trial;
    if (iteration >= kStraight) {
      std::vector<SignedPoint> touching;
      for (const Index k : active) touching.push_back(points[static_cast<std::size_t>(k)]);
      bend = curvature(answer.frame, touching, multiplier, free, size);
    }
    if (gained > (iteration < kStraight ? 0.75 : 0.5) * predicted) reach *= 2;
    if (gained < 0.25 * predicted) reach *= gained > 0 ? 0.5 : 0.25;
    // Beyond: on the way to infinity, where an inscribed shape that nothing surrounds goes.
    if (reach < 1e-13 || reach > 1e14) return answer;
  }
  return answer;
}

}  // namespace abbe::fits
