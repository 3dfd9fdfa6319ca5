#include "abbe/geometry/fits/revolution_axis.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

#include "abbe/geometry/rotation.h"
#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

using std::numbers::pi;

/// Open tube over (angle, height), placed somewhere askew.
struct Tube {
  TriangleMesh mesh;
  RevolutionAxis axis;
};

Tube tube(int around, int along, const std::function<Eigen::Vector3d(double angle, double height)>& surface) {
  const Eigen::Matrix3d turn = rotation_about(Eigen::Vector3d(1, 2, -0.5).normalized(), 0.8);
  const Eigen::Vector3d place(20, -7, 3);
  Tube result{{}, {place, turn.col(2)}};
  TriangleMesh& mesh = result.mesh;
  mesh.vertices.resize(3, around * (along + 1));
  mesh.triangles.resize(3, 2 * around * along);
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * around + i % around); };
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      mesh.vertices.col(at(i, j)) = turn * surface(2 * pi * i / around, static_cast<double>(j) / along) + place;
      if (j == along) continue;
      mesh.triangles.col(2 * (j * around + i)) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
      mesh.triangles.col(2 * (j * around + i) + 1) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
    }
  }
  return result;
}

std::vector<std::uint32_t> all(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> triangles(static_cast<std::size_t>(mesh.size()));
  std::iota(triangles.begin(), triangles.end(), 0U);
  return triangles;
}

/// Smallest deviation from revolution about any candidate, and that candidate.
std::pair<double, RevolutionAxis> best(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
  std::pair<double, RevolutionAxis> result{std::numeric_limits<double>::infinity(), {}};
  const std::vector<Eigen::Vector3d> directions = {Eigen::Vector3d::UnitY()};
  const std::vector<RevolutionAxis> candidates = revolution_axes(mesh, triangles, directions);
  EXPECT_FALSE(candidates.empty());
  for (const RevolutionAxis& axis : candidates) {
    const double deviation = revolution_deviation(mesh, triangles, axis);
    if (deviation < result.first) result = {deviation, axis};
  }
  return result;
}

void expect_axis(const RevolutionAxis& found, const RevolutionAxis& axis, double angle, double distance) {
  EXPECT_LT(found.direction.cross(axis.direction).norm(), angle);
  EXPECT_LT((found.point - axis.point).cross(axis.direction).norm(), distance);
}

TEST(RevolutionAxis, IsFoundOfConesVasesAndCylindersOfStrips) {
  const Tube cone = tube(90, 1, [](double a, double h) {
    return Eigen::Vector3d((5 + 4 * h) * std::cos(a), (5 + 4 * h) * std::sin(a), 10 * h);
  });
  const Tube vase = tube(72, 30, [](double a, double h) {
    const double radius = 5 + std::sin(3 * h);
    return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), 10 * h);
  });
  const Tube cylinder =
      tube(60, 1, [](double a, double h) { return Eigen::Vector3d(5 * std::cos(a), 5 * std::sin(a), 10 * h); });
  for (const Tube& part : {cone, vase, cylinder}) {
    const auto [deviation, axis] = best(part.mesh, all(part.mesh));
    EXPECT_LT(deviation, 2e-3);
    expect_axis(axis, part.axis, 1e-3, 5e-3);
  }
}

TEST(RevolutionAxis, IsFoundOfHalfACylinderWithASlantedEnd) {
  // Its border has normals of one side only.
  const Tube part = tube(120, 6, [](double a, double h) {
    return Eigen::Vector3d(5 * std::cos(a), 5 * std::sin(a), h * (12 + 6 * std::cos(a)));
  });
  std::vector<std::uint32_t> half;
  for (const std::uint32_t t : all(part.mesh)) {
    if (t / 2 % 120 < 70) half.push_back(t);
  }
  const auto [deviation, axis] = best(part.mesh, half);
  EXPECT_LT(deviation, 2e-3);
  // Triangles lean to one side: their middles are not the middles of strips.
  expect_axis(axis, part.axis, 2e-3, 2e-2);
}

TEST(RevolutionAxis, OfASphereGoesThroughItsCentreInTheDirectionAskedFor) {
  const Eigen::Vector3d centre(3, 40, -9);
  const TriangleMesh sphere = sphere_for_test(centre, 12.703, 60);
  std::vector<std::uint32_t> cap;
  for (const std::uint32_t t : all(sphere)) {
    if (sphere.corner(t, 0).z() > centre.z() + 2) cap.push_back(t);
  }
  const std::vector<Eigen::Vector3d> directions = {Eigen::Vector3d(0, 0.6, 0.8)};
  const auto axes = revolution_axes(sphere, cap, directions);
  ASSERT_FALSE(axes.empty());
  EXPECT_LT((axes.back().direction - directions[0]).norm(), 1e-12);
  EXPECT_LT((axes.back().point - centre).norm(), 0.01);
  EXPECT_LT(revolution_deviation(sphere, cap, axes.back()), 0.02);
}

TEST(RevolutionAxis, OfACylinderOfLongStripsIsNotThatOfTheSphereThroughItsCorners) {
  const Tube part =
      tube(90, 1, [](double a, double h) { return Eigen::Vector3d(5 * std::cos(a), 5 * std::sin(a), 10 * h); });
  // Askew to the cylinder's own axis.
  const std::vector<Eigen::Vector3d> directions = {Eigen::Vector3d::UnitY()};
  const std::vector<RevolutionAxis> axes = revolution_axes(part.mesh, all(part.mesh), directions);
  ASSERT_FALSE(axes.empty());
  for (const RevolutionAxis& axis : axes) {
    expect_axis(axis, part.axis, 1e-3, 5e-3);
    EXPECT_LT(axis.direction.cross(part.axis.direction).norm(), 1e-3);
  }
}

TEST(RevolutionAxis, IsNotOneOfAnEllipticTubeNorOfATwistedOne) {
  const Tube ellipse =
      tube(180, 10, [](double a, double h) { return Eigen::Vector3d(5 * std::cos(a), 4.5 * std::sin(a), 10 * h); });
  // Normals of the ellipse miss its middle by up to 5 - 4.5; half a strip is 0.087 wide.
  EXPECT_NEAR(revolution_deviation(ellipse.mesh, all(ellipse.mesh), ellipse.axis), 0.5, 0.09);
  EXPECT_GT(best(ellipse.mesh, all(ellipse.mesh)).first, 0.35);
  // A motion of a screw keeps it, no rotation does.
  const Tube twisted = tube(180, 40, [](double a, double h) {
    const Eigen::Vector3d section(7 * std::cos(a), 1.5 * std::sin(a), 10 * h);
    return Eigen::Vector3d(rotation_about(Eigen::Vector3d::UnitZ(), 0.7 * h) * section);
  });
  // Of the untwisted section they miss it by up to 7 - 1.5.
  EXPECT_NEAR(revolution_deviation(twisted.mesh, all(twisted.mesh), twisted.axis), 5.5, 0.6);
  EXPECT_GT(best(twisted.mesh, all(twisted.mesh)).first, 4.0);
}

}  // namespace
}  // namespace abbe
