#include "abbe/geometry/fits/shape_refine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "abbe/geometry/decompositions.h"

namespace abbe::fits {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

MatrixXd chosen(const Eigen::Matrix<double, kParameters, kParameters>& matrix, const std::vector<int>& free) {
  const auto p = static_cast<Index>(free.size());
  MatrixXd result(p, p);
  for (Index i = 0; i < p; ++i)
    for (Index j = 0; j < p; ++j)
      result(i, j) = matrix(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]);
  return result;
}

/// Damped step in free parameters scaled to unit diagonal.
Step damped_step(const NormalSums& sums, const std::vector<int>& free, double damping) {
  MatrixXd a = chosen(sums.matrix, free);
  VectorXd scale(a.rows()), g(a.rows());
  for (Index i = 0; i < a.rows(); ++i) {
    scale[i] = a(i, i) > 0 ? 1 / std::sqrt(a(i, i)) : 0;
    g[i] = sums.gradient[free[static_cast<std::size_t>(i)]] * scale[i];
  }
  a = scale.asDiagonal() * a * scale.asDiagonal();
  a.diagonal().array() += damping;
  const VectorXd solved = Ldlt<>(a).solve(-g);
  Step step = Step::Zero();
  for (Index i = 0; i < a.rows(); ++i) step[free[static_cast<std::size_t>(i)]] = solved[i] * scale[i];
  return step;
}

double relative_size(const Step& step, double size) {
  return std::max({step.head<3>().cwiseAbs().maxCoeff() / size, std::abs(step[kTilt1]), std::abs(step[kTilt2]),
                   std::abs(step[kRadius]) / size, std::abs(step[kHalfAngle])});
}

/// Of a computed distance, mm: coordinates are taken from the centre of the data, and the radius may be larger.
double distance_rounding(const ShapeFrame& frame, double size) {
  return 4e-16 * (size + std::abs(frame.radius) + frame.origin.norm());
}

}  // namespace

Refined refine(const ShapeFrame& start, const FitPoints& points, std::span<const double> weights,
               const std::vector<int>& free, double size, int most_iterations, int threads) {
  Refined result;
  result.frame = start;
  result.sums = normal_sums(start, points, weights, threads);
  result.iterations = 1;
  if (free.empty()) {
    result.converged = true;
    return result;
  }
  const double count = static_cast<double>(points.cols());
  double damping = 0, before = 0;
  Refined lowest;  // by the decrement, among frames whose sums of squares rounding does not tell apart
  double least = std::numeric_limits<double>::infinity(), decrement = 0;
  int stalled = 0;
  while (result.iterations < most_iterations) {
    Step step = damped_step(result.sums, free, damping);
    const double length = relative_size(step, size);
    if (!std::isfinite(length)) return result;
    // A turn by a radian leads anywhere: shorten, direction kept.
    if (length > 0.5) step *= 0.5 / length;
    const double next_length = before > 0 && damping == 0 ? length * length / before : length;
    if (damping == 0 && (length <= 1e-13 || (next_length <= 1e-13 && length <= 1e-7))) {
      result.frame = moved(result.frame, step);
      result.converged = true;
      return result;
    }
    // The distances are rounded, so that sums of squares below `blur` of each other are the same.
    const double rounding = distance_rounding(result.frame, size);
    const double blur = 4 * rounding * (std::sqrt(count * result.sums.squares) + count * rounding);
    const Step whole = damping == 0 ? step : damped_step(result.sums, free, 0);
    decrement = -whole.dot(result.sums.gradient);
    const bool at_bottom = std::abs(decrement) <= blur && relative_size(whole, size) <= 0.5;
    if (at_bottom) {
      // Only the gradient, which has no such blur, can judge whole steps: they are taken while they lead lower.
      step = whole;
      stalled = decrement < 0.5 * least ? 0 : stalled + 1;
      if (decrement < least) {
        least = decrement;
        lowest = result;
      }
      if (stalled >= 3) break;
    }
    const ShapeFrame trial = moved(result.frame, step);
    const NormalSums sums = normal_sums(trial, points, weights, threads);
    ++result.iterations;
    if (!(sums.squares <= result.sums.squares + (at_bottom ? blur : 0))) {
      damping = damping == 0 ? 1e-4 : damping * 10;
      if (damping > 1e12) break;
      continue;
    }
    before = damping == 0 || at_bottom ? length : 0;
    damping = damping < 1e-7 || at_bottom ? 0 : damping / 10;
    if (!at_bottom) least = std::numeric_limits<double>::infinity();
    result.frame = trial;
    result.sums = sums;
  }
  decrement = -damped_step(result.sums, free, 0).dot(result.sums.gradient);
  if (least < decrement) {
    lowest.iterations = result.iterations;
    result = lowest;
    decrement = least;
  }
  const double rounding = distance_rounding(result.frame, size);
  const double variance = result.sums.squares / count;
  // The step that is left, in standard uncertainties of the parameters, or what rounding of the distances makes of it.
  result.converged = decrement <= std::pow(1e-6, 2) * variance + 4 * count * std::pow(rounding, 2);
  return result;
}

Eigen::Matrix3Xd spread_sample(const FitPoints& points, const Vector3d& centre, std::size_t count) {
  const auto n = static_cast<std::size_t>(points.cols());
  count = std::min(count, n);
  Eigen::Matrix3Xd sample(3, static_cast<Index>(count));
  std::mt19937_64 generator(20061);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = k * n / count, last = (k + 1) * n / count;
    // Equal steps could meet always the same place of a scan's lines.
    const std::size_t index = first + generator() % std::max<std::size_t>(last - first, 1);
    sample.col(static_cast<Index>(k)) = points.col(static_cast<Index>(index)) - centre;
  }
  return sample;
}

void check_constraints(ShapeKind kind, const FitConstraints& constraints) {
  if (constraints.radius) {
    if (!has_radius(kind) || kind == ShapeKind::cone) throw std::invalid_argument("this shape has no radius to hold");
    if (!(*constraints.radius > 0) || !std::isfinite(*constraints.radius)) {
      throw std::invalid_argument("the radius to hold is not above zero");
    }
  }
  if (constraints.direction) {
    if (kind == ShapeKind::sphere || kind == ShapeKind::circle2) {
      throw std::invalid_argument("this shape has no direction to hold");
    }
    Vector3d d = *constraints.direction;
    if (kind == ShapeKind::line2) d.z() = 0;
    if (!d.allFinite() || !(d.norm() > 0)) throw std::invalid_argument("the direction to hold is not a direction");
  }
  if (constraints.half_angle) {
    if (kind != ShapeKind::cone) throw std::invalid_argument("only a cone has an angle to hold");
    if (!(*constraints.half_angle > 0 && *constraints.half_angle < 1.5707)) {
      throw std::invalid_argument("the half angle to hold is not between 0 and 90 degrees");
    }
  }
}

Survey survey(ShapeKind kind, const FitPoints& points, const FitConstraints& constraints, int threads) {
  check_constraints(kind, constraints);
  Survey result;
  const int parameters = static_cast<int>(free_parameters(kind, constraints).size());
  const Index rows = points.cols() * rows_per_point(kind);
  const bool in_plane = kind == ShapeKind::line2 || kind == ShapeKind::circle2;
  // Two points are a line and three a circle, whatever the number of residuals.
  const Index fewest = kind == ShapeKind::line3 ? 2 : kind == ShapeKind::circle3 ? 3 : 1;
  if (points.cols() < fewest || rows < parameters) {
    result.status = FitStatus::too_few_points;
    result.reason = std::to_string(points.cols()) + " points for " + std::to_string(parameters) + " parameters";
    return result;
  }
  result.sample = spread_sample(points, Vector3d::Zero(), 600);
  result.centre = result.sample.rowwise().mean();
  if (in_plane) result.centre.z() = 0;
  result.sample.colwise() -= result.centre;
  result.centroid = centroid(points, result.centre, threads);
  if (!result.centre.allFinite() || !result.centroid.finite) {
    result.status = FitStatus::bad_points;
    result.reason = "a coordinate is not finite";
    return result;
  }
  const SymmetricEigen<3> principal(result.centroid.scatter);
  result.extent = principal.eigenvalues().cwiseMax(0).cwiseSqrt().reverse();
  result.directions = principal.eigenvectors().rowwise().reverse();
  result.size = 3 * result.extent[0];
  const double rounding = 4e-16 * (points.col(0).cwiseAbs().maxCoeff() + result.size);
  const double flat = std::max(rounding, 3e-8 * result.extent[0]);
  result.status = FitStatus::degenerate;
  const bool direction_held = constraints.direction.has_value();
  const bool needs_plane = kind == ShapeKind::plane ? !direction_held : kind >= ShapeKind::circle2;
  const bool needs_space =
      kind == ShapeKind::sphere || ((kind == ShapeKind::cylinder) && !direction_held) || (kind == ShapeKind::cone);
  const bool needs_extent =
      !(direction_held && (kind == ShapeKind::plane || kind == ShapeKind::line3 || kind == ShapeKind::line2));
  if (!(result.extent[0] > rounding) && needs_extent) {
    result.reason = "all points are at one place";
  } else if (needs_plane && !(result.extent[1] > flat)) {
    result.reason = "all points are on one straight line";
  } else if (needs_space && !(result.extent[2] > flat)) {
    result.reason = "all points are in one plane";
  } else {
    result.status = FitStatus::ok;
  }
  if (result.size == 0) result.size = 1;
  return result;
}

bool direction_is_open(ShapeKind kind, const Survey& survey, const std::vector<int>& free) {
  if (!is_straight(kind) || std::find(free.begin(), free.end(), kTilt2) == free.end()) return false;
  const Index next = kind == ShapeKind::plane ? 2 : 1;
  return !(survey.extent[next - 1] > survey.extent[next] * (1 + 1e-6));
}

void report_fit(ShapeFit& fit, const ShapeFrame& frame, const Survey& survey, const FitPoints& points,
                const std::vector<int>& free, const Eigen::Matrix<double, kParameters, kParameters>& normal,
                double sigma, int threads) {
  fit.shape = shape_of(frame, survey.centroid.mean);
  const ExtremeDistances extreme = extreme_distances(frame, points, threads);
  fit.smallest = extreme.smallest;
  fit.largest = extreme.largest;
  fit.smallest_at = extreme.smallest_at;
  fit.largest_at = extreme.largest_at;
  // The sense of the direction may have been turned after the distances were taken.
  const bool sided = frame.kind == ShapeKind::plane || frame.kind == ShapeKind::line2;
  const Vector3d positive = frame.axes.col(2);
  const Vector3d d = fit.shape.direction;
  const bool turned = frame.kind == ShapeKind::plane   ? positive.dot(d) < 0
                      : frame.kind == ShapeKind::line2 ? positive.dot(Vector3d(-d.y(), d.x(), 0)) < 0
                                                       : false;
  if (sided && turned) {
    std::swap(fit.smallest, fit.largest);
    std::swap(fit.smallest_at, fit.largest_at);
    fit.smallest *= -1;
    fit.largest *= -1;
  }
  fit.form = rows_per_point(frame.kind) == 2 ? 2 * fit.largest : fit.largest - fit.smallest;
  if (sigma < 0 || free.empty()) return;

  const auto ambiguous = [&fit](const std::string& reason) {
    if (!fit.ok()) return;
    fit.status = FitStatus::ambiguous;
    fit.reason = reason;
  };
  if (direction_is_open(frame.kind, survey, free)) {
    ambiguous("the points extend equally in all directions: no direction is better than another");
    return;
  }
  MatrixXd a = chosen(normal, free);
  const VectorXd scale = a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  a = scale.asDiagonal() * a * scale.asDiagonal();
  const SymmetricEigen<> eigen(a);
  if (!(eigen.eigenvalues()[0] > 1e-14)) {
    ambiguous("the points do not determine all parameters");
    return;
  }
  const MatrixXd inverse =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  const MatrixXd covariance = sigma * sigma * (scale.asDiagonal() * inverse * scale.asDiagonal());
  fit.covariance = shape_covariance(frame, free, covariance);
  fit.sigma = sigma;
  fit.has_covariance = true;
  if (has_radius(frame.kind) && frame.kind != ShapeKind::cone && fit.radius_uncertainty() > 0.25 * frame.radius) {
    ambiguous("the radius is not determined: its standard uncertainty is more than a quarter of it");
  } else if (fit.direction_uncertainty() > 0.2) {
    ambiguous("the direction is not determined: its standard uncertainty is more than 0.2 rad");
  } else if (frame.kind == ShapeKind::cone && fit.half_angle_uncertainty() > 0.2) {
    ambiguous("the half angle is not determined: its standard uncertainty is more than 0.2 rad");
  }
}

}  // namespace abbe::fits

namespace abbe {
namespace {

double largest_deviation(const Eigen::Matrix3d& covariance) {
  const SymmetricEigen<3> eigen(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(eigen.eigenvalues()[2], 0.0));
}

}  // namespace

double ShapeFit::direction_uncertainty() const { return largest_deviation(covariance.block<3, 3>(3, 3)); }
double ShapeFit::point_uncertainty() const { return largest_deviation(covariance.block<3, 3>(0, 0)); }

}  // namespace abbe
