#include "abbe/geometry/fits/extreme_fit.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/fits/shape_points_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::Numbers;
using test::Patch;
using test::PatchOptions;

constexpr double kZone = 0.01;  // half the width, mm

struct KnownZone {
  Shape shape;
  Matrix3Xd points;
};

/// Points within +-kZone of a shape that touch both sides in a pattern whose gradients combine to zero: the shape is
/// the minimum zone shape. Around circles + - + - at quarter turns, for cylinder and cone at several heights; on a
/// sphere + at the ends of the axes, - at the corners of a cube; on a plane at the corners of a square; on a line
/// + - +.
KnownZone known_zone(ShapeKind kind, double far, Numbers& numbers) {
  PatchOptions options;
  options.far = far;
  options.points = 200;
  const Patch patch = test::patch(kind, options, numbers);
  KnownZone known;
  known.shape = patch.shape;
  std::vector<Vector3d> all;
  for (Index i = 0; i < patch.feet.cols(); ++i) {
    const double r = 0.9 * kZone * std::sqrt(numbers.uniform(0, 0.5));
    all.emplace_back(patch.feet.col(i) + r * (numbers.uniform(-1, 1) * patch.normals.col(i) +
                                              numbers.uniform(-1, 1) * patch.second.col(i)));
  }
  const Vector3d d = patch.shape.direction;
  Vector3d u = Vector3d::UnitX(), v = Vector3d::UnitY();
  if (kind == ShapeKind::line2) {
    u = Vector3d(-d.y(), d.x(), 0);
  } else if (kind != ShapeKind::circle2 && kind != ShapeKind::sphere) {
    u = d.unitOrthogonal();
    v = d.cross(u);
  }
  const Vector3d o = patch.shape.point;
  const double radius = options.radius, half_angle = options.half_angle;
  if (kind == ShapeKind::line2) {
    for (const int k : {-1, 0, 1}) all.push_back(o + 30 * k * d + (k == 0 ? -kZone : kZone) * u);
  } else if (kind == ShapeKind::plane) {
    for (int k = 0; k < 4; ++k) {
      const double a = k % 2 == 0 ? 25 : -25, b = k < 2 ? 25 : -25;
      all.push_back(o + a * u + b * v + (a * b > 0 ? kZone : -kZone) * d);
    }
  } else if (kind == ShapeKind::sphere) {
    for (int k = 0; k < 3; ++k) {
      all.push_back(o + (radius + kZone) * Vector3d::Unit(k));
      all.push_back(o - (radius + kZone) * Vector3d::Unit(k));
    }
    for (int k = 0; k < 8; ++k) {
      const Vector3d corner((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1);
      all.push_back(o + (radius - kZone) * corner.normalized());
    }
  } else if (kind == ShapeKind::line3) {
    for (const double z : {-20., 20.}) {
      for (int k = 0; k < 3; ++k) {
        const double t = 2.0 * k * std::numbers::pi / 3;
        all.push_back(o + z * d + kZone * (std::cos(t) * u + std::sin(t) * v));
      }
    }
  } else {
    const bool flat = kind == ShapeKind::circle2 || kind == ShapeKind::circle3;
    for (const double z : flat ? std::vector<double>{0} : std::vector<double>{-20, 0, 20}) {
      for (int k = 0; k < 4; ++k) {
        const double t = k * std::numbers::pi / 2, h = k % 2 == 0 ? kZone : -kZone;
        const Vector3d out = std::cos(t) * u + std::sin(t) * v;
        const double angle = kind == ShapeKind::cone ? half_angle : 0;
        const double across = radius + z * std::tan(angle);
        all.push_back(o + across * out + z * d + h * (std::cos(angle) * out - std::sin(angle) * d));
        if (kind == ShapeKind::circle3) {
          const double between = t + std::numbers::pi / 4;
          all.push_back(o + radius * (std::cos(between) * u + std::sin(between) * v) + h * d);
        }
      }
    }
  }
  known.points.resize(3, static_cast<Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) known.points.col(static_cast<Index>(i)) = all[i];
  return known;
}

TEST(ExtremeFit, FindsTheMinimumZoneThatIsKnownByConstruction) {
  Numbers numbers(21);
  for (const ShapeKind kind : test::all_kinds()) {
    for (const double far : {0.0, 1e6}) {
      const KnownZone known = known_zone(kind, far, numbers);
      const ShapeFit fit = extreme_fit(kind, ExtremeKind::minimum_zone, known.points);
      ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << ": " << fit.reason;
      const test::ShapeDifference off = test::difference(fit.shape, known.shape);
      EXPECT_LT(off.length, 1e-7) << shape_name(kind);
      EXPECT_LT(off.angle, 1e-9) << shape_name(kind);
      EXPECT_NEAR(fit.form, 2 * kZone, 1e-9 + 1e-15 * far) << shape_name(kind);
      EXPECT_LE(fit.form, least_squares_fit(kind, known.points).form) << shape_name(kind);
    }
  }
}

/// Kolmogorov's criterion by means of the plain distance: multipliers of one sense combine its numerical gradients to
/// zero, and all contacts are at the extreme.
TEST(ExtremeFit, ContactsProveTheOptimumOfRandomPoints) {
  Numbers numbers(22);
  for (const ShapeKind kind :
       {ShapeKind::plane, ShapeKind::circle2, ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone}) {
    PatchOptions options;
    options.points = 1500;
    options.arc = 3;
    const Patch patch = test::patch(kind, options, numbers);
    Matrix3Xd points = patch.feet;
    for (Index i = 0; i < points.cols(); ++i) points.col(i) += numbers.uniform(-0.01, 0.01) * patch.normals.col(i);
    const ShapeFit fit = extreme_fit(kind, ExtremeKind::minimum_zone, points);
    ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << ": " << fit.reason;
    EXPECT_EQ(fit.contacts.size(), static_cast<std::size_t>(fit.parameters) + 1) << shape_name(kind);
    EXPECT_NEAR(std::accumulate(fit.multipliers.begin(), fit.multipliers.end(), 0.0), 1, 1e-9);
    EXPECT_NEAR(fit.largest, -fit.smallest, 1e-11);
    Eigen::Matrix<double, 8, 1> sum = Eigen::Matrix<double, 8, 1>::Zero();
    for (std::size_t k = 0; k < fit.contacts.size(); ++k) {
      EXPECT_GE(fit.multipliers[k], -1e-9);
      const Vector3d p = points.col(static_cast<Index>(fit.contacts[k]));
      const double sign = distance(fit.shape, p) > 0 ? 1 : -1;
      EXPECT_NEAR(sign * distance(fit.shape, p), fit.form / 2, 1e-10);
      for (int j = 0; j < 8; ++j) {
        const auto at = [&](double step) {
          Shape s = fit.shape;
          if (j < 3) s.point[j] += step;
          if (j >= 3 && j < 6) s.direction[j - 3] += step;
          if (j == 6) s.radius += step;
          if (j == 7) s.half_angle += step;
          if (s.direction.norm() > 0) s.direction.normalize();
          return distance(s, p);
        };
        if ((kind == ShapeKind::circle2 && j >= 2 && j <= 5) || (kind != ShapeKind::cone && j == 7)) continue;
        if ((kind == ShapeKind::plane && j == 6) || (kind == ShapeKind::sphere && j >= 3 && j <= 5)) continue;
        sum[j] += fit.multipliers[k] * sign * (at(1e-6) - at(-1e-6)) / 2e-6;
      }
    }
    EXPECT_LT(sum.cwiseAbs().maxCoeff(), 1e-6) << shape_name(kind);
  }
}

TEST(ExtremeFit, CircumscribedAndInscribedByTwoAndThreePoints) {
  Numbers numbers(23);
  for (const int touching : {2, 3}) {
    Matrix3Xd points = Matrix3Xd::Zero(3, 40);
    for (Index i = 0; i < 40; ++i) {
      const double t = numbers.uniform(0, 6.28), r = numbers.uniform(9.8, 9.9);
      points.col(i) << 7 + r * std::cos(t), -3 + r * std::sin(t), 0;
    }
    for (int k = 0; k < touching; ++k) {
      const double t = 0.3 + 2 * std::numbers::pi * k / touching;
      points.col(10 + k) << 7 + 10 * std::cos(t), -3 + 10 * std::sin(t), 0;
    }
    const ShapeFit fit = extreme_fit(ShapeKind::circle2, ExtremeKind::circumscribed, points);
    ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
    EXPECT_NEAR((fit.shape.point - Vector3d(7, -3, 0)).norm(), 0, 1e-8);
    EXPECT_NEAR(fit.shape.radius, 10, 1e-10);
    EXPECT_EQ(fit.contacts.size(), static_cast<std::size_t>(touching));
    EXPECT_LE(fit.largest, 1e-10);
  }
  Matrix3Xd points = Matrix3Xd::Zero(3, 60);
  for (Index i = 0; i < 60; ++i) {
    const double t = 0.1 * static_cast<double>(i), r = i % 20 == 7 ? 5 : 5.02;
    points.col(i) << 1 + r * std::cos(t), 2 + r * std::sin(t), 0;
  }
  const ShapeFit fit = extreme_fit(ShapeKind::circle2, ExtremeKind::inscribed, points);
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_NEAR((fit.shape.point - Vector3d(1, 2, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR(fit.shape.radius, 5, 1e-9);
  EXPECT_GE(fit.smallest, -1e-10);
}

/// Width of the zone of points about a shape, whatever its radius or offset: what the minimum zone makes smallest.
double zone_width(const Shape& shape, const Matrix3Xd& points) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (Index i = 0; i < points.cols(); ++i) {
    const double d = distance(shape, points.col(i));
    low = std::min(low, d);
    high = std::max(high, d);
  }
  return shape.kind == ShapeKind::line3 || shape.kind == ShapeKind::circle3 ? 2 * high : high - low;
}

Matrix3Xd rough_points(const Patch& patch, double roughness, Numbers& numbers) {
  Matrix3Xd points = patch.feet;
  for (Index i = 0; i < points.cols(); ++i) {
    points.col(i) += numbers.uniform(-roughness, roughness) * patch.normals.col(i) +
                     numbers.uniform(-roughness, roughness) * patch.second.col(i);
  }
  return points;
}

/// Steps of all sizes in all directions, taken in the shape as plain data.
TEST(ExtremeFit, NoShapeNearbyHasANarrowerZone) {
  Numbers numbers(24);
  for (const ShapeKind kind : test::all_kinds()) {
    for (const double arc : {2 * std::numbers::pi, 0.7}) {
      PatchOptions options;
      options.points = 60;
      options.arc = arc;
      const Patch patch = test::patch(kind, options, numbers);
      const Matrix3Xd points = rough_points(patch, arc < 1 ? 1e-3 : 0.05, numbers);
      const ShapeFit fit = extreme_fit(kind, ExtremeKind::minimum_zone, points);
      ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << ": " << fit.reason;
      EXPECT_NEAR(fit.form, zone_width(fit.shape, points), 1e-11) << shape_name(kind);
      const bool in_plane = kind == ShapeKind::line2 || kind == ShapeKind::circle2;
      for (int trial = 0; trial < 4000; ++trial) {
        const double reach = std::pow(10, numbers.uniform(-7, 0));
        Shape other = fit.shape;
        other.point += reach * Vector3d(numbers.normal(), numbers.normal(), in_plane ? 0 : numbers.normal());
        if (kind != ShapeKind::sphere && kind != ShapeKind::circle2) {
          other.direction +=
              0.05 * reach * Vector3d(numbers.normal(), numbers.normal(), in_plane ? 0 : numbers.normal());
          other.direction.normalize();
        }
        other.radius += reach * numbers.normal();
        if (kind == ShapeKind::cone) other.half_angle += 0.05 * reach * numbers.normal();
        ASSERT_GE(zone_width(other, points), fit.form - 1e-11) << shape_name(kind) << " " << reach;
      }
    }
  }
}

/// The centre of the narrowest ring is where two perpendicular bisectors of pairs of points meet, that of the
/// narrowest shell where three meet; the narrowest strip lies along a pair, the narrowest slab along a triple or two
/// pairs. All of them are tried.
double narrowest_of_all(ShapeKind kind, const Matrix3Xd& points) {
  const Index n = points.cols();
  std::vector<Vector3d> between, middle;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < i; ++j) {
      between.emplace_back(points.col(i) - points.col(j));
      middle.emplace_back((points.col(i) + points.col(j)) / 2);
    }
  }
  double best = std::numeric_limits<double>::infinity();
  const auto width_across = [&](const Vector3d& direction) {
    if (!(direction.norm() > 1e-9)) return;
    const Eigen::RowVectorXd d = direction.normalized().transpose() * points;
    best = std::min(best, d.maxCoeff() - d.minCoeff());
  };
  const auto width_about = [&](const Vector3d& centre) {
    if (!centre.allFinite()) return;
    const Eigen::RowVectorXd d = (points.colwise() - centre).colwise().norm();
    best = std::min(best, d.maxCoeff() - d.minCoeff());
  };
  for (std::size_t a = 0; a < between.size(); ++a) {
    if (kind == ShapeKind::line2) width_across({-between[a].y(), between[a].x(), 0});
    for (std::size_t b = 0; b < a; ++b) {
      if (kind == ShapeKind::plane) width_across(between[a].cross(between[b]));
      Eigen::Matrix3d rows;
      Vector3d right(between[a].dot(middle[a]), between[b].dot(middle[b]), 0);
      rows << between[a].transpose(), between[b].transpose(), 0, 0, 1;
      if (kind == ShapeKind::circle2) width_about(rows.inverse() * right);
      for (std::size_t c = 0; kind == ShapeKind::sphere && c < b; ++c) {
        rows.row(2) = between[c].transpose();
        right[2] = between[c].dot(middle[c]);
        width_about(rows.inverse() * right);
      }
    }
  }
  return best;
}

TEST(ExtremeFit, AgreesWithTheBestOfAllPossibleContacts) {
  Numbers numbers(25);
  for (const ShapeKind kind : {ShapeKind::line2, ShapeKind::plane, ShapeKind::circle2, ShapeKind::sphere}) {
    for (int repetition = 0; repetition < 12; ++repetition) {
      PatchOptions options;
      options.points = kind == ShapeKind::sphere ? 8 : kind == ShapeKind::plane ? 14 : 20;
      const Patch patch = test::patch(kind, options, numbers);
      const Matrix3Xd points = rough_points(patch, repetition % 2 == 0 ? 0.01 : 0.5, numbers);
      const ShapeFit fit = extreme_fit(kind, ExtremeKind::minimum_zone, points);
      ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << ": " << fit.reason;
      EXPECT_NEAR(fit.form, narrowest_of_all(kind, points), 1e-9) << shape_name(kind) << " " << repetition;
    }
  }
}

TEST(ExtremeFit, SmallestCircleAroundIsTheSmallestOfAllPairsAndTriples) {
  Numbers numbers(26);
  for (int repetition = 0; repetition < 20; ++repetition) {
    PatchOptions options;
    options.points = 14;
    options.arc = repetition % 2 == 0 ? 2 * std::numbers::pi : 1.2;
    const Patch patch = test::patch(ShapeKind::circle2, options, numbers);
    const Matrix3Xd points = rough_points(patch, 0.1, numbers);
    double best = std::numeric_limits<double>::infinity();
    const auto around = [&](const Vector3d& centre, double radius) {
      if ((points.colwise() - centre).colwise().norm().maxCoeff() <= radius * (1 + 1e-12))
        best = std::min(best, radius);
    };
    for (Index i = 0; i < points.cols(); ++i) {
      for (Index j = 0; j < i; ++j) {
        around((points.col(i) + points.col(j)) / 2, (points.col(i) - points.col(j)).norm() / 2);
        for (Index k = 0; k < j; ++k) {
          const Vector3d a = points.col(j) - points.col(i), b = points.col(k) - points.col(i), n = a.cross(b);
          const Vector3d c = (a.squaredNorm() * b.cross(n) + b.squaredNorm() * n.cross(a)) / (2 * n.squaredNorm());
          around(points.col(i) + c, c.norm());
        }
      }
    }
    const ShapeFit fit = extreme_fit(ShapeKind::circle2, ExtremeKind::circumscribed, points);
    ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
    EXPECT_NEAR(fit.shape.radius, best, 1e-10) << repetition;
  }
}

TEST(ExtremeFit, CylinderAroundAndWithinThatAreKnownByConstruction) {
  Numbers numbers(27);
  for (const ExtremeKind extreme : {ExtremeKind::circumscribed, ExtremeKind::inscribed}) {
    const double side = extreme == ExtremeKind::circumscribed ? -1 : 1;
    PatchOptions options;
    options.far = 1e6;
    const Patch patch = test::patch(ShapeKind::cylinder, options, numbers);
    Matrix3Xd points = patch.feet;
    for (Index i = 0; i < points.cols(); ++i)
      points.col(i) += side * numbers.uniform(0.01, 0.05) * patch.normals.col(i);
    // Two triangles of contacts hold the axis.
    const Vector3d d = patch.shape.direction, u = d.unitOrthogonal(), v = d.cross(u);
    for (int k = 0; k < 6; ++k) {
      const double t = 2 * std::numbers::pi * k / 3 + 0.4;
      points.col(k) = patch.shape.point + (k < 3 ? -18 : 18) * d + options.radius * (std::cos(t) * u + std::sin(t) * v);
    }
    const ShapeFit fit = extreme_fit(ShapeKind::cylinder, extreme, points);
    ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
    const test::ShapeDifference off = test::difference(fit.shape, patch.shape);
    EXPECT_LT(off.length, 1e-7);
    EXPECT_LT(off.angle, 1e-9);
    EXPECT_GE(side * fit.smallest, side > 0 ? -1e-9 : 0.009);
  }
}

TEST(ExtremeFit, SaysWhenThereIsNoAnswer) {
  Numbers numbers(28);
  PatchOptions options;
  options.arc = 1.5;
  const Patch arc = test::patch(ShapeKind::circle2, options, numbers);
  // The points do not surround a largest circle.
  EXPECT_NE(extreme_fit(ShapeKind::circle2, ExtremeKind::inscribed, rough_points(arc, 0.01, numbers)).status,
            FitStatus::ok);
  EXPECT_EQ(extreme_fit(ShapeKind::plane, ExtremeKind::minimum_zone, Matrix3Xd::Zero(3, 9)).status,
            FitStatus::degenerate);
  EXPECT_EQ(extreme_fit(ShapeKind::cone, ExtremeKind::minimum_zone, Matrix3Xd::Random(3, 4)).status,
            FitStatus::too_few_points);
  EXPECT_THROW(extreme_fit(ShapeKind::plane, ExtremeKind::inscribed, arc.feet), std::invalid_argument);
  // Points on the shape to rounding have no contacts, and the shape is that of least squares.
  const Patch exact = test::patch(ShapeKind::cone, {}, numbers);
  const ShapeFit fit = extreme_fit(ShapeKind::cone, ExtremeKind::minimum_zone, exact.feet);
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_LT(fit.form, 1e-10);
  EXPECT_TRUE(fit.contacts.empty());
}

TEST(ExtremeFit, CovarianceIsTheScatterWhileTheContactsStay) {
  Numbers numbers(29);
  const KnownZone known = known_zone(ShapeKind::circle2, 0, numbers);
  // Only the four contacts move, by much less than the others are away from the edges.
  FitOptions options;
  options.sigma = 1e-6;
  const ShapeFit reference = extreme_fit(ShapeKind::circle2, ExtremeKind::minimum_zone, known.points, options);
  ASSERT_TRUE(reference.ok() && reference.has_covariance);
  double squares = 0, radius = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    Matrix3Xd points = known.points;
    for (Index i = points.cols() - 4; i < points.cols(); ++i) {
      points.col(i) += options.sigma * numbers.normal() * (points.col(i) - known.shape.point).normalized();
    }
    const ShapeFit fit = extreme_fit(ShapeKind::circle2, ExtremeKind::minimum_zone, points);
    ASSERT_TRUE(fit.ok());
    squares += std::pow(fit.shape.point.x() - reference.shape.point.x(), 2) / kRuns;
    radius += std::pow(fit.shape.radius - reference.shape.radius, 2) / kRuns;
  }
  EXPECT_NEAR(std::sqrt(squares / reference.covariance(0, 0)), 1, 0.15);
  EXPECT_NEAR(std::sqrt(radius) / reference.radius_uncertainty(), 1, 0.15);
}

}  // namespace
}  // namespace abbe
