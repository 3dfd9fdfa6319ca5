#include "abbe/geometry/fits/simulated_fits_for_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/fits/extended_fit_for_test.h"

namespace abbe::test {

std::string words(const SimulatedSet& set, const ShapeFit& fit) {
  return std::string(shape_name(set.truth.kind)) + " of " + std::to_string(set.count()) + " points, size " +
         std::to_string(set.size) + " mm, noise " + std::to_string(1e3 * set.noise) + " um, far " +
         std::to_string(set.far) + " mm, uncertainty " + std::to_string(set.uncertainty) + ": " +
         fit_status_name(fit.status) + " " + fit.reason;
}

double rounding_of(const SimulatedSet& set) { return 2e-15 * (set.far + set.size + set.truth.radius); }

Eigen::VectorXd distances_from(const Shape& shape, const Eigen::Matrix3Xd& points) {
  Eigen::VectorXd d(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) d[i] = distance(shape, points.col(i));
  return d;
}

namespace {

/// Motions of a shape, as changes of its plain data by a step of 1 (lengths: of `unit` mm).
std::vector<ExtendedShape> motions(const Shape& shape, double unit) {
  const ShapeKind kind = shape.kind;
  const Eigen::Vector3d d = shape.direction;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  if (kind == ShapeKind::line2) {
    axes << d, Eigen::Vector3d(-d.y(), d.x(), 0), Eigen::Vector3d::UnitZ();
  } else if (kind != ShapeKind::sphere && kind != ShapeKind::circle2) {
    axes << d.unitOrthogonal(), d.cross(d.unitOrthogonal()), d;
  }
  std::vector<ExtendedShape> all;
  const auto add = [&](int from, int axis) {
    all.emplace_back(ExtendedShape::Zero());
    all.back().segment<3>(from) = (from == 0 ? unit : 1) * axes.col(axis).cast<Extended>();
  };
  const bool across = kind != ShapeKind::plane && kind != ShapeKind::line2;
  if (across) add(0, 0);
  if (across || kind == ShapeKind::line2) add(0, 1);
  if (kind == ShapeKind::plane || kind == ShapeKind::circle3 || kind == ShapeKind::sphere) add(0, 2);
  if (kind == ShapeKind::line2) {
    add(3, 1);
  } else if (kind != ShapeKind::circle2 && kind != ShapeKind::sphere) {
    add(3, 0);
    add(3, 1);
  }
  if (kind >= ShapeKind::circle2) all.push_back(unit * ExtendedShape::Unit(6));
  if (kind == ShapeKind::cone) all.push_back(ExtendedShape::Unit(7));
  return all;
}

/// Residuals of all points and their derivatives by the motions of a shape, by differences in extended precision of the
/// plain distance.
struct ResidualsAndSlopes {
  ExtendedVector residuals;  ///< [3 points]
  ExtendedMatrix slopes;     ///< [3 points, motions]
};
ResidualsAndSlopes residuals_and_slopes(const Shape& shape, const Eigen::Matrix3Xd& points, double size) {
  const ExtendedPoints data(points);
  const auto residuals = [&](ExtendedShape s) {
    ExtendedVector all(3 * data.points.cols());
    for (Eigen::Index i = 0; i < data.points.cols(); ++i) {
      if (shape.kind == ShapeKind::line2) {
        const ExtendedVector q = data.points.col(i) - s.head<3>(), d = s.segment<3>(3).normalized();
        all.segment<3>(3 * i) = Extended3(d[0] * q[1] - d[1] * q[0], 0, 0);
      } else {
        all.segment<3>(3 * i) = extended_residuals(shape.kind, s, data.points.col(i));
      }
    }
    return all;
  };
  const ExtendedShape at = data.from(shape);
  const std::vector<ExtendedShape> ways = motions(shape, size);
  ResidualsAndSlopes result;
  result.residuals = residuals(at);
  result.slopes.resize(result.residuals.size(), static_cast<Eigen::Index>(ways.size()));
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const Extended h = 1e-5L;
    const auto value = [&](int steps) { return residuals(at + static_cast<Extended>(steps) * h * ways[k]); };
    result.slopes.col(static_cast<Eigen::Index>(k)) = (8 * (value(1) - value(-1)) - (value(2) - value(-2))) / (12 * h);
  }
  return result;
}

/// The Gauss-Newton step that is left: by how much it changes the weighted residuals, root of the sum of squares, mm.
/// Against their scatter this is the step in standard uncertainties of the parameters.
/// @param weights  [points] or empty
double step_left(const Shape& shape, const SimulatedSet& set, const std::vector<double>& weights = {}) {
  ResidualsAndSlopes r = residuals_and_slopes(shape, set.points, set.size);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto from = static_cast<Eigen::Index>(3 * i);
    const Extended w = std::sqrt(static_cast<Extended>(weights[i]));
    r.residuals.segment<3>(from) *= w;
    r.slopes.middleRows<3>(from) *= w;
  }
  const Eigen::MatrixXd slopes = r.slopes.cast<double>();
  return (slopes * PivotedQr(slopes).solve(r.residuals.cast<double>())).norm();
}

/// Whether the points lie around the true circle, sphere or cylinder so that it has a largest inscribed neighbour: zero
/// within the hull of the gradients of their distances (Kolmogorov's criterion), away from its border by more than
/// noise and curvature could undo. Every facet of the hull is tried.
bool surrounds(const SimulatedSet& set) {
  const Eigen::Index d = set.slopes.cols() - 1, n = set.slopes.rows();
  Eigen::MatrixXd g = set.slopes.leftCols(d).transpose();
  for (Eigen::Index k = 0; k < d; ++k) g.row(k) /= g.row(k).cwiseAbs().maxCoeff();
  double margin = std::numeric_limits<double>::infinity();
  std::vector<Eigen::Index> corners(static_cast<std::size_t>(d));
  const auto corner = [&](Eigen::Index k) -> Eigen::Index& { return corners[static_cast<std::size_t>(k)]; };
  std::iota(corners.begin(), corners.end(), 0);
  for (Eigen::Index last = d; last >= 0;) {
    Eigen::MatrixXd edges(d - 1, d);
    for (Eigen::Index k = 1; k < d; ++k) edges.row(k - 1) = (g.col(corner(k)) - g.col(corner(0))).transpose();
    const Eigen::VectorXd normal = FullLu<>(edges).kernel().col(0).normalized();
    const double offset = g.col(corner(0)).dot(normal);
    const Eigen::VectorXd side = (g.transpose() * normal).array() - offset;
    if (side.maxCoeff() < 1e-12) margin = std::min(margin, offset);
    if (side.minCoeff() > -1e-12) margin = std::min(margin, -offset);
    // The next combination of corners.
    for (last = d - 1; last >= 0 && corner(last) == n - d + last; --last) {
    }
    if (last < 0) break;
    ++corner(last);
    for (Eigen::Index k = last + 1; k < d; ++k) corner(k) = corner(k - 1) + 1;
  }
  // A step t beside the radius R takes margin t from the smallest distance, and its curvature gives t^2 / 2R back: the
  // most that is taken, margin^2 R / 2, has to be more than the six standard deviations between the points.
  return margin > 0 && set.noise < margin * margin * set.truth.radius / 12;
}

/// Least squares: an answer; stationary; no more squares than the truth leaves.
void judge_least_squares(const SimulatedSet& set, const ShapeFit& fit) {
  ASSERT_EQ(fit.status, FitStatus::ok) << words(set, fit);
  const double n = static_cast<double>(set.count()), rounding = rounding_of(set) * std::sqrt(n);
  const double found = distances_from(fit.shape, set.points).norm();
  const double at_truth = distances_from(set.truth, set.points).norm();
  EXPECT_LE(found, at_truth * (1 + 1e-9) + rounding) << words(set, fit);
  EXPECT_LE(step_left(fit.shape, set), 1e-5 * found + rounding) << words(set, fit);
}

/// Kolmogorov's criterion with the contacts' multipliers: the gradients of their distances, by differences of the plain
/// distance, combine to zero, and no point is farther out.
void judge_extreme(ExtremeKind extreme, const SimulatedSet& set, const ShapeFit& fit) {
  // By chance two inscribed shapes at different places may be as large as each other.
  if (extreme == ExtremeKind::inscribed && fit.status == FitStatus::ambiguous && !fit.rivals.empty()) {
    EXPECT_NEAR(fit.rivals[0].shape.radius, fit.shape.radius, 2e-5 * fit.shape.radius) << words(set, fit);
    return;
  }
  ASSERT_EQ(fit.status, FitStatus::ok) << words(set, fit);
  const double rounding = 10 * rounding_of(set);
  const bool zone = extreme == ExtremeKind::minimum_zone;
  const bool tube = set.truth.kind == ShapeKind::line3 || set.truth.kind == ShapeKind::circle3;
  const Eigen::VectorXd d = distances_from(fit.shape, set.points), t = distances_from(set.truth, set.points);
  if (zone) {
    EXPECT_NEAR(fit.form, tube ? 2 * d.maxCoeff() : d.maxCoeff() - d.minCoeff(), rounding) << words(set, fit);
    EXPECT_LE(fit.form, 2 * t.cwiseAbs().maxCoeff() + rounding) << words(set, fit);
  } else if (extreme == ExtremeKind::circumscribed) {
    EXPECT_LE(d.maxCoeff(), rounding) << words(set, fit);
    EXPECT_LE(fit.shape.radius, set.truth.radius + t.maxCoeff() + rounding) << words(set, fit);
  } else {
    EXPECT_GE(d.minCoeff(), -rounding) << words(set, fit);
    EXPECT_GE(fit.shape.radius, set.truth.radius + t.minCoeff() - rounding) << words(set, fit);
  }
  // Points on the shape to rounding have no contacts.
  if (zone && fit.contacts.empty()) {
    EXPECT_LE(fit.form, 1e-12 * 3 * set.size + rounding) << words(set, fit);
    return;
  }
  const ResidualsAndSlopes r = residuals_and_slopes(fit.shape, set.points, set.size);
  ExtendedVector sum = ExtendedVector::Zero(r.slopes.cols());
  ExtendedVector largest = sum;
  double multipliers = 0;
  for (std::size_t k = 0; k < fit.contacts.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(fit.contacts[k]);
    EXPECT_NEAR(std::abs(d[i]), zone ? fit.form / 2 : 0, rounding) << words(set, fit);
    EXPECT_GE(fit.multipliers[k], -1e-9) << words(set, fit);
    multipliers += fit.multipliers[k];
    ExtendedVector gradient = r.slopes.middleRows<3>(3 * i).transpose() * r.residuals.segment<3>(3 * i);
    gradient /= std::max(r.residuals.segment<3>(3 * i).norm(), 1e-300L);
    // Of a circumscribed or inscribed shape the contacts are on it: the first residual is its distance.
    if (!zone) gradient = r.slopes.row(3 * i).transpose();
    sum += static_cast<Extended>(fit.multipliers[k]) * gradient;
    largest = largest.cwiseMax(gradient.cwiseAbs());
  }
  EXPECT_NEAR(multipliers, 1, 1e-9) << words(set, fit);
  // The radius of circumscribed and inscribed shapes is what is made extreme.
  if (!zone) sum[r.slopes.cols() - 1] = 0;
  // A contact's distance is known to rounding, and with it the side on which it is.
  const double side = zone ? rounding / (fit.form / 2) : rounding / set.size;
  for (Eigen::Index k = 0; k < sum.size(); ++k) {
    EXPECT_LE(static_cast<double>(std::abs(sum[k])), (1e-6 + side) * static_cast<double>(largest[k]))
        << words(set, fit) << ", motion " << k;
  }
}

/// The sets of a shape that determine it to `uncertainty`. @param closed  all around
template <class Judge>
void for_each_set(ShapeKind kind, int count, std::uint64_t seed, double uncertainty, bool closed, const Judge& judge) {
  Numbers numbers(seed);
  int determined = 0;
  for (int k = 0; k < count; ++k) {
    const SimulatedSet set = simulated_set(kind, numbers, closed);
    if (set.uncertainty > uncertainty || (closed && !surrounds(set))) continue;
    ++determined;
    judge(set);
  }
  EXPECT_GT(determined, count / 2) << shape_name(kind);
}

}  // namespace

void judge_robust(const SimulatedSet& set, const ShapeFit& fit) {
  ASSERT_EQ(fit.status, FitStatus::ok) << words(set, fit);
  const double n = static_cast<double>(set.count()), rounding = 10 * rounding_of(set) * std::sqrt(n);
  const Eigen::VectorXd d = distances_from(fit.shape, set.points);
  EXPECT_LE(step_left(fit.shape, set, fit.weights), 1e-5 * d.norm() + rounding) << words(set, fit);
}

void simulate_least_squares(int count, std::uint64_t seed) {
  for (const ShapeKind kind : all_kinds()) {
    for_each_set(kind, count, seed, kDetermined, false,
                 [kind](const SimulatedSet& set) { judge_least_squares(set, least_squares_fit(kind, set.points)); });
  }
}

void simulate_extreme(ExtremeKind extreme, int count, std::uint64_t seed) {
  for (const ShapeKind kind : all_kinds()) {
    const bool round = kind == ShapeKind::circle2 || kind == ShapeKind::sphere || kind == ShapeKind::cylinder;
    if (extreme != ExtremeKind::minimum_zone && !round) continue;
    for_each_set(kind, count, seed, kDetermined, extreme == ExtremeKind::inscribed,
                 [&](const SimulatedSet& set) { judge_extreme(extreme, set, extreme_fit(kind, extreme, set.points)); });
  }
}

void simulate_robust(int count, std::uint64_t seed) {
  for (const ShapeKind kind : all_kinds()) {
    for_each_set(kind, count, seed, kDetermined / 2, false,
                 [kind](const SimulatedSet& set) { judge_robust(set, robust_fit(kind, set.points)); });
  }
}

}  // namespace abbe::test
