#include "liu/parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/geometry/surface/vertex_welder.h"

namespace abbe {
namespace {

using std::numbers::pi;
using Surface = std::function<Eigen::Vector3d(double u, double v)>;

/// Angle of a whole turn that ends exactly where it began.
double turn(double u) { return u >= 1 ? 0 : 2 * pi * u; }

/// To the nearest 2^-30 mm, so that patches that meet have the same vertices whatever the rounding.
Eigen::Vector3d snapped(const Eigen::Vector3d& point) {
  return point.unaryExpr([](double x) { return std::ldexp(std::round(std::ldexp(x, 30)), -30); });
}

/// Collects patches of a surface into a mesh with shared vertices.
class PatchMesh {
 public:
  /// A patch over [0, 1] x [0, 1]; d/du x d/dv leaves the material.
  void add(const Surface& surface, int along_u, int along_v) {
    std::vector<double> corners;
    for (int j = 0; j <= along_v; ++j) {
      for (int i = 0; i <= along_u; ++i) {
        const Eigen::Vector3d at = snapped(surface(static_cast<double>(i) / along_u, static_cast<double>(j) / along_v));
        corners.insert(corners.end(), {at.x(), at.y(), at.z()});
      }
    }
    std::vector<std::uint32_t> index(corners.size() / 3);
    welder_.add(corners, index.data());
    const auto row = static_cast<std::size_t>(along_u) + 1;
    for (std::size_t j = 0; j < static_cast<std::size_t>(along_v); ++j) {
      for (std::size_t i = 0; i + 1 < row; ++i) {
        const std::size_t a = j * row + i;
        add_triangle(index[a], index[a + 1], index[a + row + 1]);
        add_triangle(index[a], index[a + row + 1], index[a + row]);
      }
    }
  }

  TriangleMesh mesh() const {
    TriangleMesh result;
    result.vertices = welder_.vertices();
    result.triangles.resize(3, static_cast<Eigen::Index>(triangles_.size()));
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      result.triangles.col(static_cast<Eigen::Index>(i)) = triangles_[i];
    }
    return result;
  }

 private:
  using Corners = Eigen::Matrix<std::uint32_t, 3, 1>;
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    // Poles and tips close patches with points.
    if (a != b && b != c && c != a) triangles_.emplace_back(a, b, c);
  }
  VertexWelder welder_{1000};
  std::vector<Corners> triangles_;
};

/// Rings about y from one radius and height to others; normal outwards for increasing height.
void add_ring(PatchMesh& mesh, double radius_from, double y_from, double radius_to, double y_to, int around,
              int along) {
  mesh.add(
      [=](double u, double v) {
        const double radius = radius_from + v * (radius_to - radius_from), angle = turn(u);
        return Eigen::Vector3d(radius * std::cos(angle), y_from + v * (y_to - y_from), -radius * std::sin(angle));
      },
      around, along);
}

}  // namespace

TriangleMesh cylinder_mesh(double radius, double taper, double length, const Eigen::Vector3d& axis) {
  constexpr int kAround = 1440;  // chord error 0.02 um at 10 mm
  PatchMesh patches;
  const double low = radius - taper * length / 2, high = radius + taper * length / 2;
  add_ring(patches, 0, -length / 2, low, -length / 2, kAround, 1);
  add_ring(patches, low, -length / 2, high, length / 2, kAround, 1);
  add_ring(patches, high, length / 2, 0, length / 2, kAround, 1);
  TriangleMesh mesh = patches.mesh();
  const Eigen::Matrix3d turned = rotation_between(Eigen::Vector3d::UnitY(), axis);
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    mesh.vertices.col(i) = snapped(turned * Eigen::Vector3d(mesh.vertices.col(i)));
  }
  return mesh;
}

LiuPart liu_cylinder(double radius, double taper) {
  constexpr double kScanned = 23.5;
  return {"standard cylinder",
          cylinder_mesh(radius, taper, 30, Eigen::Vector3d::UnitY()),
          {{Eigen::Vector3d::UnitY(), -kScanned / 2}, {-Eigen::Vector3d::UnitY(), -kScanned / 2}}};
}

LiuPart liu_cross_cylinder() {
  constexpr double kMain = 6, kCross = 4, kMainHalf = 18, kCrossHalf = 14;
  constexpr int kSteps = 120, kAlong = 8;
  const double opening = std::asin(kCross / kMain);
  // Round the main cylinder, whose axis is y: (x, z) and the height where the wall begins. Two openings of the other
  // cylinder, whose axis is x, in steps of that one, so that both meet in the same vertices; two walls between them.
  using Rim = std::function<Eigen::Vector3d(double u)>;
  const auto open_rim = [](double side) {
    return [=](double u) {
      const double share = side * pi * (0.5 - u), z = kCross * std::sin(share);
      return Eigen::Vector3d(side * std::sqrt(kMain * kMain - z * z), kCross * std::cos(share), z);
    };
  };
  const auto wall_rim = [=](double side) {
    return [=](double u) {
      const double angle = side * pi / 2 + (pi / 2 - opening) * (1 - 2 * u);
      return Eigen::Vector3d(kMain * std::cos(angle), 0, kMain * std::sin(angle));
    };
  };
  PatchMesh patches;
  for (const Rim& rim : {Rim(open_rim(1)), Rim(wall_rim(-1)), Rim(open_rim(-1)), Rim(wall_rim(1))}) {
    for (const double side : {1.0, -1.0}) {
      patches.add(
          [=](double u, double v) {
            const Eigen::Vector3d at = rim(u);
            const double t = side > 0 ? v : 1 - v;
            return Eigen::Vector3d(at.x(), side * (at.y() + t * (kMainHalf - at.y())), at.z());
          },
          kSteps, kAlong);
      patches.add(
          [=](double u, double v) {
            const Eigen::Vector3d at = rim(u);
            const double t = side > 0 ? 1 - v : v;
            return Eigen::Vector3d(t * at.x(), side * kMainHalf, t * at.z());
          },
          kSteps, 1);
    }
  }
  // The cross cylinder outside the main one.
  for (const double half : {1.0, -1.0}) {
    const auto ring = [=](double u) {
      const double share = half * pi * (u - 0.5);
      return Eigen::Vector2d(half * kCross * std::cos(share), kCross * std::sin(share));
    };
    for (const double side : {1.0, -1.0}) {
      patches.add(
          [=](double u, double v) {
            const Eigen::Vector2d at = ring(u);
            const double x = std::sqrt(kMain * kMain - at[1] * at[1]), t = side > 0 ? v : 1 - v;
            return Eigen::Vector3d(side * (x + t * (kCrossHalf - x)), at[0], at[1]);
          },
          kSteps, kAlong);
      patches.add(
          [=](double u, double v) {
            const Eigen::Vector2d at = (side > 0 ? 1 - v : v) * ring(u);
            return Eigen::Vector3d(side * kCrossHalf, at[0], at[1]);
          },
          kSteps, 1);
    }
  }
  return {"cross cylinder", patches.mesh(), {}};
}

LiuPart liu_pyramid() {
  constexpr double kSide = 5, kTop = 5, kBottom = -20;
  const double out = kSide * std::sqrt(2.0 / 3), down = kSide / std::sqrt(3.0);
  const auto corner = [&](int k) {  // 0 .. 5 around y: odd ones are the far corners of the squares
    const double angle = pi / 3 * k;
    return Eigen::Vector3d(out * std::sin(angle), kTop - (k % 2 == 0 ? down : 2 * down), out * std::cos(angle));
  };
  const Eigen::Vector3d apex(0, kTop, 0);
  const auto bilinear = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                           const Eigen::Vector3d& d) {
    return [=](double u, double v) {
      return Eigen::Vector3d((1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * c));
    };
  };
  PatchMesh patches;
  for (int k = 0; k < 6; k += 2) patches.add(bilinear(apex, corner(k), corner(k + 1), corner((k + 2) % 6)), 1, 1);
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d a = corner(k), b = corner((k + 1) % 6);
    const Eigen::Vector3d a_low(a.x(), kBottom, a.z()), b_low(b.x(), kBottom, b.z());
    patches.add(bilinear(a_low, b_low, b, a), 1, 1);
    patches.add(bilinear(Eigen::Vector3d(0, kBottom, 0), b_low, a_low, Eigen::Vector3d(0, kBottom, 0)), 1, 1);
  }
  return {"triangular pyramid", patches.mesh(), {}};
}

LiuPart liu_sphere(double share) {
  constexpr double kRadius = 12.703;
  PatchMesh patches;
  patches.add(
      [](double u, double v) {
        const double polar = pi * (1 - v), angle = turn(u);
        const double ring = v <= 0 || v >= 1 ? 0 : std::sin(polar);
        return Eigen::Vector3d(kRadius * ring * std::cos(angle), kRadius * std::cos(polar),
                               -kRadius * ring * std::sin(angle));
      },
      480, 240);  // chord error 0.3 um
  // The area of a cap is in proportion to its height.
  return {"sphere, " + std::to_string(static_cast<int>(std::lround(100 * share))) + " %",
          patches.mesh(),
          {{Eigen::Vector3d::UnitY(), kRadius * (1 - 2 * share)}}};
}

LiuPart liu_blade() {
  constexpr double kLong = 7, kShort = 1.5, kHalf = 12, kTwist = 40 * kDegree;
  const auto point = [](double angle, double y, double size) {
    const double turned = kTwist * y / (2 * kHalf);
    const double a = size * kLong * std::cos(angle), b = size * kShort * std::sin(angle);
    return Eigen::Vector3d(a * std::cos(turned) + b * std::sin(turned), y, b * std::cos(turned) - a * std::sin(turned));
  };
  PatchMesh patches;
  // The section runs from x to -z about y.
  patches.add([&](double u, double v) { return point(-turn(u), kHalf * (2 * v - 1), 1); }, 720, 96);
  patches.add([&](double u, double v) { return point(-turn(u), -kHalf, v); }, 720, 1);
  patches.add([&](double u, double v) { return point(-turn(u), kHalf, 1 - v); }, 720, 1);
  return {"twisted blade", patches.mesh(), {}};
}

}  // namespace abbe
