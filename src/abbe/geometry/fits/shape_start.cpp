#include "abbe/geometry/fits/shape_start.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"

namespace abbe::fits {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// The centre for a held radius: on the line from the points to the free centre, as far as the radius asks.
void hold_radius(VectorXd& centre, double& radius, const VectorXd& mean, double held) {
  centre = mean + (centre - mean) * (held / radius);
  radius = held;
}

/// Both centres at the held radius, along the direction of the smallest extent.
std::vector<VectorXd> both_sides(const MatrixXd& points, double radius) {
  const VectorXd mean = points.rowwise().mean();
  const MatrixXd q = points.colwise() - mean;
  const SymmetricEigen<> principal(q * q.transpose());
  const VectorXd across = principal.eigenvectors().col(0);
  return {mean + radius * across, mean - radius * across};
}

/// Circles or spheres, with their side if the radius is held.
std::vector<std::pair<VectorXd, double>> spheres(const MatrixXd& points, const std::optional<double>& held) {
  std::vector<std::pair<VectorXd, double>> found;
  VectorXd centre;
  double radius = 0;
  if (algebraic_sphere(points, centre, radius)) {
    if (held) hold_radius(centre, radius, points.rowwise().mean(), *held);
    found.emplace_back(centre, radius);
  }
  if (held) {
    for (const VectorXd& side : both_sides(points, *held)) found.emplace_back(side, *held);
    found.emplace_back(points.rowwise().mean(), *held);
  }
  return found;
}

double mean_square(const ShapeFrame& frame, const Matrix3Xd& points) {
  double sum = 0;
  for (Index i = 0; i < points.cols(); ++i) sum += std::pow(point_slopes(frame, points.col(i)).distance, 2);
  return sum / static_cast<double>(points.cols());
}

/// Generator and normal of a patch from the paraboloid over its principal plane.
bool patch_directions(const Survey& survey, Vector3d& generator, Vector3d& normal) {
  const Matrix3d axes = survey.directions;
  const Matrix3Xd q = axes.transpose() * (survey.sample.colwise() - survey.centroid.mean);
  if (q.cols() < 6) return false;
  const double unit = std::max(survey.extent[0], 1e-300);
  MatrixXd a(q.cols(), 6);
  VectorXd b(q.cols());
  for (Index i = 0; i < q.cols(); ++i) {
    const double u = q(0, i) / unit, v = q(1, i) / unit;
    a.row(i) << 1, u, v, u * u / 2, u * v, v * v / 2;
    b[i] = q(2, i) / unit;
  }
  const VectorXd c = PivotedQr(a).solve(b);
  Eigen::Matrix2d curvature;
  curvature << c[3], c[4], c[4], c[5];
  const SymmetricEigen<2> principal(curvature);
  const int least = std::abs(principal.eigenvalues()[0]) < std::abs(principal.eigenvalues()[1]) ? 0 : 1;
  const Vector2d d = principal.eigenvectors().col(least);
  generator = (axes * Vector3d(d.x(), d.y(), c[1] * d.x() + c[2] * d.y())).normalized();
  normal = (axes * Vector3d(-c[1], -c[2], 1)).normalized();
  return generator.allFinite() && normal.allFinite();
}

std::vector<Vector3d> axis_candidates(ShapeKind kind, const Survey& survey) {
  std::vector<Vector3d> candidates = half_sphere(400);
  for (int k = 0; k < 3; ++k) candidates.push_back(survey.directions.col(k));
  Vector3d generator, normal;
  if (patch_directions(survey, generator, normal)) {
    candidates.push_back(generator);
    if (kind == ShapeKind::cone) {
      for (const double angle : {2., 5., 10., 15., 20., 27., 35., 45., 55., 65., 75., 85.}) {
        const double a = angle * kDegree;
        candidates.push_back(std::cos(a) * generator + std::sin(a) * normal);
        candidates.push_back(std::cos(a) * generator - std::sin(a) * normal);
      }
    }
  }
  return candidates;
}

std::vector<ShapeFrame> axis_starts(ShapeKind kind, const Survey& survey, const FitConstraints& constraints) {
  // The search needs the rough form only.
  const Matrix3Xd sample = spread_sample(survey.sample, Vector3d::Zero(), 250);
  std::vector<std::pair<double, ShapeFrame>> scored;
  for (const Vector3d& direction : axis_candidates(kind, survey)) {
    ShapeFrame frame;
    if (!frame_along(kind, axes_along(direction), sample, constraints, frame)) continue;
    const double score = mean_square(frame, sample);
    if (std::isfinite(score)) scored.emplace_back(score, frame);
  }
  std::stable_sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ShapeFrame> starts;
  for (const auto& [score, frame] : scored) {
    const Vector3d axis = frame.axes.col(2);
    const bool is_new = std::none_of(starts.begin(), starts.end(), [&axis](const ShapeFrame& other) {
      return std::abs(other.axes.col(2).dot(axis)) > std::cos(0.15);
    });
    if (is_new) starts.push_back(frame);
    if (starts.size() == 12) break;
  }
  return starts;
}

}  // namespace

bool apart(ShapeFrame a, ShapeFrame b, const Vector3d& centroid, double length, double angle) {
  settle(a, centroid);
  settle(b, centroid);
  if ((a.origin - b.origin).norm() > length || std::abs(a.radius - b.radius) > length) return true;
  if (!has_direction(a.kind)) return false;
  // For line2 e3 is the normal, which turns with the line.
  const Vector3d one = a.axes.col(2), other = b.axes.col(2);
  if (one.cross(other).norm() > std::sin(angle)) return true;
  // The same cone may be written with its axis the other way round.
  return std::abs(a.half_angle - std::copysign(1.0, one.dot(other)) * b.half_angle) > angle;
}

bool differ(const ShapeFrame& a, const ShapeFrame& b, const Survey& survey) {
  constexpr double kLimit = 1e-4;
  return apart(a, b, survey.centroid.mean, kLimit * (survey.size + a.radius), kLimit);
}

bool algebraic_sphere(const MatrixXd& points, VectorXd& centre, double& radius) {
  const Index d = points.rows();
  const VectorXd mean = points.rowwise().mean();
  const MatrixXd q = points.colwise() - mean;
  const VectorXd squares = q.colwise().squaredNorm();
  const double average = squares.mean();
  if (!(average > 0)) return false;
  MatrixXd rows(d + 1, points.cols());
  rows.row(0) = (squares.array() - average) / (2 * std::sqrt(average));
  rows.bottomRows(d) = q;
  const SymmetricEigen<> solver(rows * rows.transpose());
  const VectorXd a = solver.eigenvectors().col(0);
  const double square = a[0] / (2 * std::sqrt(average));
  const VectorXd relative = -a.tail(d) / (2 * square);
  radius = std::sqrt(relative.squaredNorm() + average);
  centre = mean + relative;
  return std::isfinite(radius) && radius < 1e7 * std::sqrt(average);
}

std::vector<Vector3d> half_sphere(std::size_t count) {
  std::vector<Vector3d> directions;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t k = 0; k < count; ++k) {
    const double z = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    const double turn = golden * static_cast<double>(k), across = std::sqrt(1 - z * z);
    directions.emplace_back(across * std::cos(turn), across * std::sin(turn), z);
  }
  return directions;
}

bool frame_along(ShapeKind kind, const Matrix3d& axes, const Matrix3Xd& points, const FitConstraints& constraints,
                 ShapeFrame& frame) {
  frame = {};
  frame.kind = kind;
  frame.axes = axes;
  const Matrix3Xd q = axes.transpose() * points;
  if (kind != ShapeKind::cone) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [centre, radius] : spheres(q.topRows<2>(), constraints.radius)) {
      ShapeFrame candidate = frame;
      candidate.origin = axes.leftCols<2>() * centre;
      candidate.radius = radius;
      const double score = mean_square(candidate, points);
      if (score < best) {
        best = score;
        frame = candidate;
      }
    }
    return std::isfinite(best);
  }
  // x^2 + y^2 = 2 a x + 2 b y + t^2 z^2 + 2 r t z + (r^2 - a^2 - b^2)
  const double unit = std::max(std::sqrt(q.squaredNorm() / static_cast<double>(q.cols())), 1e-300);
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
  for (Index i = 0; i < q.cols(); ++i) {
    const Vector3d v = q.col(i) / unit;
    Eigen::Matrix<double, 5, 1> row;
    row << 2 * v.x(), 2 * v.y(), v.z() * v.z(), v.z(), 1;
    normal += row * row.transpose();
    right += row * v.head<2>().squaredNorm();
  }
  const Eigen::Matrix<double, 5, 1> c = Ldlt<5>(normal).solve(right);
  const double square = c[4] + c[0] * c[0] + c[1] * c[1];
  if (!c.allFinite() || c.head<2>().norm() > 1e6) return false;
  const double radius = std::sqrt(std::max(square, 1e-6));
  double slope = c[3] / (2 * radius);
  if (square <= 1e-6) slope = std::copysign(std::sqrt(std::max(c[2], 1e-4)), c[3]);
  frame.origin = axes.leftCols<2>() * Vector2d(c[0] * unit, c[1] * unit);
  frame.radius = radius * unit;
  frame.half_angle = constraints.half_angle ? std::copysign(*constraints.half_angle, slope) : std::atan(slope);
  return true;
}

std::vector<ShapeFrame> start_frames(ShapeKind kind, const Survey& survey, const FitConstraints& constraints) {
  ShapeFrame frame;
  frame.kind = kind;
  frame.origin = survey.centroid.mean;
  std::vector<ShapeFrame> starts;
  switch (kind) {
    case ShapeKind::line2: {
      const SymmetricEigen<2> principal(Eigen::Matrix2d(survey.centroid.scatter.topLeftCorner<2, 2>()));
      const Vector2d along = principal.eigenvectors().col(1);
      frame.axes = axes_of_line2(constraints.direction.value_or(Vector3d(along.x(), along.y(), 0)));
      frame.origin.z() = 0;
      return {frame};
    }
    case ShapeKind::line3:
      frame.axes = axes_along(constraints.direction.value_or(survey.directions.col(0)));
      return {frame};
    case ShapeKind::plane:
      frame.axes = axes_along(constraints.direction.value_or(survey.directions.col(2)));
      return {frame};
    case ShapeKind::circle2:
      for (const auto& [centre, radius] : spheres(survey.sample.topRows<2>(), constraints.radius)) {
        frame.origin << centre, 0;
        frame.radius = radius;
        starts.push_back(frame);
      }
      return starts;
    case ShapeKind::circle3: {
      frame.axes = axes_along(constraints.direction.value_or(survey.directions.col(2)));
      const MatrixXd q = frame.axes.leftCols<2>().transpose() * (survey.sample.colwise() - survey.centroid.mean);
      for (const auto& [centre, radius] : spheres(q, constraints.radius)) {
        frame.origin = survey.centroid.mean + frame.axes.leftCols<2>() * centre;
        frame.radius = radius;
        starts.push_back(frame);
      }
      return starts;
    }
    case ShapeKind::sphere:
      for (const auto& [centre, radius] : spheres(survey.sample, constraints.radius)) {
        frame.origin = centre;
        frame.radius = radius;
        starts.push_back(frame);
      }
      return starts;
    case ShapeKind::cylinder:
    case ShapeKind::cone:
      break;
  }
  if (!constraints.direction) return axis_starts(kind, survey, constraints);
  if (frame_along(kind, axes_along(*constraints.direction), survey.sample, constraints, frame)) starts.push_back(frame);
  if (kind == ShapeKind::cone && !starts.empty() && constraints.half_angle) {
    frame.half_angle *= -1;
    starts.push_back(frame);
  }
  return starts;
}

BestStart best_start(ShapeKind kind, const Survey& survey, const FitConstraints& constraints) {
  BestStart best;
  if (is_straight(kind)) {
    // The principal directions of all points are the answer but for rounding; those of the sample are others, from
    // which the way back is long where the extents are nearly the same.
    best.found = true;
    best.frame = start_frames(kind, survey, constraints).front();
    return best;
  }
  const std::vector<int> free = free_parameters(kind, constraints);
  std::vector<Refined> reached;
  for (const ShapeFrame& start : start_frames(kind, survey, constraints)) {
    const Refined refined = refine(start, survey.sample, {}, free, survey.size, 30, 1);
    const bool possible = std::isfinite(refined.sums.squares) && (!has_radius(kind) || refined.frame.radius > 0) &&
                          std::abs(refined.frame.half_angle) < std::numbers::pi / 2;
    if (possible) reached.push_back(refined);
  }
  if (reached.empty()) return best;
  std::stable_sort(reached.begin(), reached.end(),
                   [](const Refined& a, const Refined& b) { return a.sums.squares < b.sums.squares; });
  for (std::size_t k = 0; k < std::min<std::size_t>(reached.size(), 3); ++k) {
    reached[k] = refine(reached[k].frame, survey.sample, {}, free, survey.size, 150, 1);
  }
  std::stable_sort(reached.begin(),
                   reached.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(3, reached.size())),
                   [](const Refined& a, const Refined& b) { return a.sums.squares < b.sums.squares; });
  best.found = true;
  best.frame = reached[0].frame;
  const double rounding = static_cast<double>(survey.sample.cols()) * std::pow(1e-10 * survey.size, 2);
  for (std::size_t k = 1; k < std::min<std::size_t>(reached.size(), 3); ++k) {
    const bool as_good = reached[k].sums.squares <= reached[0].sums.squares * (1 + 1e-5) + rounding;
    if (as_good && reached[k].converged && differ(reached[0].frame, reached[k].frame, survey)) best.rival = true;
  }
  return best;
}

}  // namespace abbe::fits
