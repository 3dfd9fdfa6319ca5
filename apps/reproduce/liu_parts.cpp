#include "reproduce/liu_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/geometry/vertex_welder.h"

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

/// Scans a patch line by line, to and fro.
void scan(std::vector<SurfacePlace>& places, int lines, int per_line,
          const std::function<SurfacePlace(double along, double line)>& place) {
  for (int j = 0; j < lines; ++j) {
    for (int i = 0; i < per_line; ++i) {
      const int k = j % 2 == 0 ? i : per_line - 1 - i;
      places.push_back(place((k + 0.5) / per_line, lines == 1 ? 0.5 : static_cast<double>(j) / (lines - 1)));
    }
  }
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
  const Eigen::Matrix3d turned = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), axis).toRotationMatrix();
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    mesh.vertices.col(i) = snapped(turned * Eigen::Vector3d(mesh.vertices.col(i)));
  }
  return mesh;
}

LiuPart liu_cylinder(double radius, double taper) {
  LiuPart part{"standard cylinder", cylinder_mesh(radius, taper, 30, Eigen::Vector3d::UnitY()), {}};
  scan(part.places, 25, 180, [&](double along, double line) {
    const Eigen::Vector3d normal(std::sin(2 * pi * along), 0, std::cos(2 * pi * along));
    const double y = 23.5 * (line - 0.5);
    return SurfacePlace{(radius + taper * y) * normal + Eigen::Vector3d(0, y, 0), normal};
  });
  return part;
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
  LiuPart part{"cross cylinder", patches.mesh(), {}};
  for (const double side : {1.0, -1.0}) {
    scan(part.places, 14, 120, [&](double along, double line) {
      const Eigen::Vector3d normal(std::sin(2 * pi * along), 0, std::cos(2 * pi * along));
      return SurfacePlace{kMain * normal + Eigen::Vector3d(0, side * (17 - 16.5 * line), 0), normal};
    });
    scan(part.places, 10, 100, [&](double along, double line) {
      const Eigen::Vector3d normal(0, std::sin(2 * pi * along), std::cos(2 * pi * along));
      return SurfacePlace{kCross * normal + Eigen::Vector3d(side * (13 - 7 * line), 0, 0), normal};
    });
  }
  // What lies inside the other cylinder is no surface.
  std::erase_if(part.places, [](const SurfacePlace& place) {
    const Eigen::Vector3d& p = place.point;
    return std::hypot(p.y(), p.z()) < kCross - 1e-6 || std::hypot(p.x(), p.z()) < kMain - 1e-6;
  });
  return part;
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
  LiuPart part{"triangular pyramid", {}, {}};
  for (int k = 0; k < 6; k += 2) {
    const auto face = bilinear(apex, corner(k), corner(k + 1), corner((k + 2) % 6));
    patches.add(face, 1, 1);
    const Eigen::Vector3d normal = (corner(k) - apex).cross(Eigen::Vector3d(corner((k + 2) % 6) - apex)).normalized();
    scan(part.places, 30, 30, [&](double along, double line) {
      return SurfacePlace{face(0.02 + 0.96 * along, 0.02 + 0.96 * line), normal};
    });
  }
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d a = corner(k), b = corner((k + 1) % 6);
    const Eigen::Vector3d a_low(a.x(), kBottom, a.z()), b_low(b.x(), kBottom, b.z());
    const auto face = bilinear(a_low, b_low, b, a);
    patches.add(face, 1, 1);
    patches.add(bilinear(Eigen::Vector3d(0, kBottom, 0), b_low, a_low, Eigen::Vector3d(0, kBottom, 0)), 1, 1);
    const Eigen::Vector3d normal = (b_low - a_low).cross(Eigen::Vector3d(a - a_low)).normalized();
    scan(part.places, 16, 12, [&](double along, double line) {
      return SurfacePlace{face(0.04 + 0.92 * along, 0.45 + 0.53 * line), normal};
    });
  }
  part.mesh = patches.mesh();
  return part;
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
  LiuPart part{"sphere, " + std::to_string(static_cast<int>(std::lround(100 * share))) + " %", patches.mesh(), {}};
  // Circles of equal height: equal areas between them.
  const int circles = 40;
  for (int j = 0; j < circles; ++j) {
    const double y = 1 - 2 * share * (j + 0.5) / circles, ring = std::sqrt(1 - y * y);
    scan(part.places, 1, 120, [&](double along, double) {
      const Eigen::Vector3d normal(ring * std::sin(2 * pi * along), y, ring * std::cos(2 * pi * along));
      return SurfacePlace{kRadius * normal, normal};
    });
  }
  return part;
}

LiuPart liu_blade() {
  constexpr double kLong = 7, kShort = 1.5, kHalf = 12, kTwist = 40 * pi / 180;
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
  LiuPart part{"twisted blade", patches.mesh(), {}};
  scan(part.places, 40, 160, [&](double along, double line) {
    // Steps of the parameter that are even along the section, nearly.
    const double angle = 2 * pi * along, y = 22 * (line - 0.5), step = 1e-5;
    const Eigen::Vector3d du = point(angle + step, y, 1) - point(angle - step, y, 1),
                          dv = point(angle, y + step, 1) - point(angle, y - step, 1);
    return SurfacePlace{point(angle, y, 1), dv.cross(du).normalized()};
  });
  return part;
}

}  // namespace abbe
