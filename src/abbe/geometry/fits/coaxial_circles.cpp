#include "abbe/geometry/fits/coaxial_circles.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/fits/shape_start.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Circles = std::span<const Matrix3Xd>;

/// Steps: two shifts and two tilts of the axis, then the heights, then the radii.
constexpr Index kAxisSteps = 4;

/// Axis with circles; coordinates from a place near the points.
struct Axis {
  Vector3d origin = Vector3d::Zero();
  Matrix3d axes = Matrix3d::Identity();  // columns e1, e2, e3 along the axis
  VectorXd heights, radii;
};

Axis moved(const Axis& axis, const VectorXd& step) {
  fits::ShapeFrame frame;
  frame.kind = ShapeKind::cylinder;
  frame.axes = axis.axes;
  frame.origin = axis.origin;
  fits::Step s = fits::Step::Zero();
  s[fits::kShift1] = step[0];
  s[fits::kShift2] = step[1];
  s[fits::kTilt1] = step[2];
  s[fits::kTilt2] = step[3];
  frame = fits::moved(frame, s);
  const Index m = axis.heights.size();
  return {frame.origin, frame.axes, axis.heights + step.segment(kAxisSteps, m), axis.radii + step.tail(m)};
}

struct ResidualSums {
  MatrixXd matrix;
  VectorXd gradient;
  double squares = 0;
};

/// J'J, J'd and d'd of the residuals (across - radius, along - height).
ResidualSums sums_at(const Axis& axis, const std::vector<Matrix3Xd>& circles) {
  const Index m = axis.heights.size(), p = kAxisSteps + 2 * m;
  ResidualSums sums{MatrixXd::Zero(p, p), VectorXd::Zero(p), 0};
  for (Index c = 0; c < m; ++c) {
    const Matrix3Xd& points = circles[static_cast<std::size_t>(c)];
    // Slopes by the axis, the height and the radius of this circle.
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    for (Index i = 0; i < points.cols(); ++i) {
      const Vector3d q = axis.axes.transpose() * (points.col(i) - axis.origin);
      const double across = std::max(std::hypot(q.x(), q.y()), 1e-300), x = q.x() / across, y = q.y() / across;
      Eigen::Matrix<double, 6, 2> slopes;
      slopes.col(0) << -x, -y, q.z() * y, -q.z() * x, 0, -1;
      slopes.col(1) << 0, 0, -q.y(), q.x(), -1, 0;
      const Eigen::Vector2d d(across - axis.radii[c], q.z() - axis.heights[c]);
      matrix += slopes * slopes.transpose();
      gradient += slopes * d;
      sums.squares += d.squaredNorm();
    }
    const Index at[6] = {0, 1, 2, 3, kAxisSteps + c, kAxisSteps + m + c};
    for (int a = 0; a < 6; ++a) {
      sums.gradient[at[a]] += gradient[a];
      for (int b = 0; b < 6; ++b) sums.matrix(at[a], at[b]) += matrix(a, b);
    }
  }
  return sums;
}

std::vector<Index> free_steps(Index m, const CoaxialOptions& options) {
  std::vector<Index> free = {0, 1};
  if (!options.direction) free.insert(free.end(), {2, 3});
  for (Index c = 0; c < m; ++c) free.push_back(kAxisSteps + c);
  for (Index c = 0; c < m && options.radii.empty(); ++c) free.push_back(kAxisSteps + m + c);
  return free;
}

struct Normal {
  MatrixXd matrix;  // of the free steps, scaled to unit diagonal
  VectorXd scale;
};

Normal scaled(const ResidualSums& sums, const std::vector<Index>& free) {
  Normal normal;
  normal.matrix = sums.matrix(free, free);
  normal.scale = normal.matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  normal.matrix = normal.scale.asDiagonal() * normal.matrix * normal.scale.asDiagonal();
  return normal;
}

VectorXd damped_step(const ResidualSums& sums, const std::vector<Index>& free, double damping) {
  Normal normal = scaled(sums, free);
  normal.matrix.diagonal().array() += damping;
  const VectorXd right = -sums.gradient(free).cwiseProduct(normal.scale);
  const VectorXd solved = Ldlt<>(normal.matrix).solve(right).cwiseProduct(normal.scale);
  VectorXd step = VectorXd::Zero(sums.gradient.size());
  step(free) = solved;
  return step;
}

struct Reached {
  Axis axis;
  ResidualSums sums;
  int iterations = 0;
  bool converged = false;
};

Reached refine(const Axis& axis, const std::vector<Matrix3Xd>& circles, const std::vector<Index>& free, double size) {
  Reached reached{axis, sums_at(axis, circles), 0, false};
  double damping = 0;
  int at_rest = 0;
  for (reached.iterations = 1; reached.iterations < 300; ++reached.iterations) {
    VectorXd step = damped_step(reached.sums, free, damping);
    double length = 0;
    for (Index k = 0; k < step.size(); ++k)
      length = std::max(length, std::abs(step[k]) / (k == 2 || k == 3 ? 1 : size));
    if (!std::isfinite(length)) return reached;
    if (length > 0.5) step *= 0.5 / length;
    const Axis trial = moved(reached.axis, step);
    const ResidualSums sums = sums_at(trial, circles);
    if (!(sums.squares <= reached.sums.squares * (1 + 1e-12) + 1e-28 * size * size)) {
      damping = damping == 0 ? 1e-4 : damping * 10;
      if (damping > 1e12) return reached;
      continue;
    }
    reached.axis = trial;
    reached.sums = sums;
    at_rest = damping == 0 && length < 1e-11 ? at_rest + 1 : 0;
    if (at_rest >= 2 || (damping == 0 && length < 1e-14)) {
      reached.converged = true;
      return reached;
    }
    damping = damping < 1e-7 ? 0 : damping / 10;
  }
  return reached;
}

/// Circles about an axis through their mean centre.
Axis axis_from(const Vector3d& direction, const std::vector<Matrix3Xd>& circles, const CoaxialOptions& options) {
  Axis axis;
  axis.axes = fits::axes_along(direction);
  const auto m = static_cast<Index>(circles.size());
  axis.heights.resize(m);
  axis.radii.resize(m);
  Vector3d sum = Vector3d::Zero();
  for (Index c = 0; c < m; ++c) {
    const Matrix3Xd q = axis.axes.transpose() * circles[static_cast<std::size_t>(c)];
    Eigen::VectorXd centre;
    double radius = 0;
    if (!fits::algebraic_sphere(q.topRows<2>(), centre, radius)) {
      centre = q.topRows<2>().rowwise().mean();
      radius = std::sqrt((q.topRows<2>().colwise() - centre.head<2>()).colwise().squaredNorm().mean());
    }
    axis.heights[c] = q.row(2).mean();
    axis.radii[c] = options.radii.empty() ? radius : options.radii[static_cast<std::size_t>(c)];
    sum += axis.axes * Vector3d(centre[0], centre[1], 0);
  }
  axis.origin = sum / static_cast<double>(m);
  return axis;
}

/// Where the axis could lie: the normals of the planes through each circle's points, the line through the centres.
std::vector<Vector3d> directions(const std::vector<Matrix3Xd>& circles, const CoaxialOptions& options) {
  if (options.direction) return {*options.direction};
  std::vector<Vector3d> found;
  Matrix3d within = Matrix3d::Zero(), between = Matrix3d::Zero();
  std::vector<Vector3d> centres;
  Vector3d mean = Vector3d::Zero();
  for (const Matrix3Xd& circle : circles) {
    const Vector3d middle = circle.rowwise().mean();
    const Matrix3Xd q = circle.colwise() - middle;
    within += q * q.transpose();
    const ShapeFit alone = least_squares_fit(ShapeKind::circle3, circle);
    if (alone.ok()) found.push_back(alone.shape.direction);
    centres.push_back(alone.ok() ? alone.shape.point : middle);
    mean += centres.back() / static_cast<double>(circles.size());
  }
  const SymmetricEigen<3> planes(within);
  found.emplace_back(planes.eigenvectors().col(0));
  for (const Vector3d& centre : centres) between += (centre - mean) * (centre - mean).transpose();
  if (between.trace() > 0) {
    const SymmetricEigen<3> line(between);
    found.emplace_back(line.eigenvectors().col(2));
  }
  return found;
}

void check(Circles circles, const CoaxialOptions& options) {
  if (options.direction && !(options.direction->allFinite() && options.direction->norm() > 0)) {
    throw std::invalid_argument("the direction to hold is not a direction");
  }
  if (!options.radii.empty() && options.radii.size() != circles.size()) {
    throw std::invalid_argument("there is not one radius to hold per circle");
  }
  for (const double radius : options.radii) {
    if (!(radius > 0) || !std::isfinite(radius)) throw std::invalid_argument("a radius to hold is not above zero");
  }
}

/// Shifts the origin to the mean height and enters the plain data.
void report(CoaxialCircles& fit, Axis& axis, const Vector3d& centre) {
  const double mean = axis.heights.mean();
  axis.origin += mean * axis.axes.col(2);
  axis.heights.array() -= mean;
  int largest = 0;
  axis.axes.col(2).cwiseAbs().maxCoeff(&largest);
  if (axis.axes(largest, 2) < 0) {
    axis.axes.rightCols<2>() *= -1;
    axis.heights *= -1;
  }
  fit.point = centre + axis.origin;
  fit.direction = axis.axes.col(2);
  fit.heights.assign(axis.heights.begin(), axis.heights.end());
  fit.radii.assign(axis.radii.begin(), axis.radii.end());
}

/// Covariance of (point, direction, heights, radii) from that of the free steps.
void enter_covariance(CoaxialCircles& fit, const Axis& axis, const ResidualSums& sums, const std::vector<Index>& free) {
  const Index m = axis.heights.size();
  const Normal normal = scaled(sums, free);
  const SymmetricEigen<> eigen(normal.matrix);
  if (!(eigen.eigenvalues()[0] > 1e-14)) {
    fit.status = FitStatus::ambiguous;
    fit.reason = "the points do not determine all parameters";
    return;
  }
  const MatrixXd root =
      normal.scale.asDiagonal() * eigen.eigenvectors() * eigen.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal();
  MatrixXd slopes = MatrixXd::Zero(6 + 2 * m, kAxisSteps + 2 * m);
  slopes.block<3, 2>(0, 0) = axis.axes.leftCols<2>();
  slopes.block<3, 1>(3, 2) = -axis.axes.col(1);
  slopes.block<3, 1>(3, 3) = axis.axes.col(0);
  slopes.bottomRightCorner(2 * m, 2 * m).setIdentity();
  const MatrixXd used = slopes(Eigen::all, free);
  fit.covariance = fit.sigma * fit.sigma * (used * root) * (used * root).transpose();
  fit.has_covariance = true;
  const SymmetricEigen<3> tilt(Matrix3d(fit.covariance.block<3, 3>(3, 3)));
  if (tilt.eigenvalues()[2] > 0.2 * 0.2) {
    fit.status = FitStatus::ambiguous;
    fit.reason = "the direction is not determined: its standard uncertainty is more than 0.2 rad";
  }
  for (Index c = 0; c < m; ++c) {
    if (fit.covariance(6 + m + c, 6 + m + c) < std::pow(0.25 * axis.radii[c], 2)) continue;
    fit.status = FitStatus::ambiguous;
    fit.reason = "a radius is not determined: its standard uncertainty is more than a quarter of it";
  }
}

}  // namespace

CoaxialCircles coaxial_circles_fit(Circles circles, const CoaxialOptions& options) {
  check(circles, options);
  CoaxialCircles fit;
  fit.point.setZero();
  fit.direction.setZero();
  const auto m = static_cast<Index>(circles.size());
  const std::vector<Index> free = free_steps(m, options);
  const auto fail = [&fit](FitStatus status, const std::string& reason) {
    fit.status = status;
    fit.reason = reason;
    return fit;
  };
  Vector3d centre = Vector3d::Zero();
  for (const Matrix3Xd& circle : circles) {
    fit.points += static_cast<std::size_t>(circle.cols());
    if (circle.cols() < 2) return fail(FitStatus::too_few_points, "a circle has fewer than two points");
    if (!circle.allFinite()) return fail(FitStatus::bad_points, "a coordinate is not finite");
    centre += circle.rowwise().mean() / static_cast<double>(m);
  }
  fit.degrees_of_freedom = 2 * static_cast<long>(fit.points) - static_cast<long>(free.size());
  if (m == 0 || fit.degrees_of_freedom < 0) {
    return fail(FitStatus::too_few_points,
                std::to_string(fit.points) + " points for " + std::to_string(free.size()) + " parameters");
  }
  std::vector<Matrix3Xd> centred;
  double size = 0;
  for (const Matrix3Xd& circle : circles) {
    centred.emplace_back(circle.colwise() - centre);
    size = std::max(size, centred.back().cwiseAbs().maxCoeff());
    const Vector3d middle = centred.back().rowwise().mean();
    if (!((centred.back().colwise() - middle).cwiseAbs().maxCoeff() > 1e-9 * size)) {
      return fail(FitStatus::degenerate, "all points of a circle are at one place");
    }
  }
  Reached best;
  best.sums.squares = std::numeric_limits<double>::infinity();
  for (const Vector3d& direction : directions(centred, options)) {
    const Reached reached = refine(axis_from(direction, centred, options), centred, free, size);
    if (reached.converged && reached.axis.radii.minCoeff() > 0 && reached.sums.squares < best.sums.squares) {
      best = reached;
    }
  }
  if (!best.converged) return fail(FitStatus::not_converged, "the iteration did not come to rest");
  fit.status = FitStatus::ok;
  fit.iterations = best.iterations;
  report(fit, best.axis, centre);
  best.sums = sums_at(best.axis, centred);
  fit.rms = std::sqrt(best.sums.squares / static_cast<double>(fit.points));
  for (Index c = 0; c < m; ++c) {
    double farthest = 0;
    const Matrix3Xd q =
        best.axis.axes.transpose() * (centred[static_cast<std::size_t>(c)].colwise() - best.axis.origin);
    for (Index i = 0; i < q.cols(); ++i) {
      farthest = std::max(
          farthest, std::hypot(std::hypot(q(0, i), q(1, i)) - best.axis.radii[c], q(2, i) - best.axis.heights[c]));
    }
    fit.form.push_back(2 * farthest);
  }
  if (best.axis.radii.maxCoeff() > 1e6 * size) return fail(FitStatus::degenerate, "a radius has no bound");
  const bool known = options.sigma > 0;
  if (known || fit.degrees_of_freedom > 0) {
    fit.sigma = known ? options.sigma : std::sqrt(best.sums.squares / static_cast<double>(fit.degrees_of_freedom));
    enter_covariance(fit, best.axis, best.sums, free);
  }
  return fit;
}

}  // namespace abbe
