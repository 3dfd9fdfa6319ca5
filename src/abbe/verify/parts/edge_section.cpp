#include "abbe/verify/parts/edge_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/dual.h"
#include "abbe/geometry/fits/robust_fit.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {
namespace {

using Eigen::Index;
using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

constexpr double kTukey = 4.685;      // 95 % efficiency for normal noise
constexpr double kEfficiency = 0.95;  // of it
constexpr double kLeastTurn = std::numbers::pi / 4;

enum class Part { surface, rounding, wall };
enum EdgeUnknown { kCornerU, kCornerV, kSlope, kRoundingRadius, kTilt };

/// Signed distance of a point from surface, rounding and wall, positive out of the material.
/// @param normal  set to the direction in which the distance is taken
template <typename T>
T edge_distance(const std::array<T, 5>& q, const Eigen::Vector2d& p, Part* part, Eigen::Vector2d* normal) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  using std::tan;
  const T cos_slope = cos(q[kSlope]), sin_slope = sin(q[kSlope]);
  const T down_u = -sin(q[kTilt]), down_v = -cos(q[kTilt]);
  const T half_turn = (q[kSlope] + q[kTilt]) / T(2) + T(std::numbers::pi / 4);
  const T reach = q[kRoundingRadius] * tan(half_turn);
  const T from_corner_u = T(p.x()) - q[kCornerU], from_corner_v = T(p.y()) - q[kCornerV];
  const T u = from_corner_u + reach * cos_slope - q[kRoundingRadius] * sin_slope;  // from the centre of the rounding
  const T v = from_corner_v + reach * sin_slope + q[kRoundingRadius] * cos_slope;
  const T along_surface = u * cos_slope + v * sin_slope, along_wall = u * down_u + v * down_v;
  const T above = from_corner_v * cos_slope - from_corner_u * sin_slope;
  const T beside = from_corner_v * down_u - from_corner_u * down_v;
  const bool before = value_of(along_surface)<0, below = value_of(along_wall)> 0;
  const auto take = [&](Part where, const T& n_u, const T& n_v) {
    *part = where;
    *normal = {value_of(n_u), value_of(n_v)};
  };
  if (before && (!below || std::abs(value_of(above)) < std::abs(value_of(beside)))) {
    take(Part::surface, -sin_slope, cos_slope);
    return above;
  }
  if (below) {
    take(Part::wall, -down_v, down_u);
    return beside;
  }
  const T length = sqrt(u * u + v * v);
  if (value_of(length) < 1e-12) {  // at the centre: any direction
    take(Part::surface, -sin_slope, cos_slope);
    return above;
  }
  take(Part::rounding, u / length, v / length);
  return length - q[kRoundingRadius];
}

/// All points at one set of unknowns.
struct Sums {
  Matrix5 normal = Matrix5::Zero();
  Vector5 right = Vector5::Zero();
  double cost = 0;
};

class EdgeProblem {
 public:
  /// @param bottom  points of the bottom, which lie beside the wall
  EdgeProblem(std::vector<Eigen::Vector2d> points, std::vector<Eigen::Vector2d> bottom, const EdgeOptions& options)
      : points_(std::move(points)), bottom_(std::move(bottom)), options_(options) {}

  bool noise_is_known() const { return options_.across_noise > 0 || options_.height_noise > 0; }

  /// Standard uncertainty of a distance in that direction; 1 if it is not known.
  double uncertainty(const Eigen::Vector2d& normal) const {
    if (!noise_is_known()) return 1;
    const double least = 0.1 * std::max(options_.across_noise, options_.height_noise);
    return std::max(least, std::hypot(normal.x() * options_.across_noise, normal.y() * options_.height_noise));
  }

  std::vector<double> residuals(const Vector5& x) const {
    std::vector<double> result;
    Part part = Part::surface;
    Eigen::Vector2d normal;
    for (const Eigen::Vector2d& p : points_) {
      const double d = edge_distance(numbers(x), p, &part, &normal);
      result.push_back(d / uncertainty(normal));
    }
    return result;
  }

  double scale(const Vector5& x) const {
    std::vector<double> amounts = residuals(x);
    for (double& a : amounts) a = std::abs(a);
    const double found = 1.4826 * percentile(amounts, 0.5);
    return noise_is_known() ? std::max(1.0, found) : std::max(found, 1e-9);
  }

  /// Standard uncertainties of the points' distances. They turn with the curve, and are held while it is fitted: else
  /// it would lean to where points count for less.
  std::vector<double> uncertainties(const Vector5& x) const {
    std::vector<double> result;
    Part part = Part::surface;
    Eigen::Vector2d normal;
    for (const Eigen::Vector2d& p : points_) {
      edge_distance(numbers(x), p, &part, &normal);
      result.push_back(uncertainty(normal));
    }
    return result;
  }

  /// @param held      [points] their standard uncertainties
  /// @param weighted  Tukey's weights; else 0 or 1 by the same bound, for the covariance
  Sums sums(const Vector5& x, const std::vector<double>& held, double scale, bool free_radius, bool weighted) const {
    Sums result;
    std::array<Dual<5>, 5> q;
    for (int k = 0; k < 5; ++k) {
      const bool free = k == kTilt ? options_.free_wall : k != kRoundingRadius || free_radius;
      q[static_cast<std::size_t>(k)] = free ? Dual<5>::variable(x[k], k) : Dual<5>(x[k]);
    }
    Part part = Part::surface;
    Eigen::Vector2d normal;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Dual<5> d = edge_distance(q, points_[i], &part, &normal);
      const double u = held[i], e = d.value / u, t = e / (kTukey * scale);
      const double inside = 1 - t * t;
      result.cost += inside > 0 ? 1 - inside * inside * inside : 1;
      if (inside <= 0) continue;
      Vector5 row;
      for (int k = 0; k < 5; ++k) row[k] = d.slope[static_cast<std::size_t>(k)] / u;
      const double weight = weighted ? inside * inside : 1;
      result.normal += weight * row * row.transpose();
      result.right -= weight * e * row;
    }
    add_bottom(x, scale, weighted, result);
    // What is held does not move.
    for (int k = 0; k < 5; ++k) {
      const bool free = k == kTilt ? options_.free_wall : k != kRoundingRadius || free_radius;
      if (!free) result.normal(k, k) = 1;
    }
    return result;
  }

  /// From a bound so wide that no point of the rounding is taken for a stray one, to that of the points' own scatter.
  /// @returns whether it came to rest
  bool solve(Vector5& x, double& scale_used) const {
    const double unit = noise_is_known() ? std::max(options_.across_noise, options_.height_noise) : 1;
    scale_used = std::max(scale(x), x[kRoundingRadius] / (4 * unit));
    double moved = HUGE_VAL;
    for (int stage = 0; stage < 60; ++stage) {
      const Vector5 before = x;
      if (!solve_at(x, uncertainties(x), scale_used)) return false;
      moved = (x - before).cwiseAbs().maxCoeff();
      const double own = scale(x);
      if (std::abs(own - scale_used) <= 1e-4 * scale_used && moved < 1e-9) return true;
      scale_used = std::max(own, scale_used / 2);
    }
    return moved < 1e-5;  // a point changes between two parts of the curve
  }

  /// Sum of losses with the same uncertainty for all points: compares curves. @param bound  mm
  double cost(const Vector5& x, double bound) const {
    const double unit = noise_is_known() ? std::max(options_.across_noise, options_.height_noise) : 1;
    const double scale = bound / unit;
    return sums(x, std::vector<double>(points_.size(), unit), scale, true, true).cost;
  }

  const std::vector<Eigen::Vector2d>& points() const { return points_; }
  static std::array<double, 5> numbers(const Vector5& x) { return {x[0], x[1], x[2], x[3], x[4]}; }

 private:
  /// The wall does not stand where the bottom is seen: a point of the bottom at u has the likelihood of an error that
  /// leaves it to the right of the wall. That is what the bottom says of a wall that no ray meets; a shadow beside the
  /// wall says nothing wrong.
  void add_bottom(const Vector5& x, double scale, bool weighted, Sums& sums) const {
    const double tan_tilt = std::tan(x[kTilt]), noise = uncertainty({1, 0}) * (noise_is_known() ? 1 : scale);
    for (const Eigen::Vector2d& p : bottom_) {
      const double z = std::max((p.x() - (x[kCornerU] - (x[kCornerV] - p.y()) * tan_tilt)) / noise, -30.0);
      if (z > 6) continue;
      const double below = std::erfc(-z / std::numbers::sqrt2) / 2;  // the normal distribution
      const double g = std::sqrt(-2 * std::log(below));
      const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
      const double unit = noise_is_known() ? 1 : scale, e = g * unit, t = e / (kTukey * scale);
      const double inside = 1 - t * t;
      sums.cost += inside > 0 ? 1 - inside * inside * inside : 1;
      if (inside <= 0) continue;
      const double slope = density / (below * g) * unit / noise;  // by the wall's u
      Vector5 row = Vector5::Zero();
      row[kCornerU] = slope;
      row[kCornerV] = -slope * tan_tilt;
      if (options_.free_wall) row[kTilt] = -slope * (x[kCornerV] - p.y()) * (1 + tan_tilt * tan_tilt);
      const double weight = weighted ? inside * inside : 1;
      sums.normal += weight * row * row.transpose();
      sums.right -= weight * e * row;
    }
  }

  /// Damped Gauss-Newton steps with the weights of one bound.
  bool solve_at(Vector5& x, const std::vector<double>& held, double scale) const {
    double damping = 1e-3;
    for (int iteration = 0; iteration < 100; ++iteration) {
      const Sums here = sums(x, held, scale, true, true);
      for (;;) {
        Matrix5 damped = here.normal;
        damped.diagonal() += damping * here.normal.diagonal();
        damped.diagonal().array() += 1e-12;
        Vector5 next = x + Ldlt<5>(damped).solve(here.right);
        if (!next.allFinite()) return false;
        next[kSlope] = std::clamp(next[kSlope], -0.5, 0.5);
        next[kTilt] = std::clamp(next[kTilt], -0.7, 0.7);
        // Where no point lies on the rounding nothing says how to go on: the radius shrinks step by step.
        next[kRoundingRadius] = std::max(next[kRoundingRadius], x[kRoundingRadius] / 2);
        if (sums(next, held, scale, true, true).cost <= here.cost) {
          const double moved = (next - x).cwiseAbs().maxCoeff();
          x = next;
          damping *= 0.1;
          if (moved < 1e-11) return true;
          break;
        }
        damping = std::max(10 * damping, 1e-6);
        if (damping > 1e12) return true;  // no step helps: the lowest place to rounding
      }
    }
    return false;
  }

  std::vector<Eigen::Vector2d> points_, bottom_;
  EdgeOptions options_;
};

EdgeFit refused(EdgeStatus status, std::string reason) {
  EdgeFit fit;
  fit.status = status;
  fit.reason = std::move(reason);
  return fit;
}

/// Points of one edge, with the surface on the left and straightened, and where the edge about is.
struct Start {
  std::vector<Eigen::Vector2d> points, bottom;
  Vector5 unknowns = Vector5::Zero();
  double smallest = 0, largest = 0;  // mm, of the radius
  double bound = 0;                  // mm, how far a point of the right curve may about be from it
};

std::optional<EdgeFit> find_start(std::vector<Eigen::Vector2d> points, const EdgeOptions& options, Start& start) {
  if (points.size() < 20) return refused(EdgeStatus::too_few_points, "fewer than 20 points");
  if (points.front().x() > points.back().x()) std::reverse(points.begin(), points.end());
  double from = points.front().x(), to = from;
  for (const Eigen::Vector2d& p : points) {
    from = std::min(from, p.x());
    to = std::max(to, p.x());
  }
  const double extent = to - from;
  std::size_t outer = 0;
  while (outer < points.size() && points[outer].x() < from + extent / 4) ++outer;
  outer = std::clamp<std::size_t>(outer, 8, points.size());
  Eigen::Matrix3Xd surface(3, static_cast<Index>(outer));
  for (std::size_t i = 0; i < outer; ++i) surface.col(static_cast<Index>(i)) << points[i], 0;
  const ShapeFit line = robust_fit(ShapeKind::line2, surface);
  if (!line.ok())
    return refused(EdgeStatus::no_surface, "the outer quarter of the section is not a line: " + line.reason);
  Eigen::Vector2d along = line.shape.direction.head<2>();
  if (along.x() < 0) along = -along;
  if (!(along.x() > 0.87)) {
    return refused(EdgeStatus::no_surface, "the outer quarter of the section is inclined by more than 30 degrees");
  }
  const double slope = along.y() / along.x();
  const auto height = [&](const Eigen::Vector2d& p) {
    return p.y() - line.shape.point.y() - slope * (p.x() - line.shape.point.x());
  };
  std::vector<double> heights, amounts;
  for (const Eigen::Vector2d& p : points) heights.push_back(height(p));
  for (std::size_t i = 0; i < outer; ++i) amounts.push_back(std::abs(heights[i]));
  const double scatter = std::max({1.4826 * percentile(amounts, 0.5), options.height_noise, 1e-9});
  const double depth = -percentile(heights, 0.05);
  if (!(depth > 8 * scatter)) {
    return refused(EdgeStatus::no_edge, "nothing is deeper than eight times the scatter of the surface");
  }
  // Three in a row, so that a stray point is no edge.
  const auto first_below = [&](double level) {
    for (std::size_t i = outer; i + 2 < heights.size(); ++i) {
      if (heights[i] < level && heights[i + 1] < level && heights[i + 2] < level) return i;
    }
    return heights.size();
  };
  const std::size_t half = first_below(-depth / 2), deep = first_below(-0.75 * depth);
  if (half == heights.size()) return refused(EdgeStatus::no_edge, "no three points in a row below half of the depth");
  std::size_t last_high = half - 1;
  while (last_high > 0 && heights[last_high] < -depth / 2) --last_high;
  const double edge = points[last_high].x();
  start.smallest = 2 * extent / static_cast<double>(points.size());
  start.largest = std::max(depth, 2 * start.smallest);
  start.bound = std::max(3 * scatter, 0.02 * depth);
  start.unknowns << edge, line.shape.point.y() + slope * (edge - line.shape.point.x()), std::atan(slope),
      start.smallest, options.beam_tilt;
  // Up to the other side of a groove; debris in the wall's shadow is none.
  for (std::size_t i = deep; i < points.size() && heights[i] < -0.75 * depth; ++i) start.bottom.push_back(points[i]);
  points.resize(deep);
  start.points = std::move(points);
  return std::nullopt;
}

EdgeAsPrinted as_printed(const EdgeProblem& problem, const Vector5& x) {
  std::vector<Eigen::Vector2d> arc;
  Part part = Part::surface;
  Eigen::Vector2d normal;
  for (const Eigen::Vector2d& p : problem.points()) {
    edge_distance(EdgeProblem::numbers(x), p, &part, &normal);
    if (part == Part::rounding) arc.push_back(p);
  }
  EdgeAsPrinted printed;
  if (arc.size() < 4) return printed;
  Eigen::Matrix3Xd points(3, static_cast<Index>(arc.size()));
  for (std::size_t i = 0; i < arc.size(); ++i) points.col(static_cast<Index>(i)) << arc[i], 0;
  const ShapeFit circle = least_squares_fit(ShapeKind::circle2, points);
  if (!circle.ok()) return printed;
  printed.radius = circle.shape.radius;
  const Eigen::Vector2d along(std::cos(x[kSlope]), std::sin(x[kSlope])), out(-along.y(), along.x());
  const Eigen::Vector2d corner(x[kCornerU], x[kCornerV]), centre = circle.shape.point.head<2>();
  const double above = out.dot(centre - corner), square = printed.radius * printed.radius - above * above;
  if (!(square >= 0)) return printed;
  const Eigen::Vector2d p1 = centre - above * out - std::sqrt(square) * along;
  // Its tangent there, to the line of the laser through the corner.
  const Eigen::Vector2d radial = p1 - centre, tangent(radial.y(), -radial.x());
  const Eigen::Vector2d down(-std::sin(x[kTilt]), -std::cos(x[kTilt])), beside(-down.y(), down.x());
  const double closing = beside.dot(tangent);
  if (!(std::abs(closing) > 1e-6 * tangent.norm())) return printed;
  printed.circle_meets_surface = true;
  printed.distance = std::abs(beside.dot(corner - p1) / closing) * tangent.norm();
  return printed;
}

}  // namespace

double EdgeFit::corner_uncertainty() const { return std::sqrt(std::max(0.0, covariance(0, 0))); }

EdgeFit fit_edge(const Eigen::Ref<const Eigen::Matrix2Xd>& points, const EdgeOptions& given) {
  const double mirror = given.surface == EdgeSide::left ? 1 : -1;
  EdgeOptions options = given;
  options.beam_tilt *= mirror;
  std::vector<Eigen::Vector2d> straight;
  for (Index i = 0; i < points.cols(); ++i) {
    const double u = points(0, i);
    const Eigen::Vector2d p(mirror * u, points(1, i) + options.surface_curvature * u * u / 2);
    if (!p.allFinite()) return refused(EdgeStatus::not_finite, "coordinates that are not finite");
    straight.push_back(p);
  }
  Start start;
  if (const std::optional<EdgeFit> stop = find_start(std::move(straight), options, start)) return *stop;
  const EdgeProblem problem(start.points, start.bottom, options);
  // The two radii that suit the points best as they are lead the way.
  std::vector<std::pair<double, double>> radii;  // cost, radius
  for (double radius = start.smallest; radius <= start.largest && radii.size() < 60; radius *= 1.6) {
    Vector5 x = start.unknowns;
    x[kRoundingRadius] = radius;
    radii.emplace_back(problem.cost(x, start.bound), radius);
  }
  std::sort(radii.begin(), radii.end());
  Vector5 best = start.unknowns;
  double scale = 0;
  bool found = false;
  for (std::size_t k = 0; k < std::min<std::size_t>(radii.size(), 2); ++k) {
    Vector5 x = start.unknowns;
    x[kRoundingRadius] = radii[k].second;
    double its_scale = 0;
    if (!problem.solve(x, its_scale)) continue;
    // Compared by one bound: with its own each would praise itself.
    if (found && !(problem.cost(x, start.bound) < problem.cost(best, start.bound))) continue;
    best = x;
    scale = its_scale;
    found = true;
  }
  if (!found) return refused(EdgeStatus::not_converged, "the fit of the corner of the section did not converge");

  EdgeFit fit;
  Part part = Part::surface;
  Eigen::Vector2d normal;
  double used = 0, squares = 0;
  for (const Eigen::Vector2d& p : problem.points()) {
    const double d = edge_distance(EdgeProblem::numbers(best), p, &part, &normal);
    if (std::abs(d / problem.uncertainty(normal)) > kTukey * scale) {
      ++fit.rejected;
      continue;
    }
    used += 1;
    squares += d * d;
    if (part == Part::surface) ++fit.on_surface;
    if (part == Part::wall) ++fit.on_wall;
    if (part != Part::rounding) continue;
    ++fit.on_rounding;
    const Eigen::Vector2d out(-std::sin(best[kSlope]), std::cos(best[kSlope]));
    fit.turn_seen = std::max(fit.turn_seen, std::acos(std::clamp(out.dot(normal), -1.0, 1.0)));
  }
  const double turn = std::numbers::pi / 2 + best[kSlope] + best[kTilt];
  if (fit.on_wall >= 3) fit.turn_seen = turn;
  const bool round = fit.on_rounding >= 4 && best[kRoundingRadius] > 0;
  if (!round && fit.on_wall < 3) {
    return refused(EdgeStatus::undetermined, "neither the wall nor four points of the rounding are seen");
  }
  if (fit.on_wall < 3 && fit.turn_seen < kLeastTurn) {
    return refused(EdgeStatus::undetermined, "the wall is not seen, and of the rounding less than 45 degrees");
  }
  const double unknowns = 3 + (round ? 1 : 0) + (options.free_wall ? 1 : 0);
  if (!(used > unknowns)) {
    return refused(EdgeStatus::undetermined, "no more points on the curve than it has unknowns");
  }
  // A sharp edge has no radius to be uncertain of: fewer than four points say nothing of it.
  const Matrix5 information = problem.sums(best, problem.uncertainties(best), scale, round, false).normal;
  const Eigen::Matrix<double, 5, 1> size = information.diagonal().cwiseSqrt().cwiseMax(1e-300);
  const Matrix5 scaled = size.cwiseInverse().asDiagonal() * information * size.cwiseInverse().asDiagonal();
  const SymmetricEigen<5> eigen(scaled);
  if (!(eigen.eigenvalues()[0] > 1e-9)) {
    return refused(EdgeStatus::undetermined, "the points do not separate corner, radius and wall");
  }
  const double variance = problem.noise_is_known() ? scale * scale : squares / (used - unknowns);
  fit.covariance = size.cwiseInverse().asDiagonal() * scaled.inverse() * size.cwiseInverse().asDiagonal();
  fit.covariance *= variance / kEfficiency;
  for (const int k : {static_cast<int>(kRoundingRadius), static_cast<int>(kTilt)}) {
    if (k == kRoundingRadius ? round : options.free_wall) continue;
    fit.covariance.row(k).setZero();
    fit.covariance.col(k).setZero();
  }
  const double tangent = std::tan(turn / 2);
  Vector5 slope = Vector5::Zero();  // of r tan(turn / 2)
  slope[kRoundingRadius] = tangent;
  slope[kSlope] = slope[kTilt] = best[kRoundingRadius] * (1 + tangent * tangent) / 2;
  fit.status = EdgeStatus::ok;
  fit.rounding = best[kRoundingRadius] * tangent;
  fit.rounding_uncertainty = std::sqrt(std::max(0.0, slope.dot(fit.covariance * slope)));
  fit.noise = std::sqrt(squares / used);
  fit.printed = as_printed(problem, best);
  fit.radius = best[kRoundingRadius];
  fit.surface_slope = mirror * (best[kSlope] - options.surface_curvature * best[kCornerU]);
  fit.wall_tilt = mirror * best[kTilt];
  const auto place = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(mirror * p.x(), p.y() - options.surface_curvature * p.x() * p.x() / 2);
  };
  const Eigen::Vector2d corner(best[kCornerU], best[kCornerV]);
  fit.corner = place(corner);
  fit.onset = place(corner - fit.rounding * Eigen::Vector2d(std::cos(best[kSlope]), std::sin(best[kSlope])));
  for (const int k : {static_cast<int>(kCornerU), static_cast<int>(kSlope), static_cast<int>(kTilt)}) {
    fit.covariance.row(k) *= mirror;
    fit.covariance.col(k) *= mirror;
  }
  return fit;
}

GrooveFit fit_groove(const Eigen::Ref<const Eigen::Matrix2Xd>& points, EdgeOptions options) {
  GrooveFit groove;
  options.surface = EdgeSide::left;
  groove.left = fit_edge(points, options);
  options.surface = EdgeSide::right;
  groove.right = fit_edge(points, options);
  if (!groove.ok()) return groove;
  groove.middle = (groove.left.corner.x() + groove.right.corner.x()) / 2;
  groove.width = groove.right.corner.x() - groove.left.corner.x();
  groove.middle_uncertainty = std::hypot(groove.left.corner_uncertainty(), groove.right.corner_uncertainty()) / 2;
  return groove;
}

}  // namespace abbe
