#include "abbe/report/drawings/fit_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <random>

namespace abbe {
namespace {

Eigen::Matrix3Xd points_about(const Eigen::Vector3d& centre, Eigen::Index n) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  Eigen::Matrix3Xd points(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    points.col(i) = centre + 20 * Eigen::Vector3d(normal(engine), normal(engine), normal(engine));
  }
  return points;
}

TEST(FitSurface, LiesOnTheShapeWithItsNormalsOutwards) {
  const Eigen::Vector3d centre(100, -50, 7);
  const Eigen::Matrix3Xd points = points_about(centre, 50);
  for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone}) {
    const Shape shape{kind, centre, Eigen::Vector3d(1, 2, -2) / 3, kind == ShapeKind::plane ? 0.0 : 40.0,
                      kind == ShapeKind::cone ? 0.2 : 0.0};
    const TriangleMesh mesh = surface_of(shape, points);
    ASSERT_GT(mesh.size(), 1) << shape_name(kind);
    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
      EXPECT_NEAR(distance(shape, mesh.vertices.col(v)), 0, 1e-11) << shape_name(kind);
    }
    for (Eigen::Index t = 0; t < mesh.size(); ++t) {
      const Eigen::Vector3d twice =
          (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
      if (twice.norm() < 1e-9) continue;  // at the poles of the sphere
      const Eigen::Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
      EXPECT_GT(distance(shape, middle + 0.5 * twice.normalized()), distance(shape, middle)) << shape_name(kind);
    }
  }
  Shape line;
  line.kind = ShapeKind::line3;
  EXPECT_EQ(surface_of(line, points).size(), 0);
}

TEST(FitSurface, PointsStandOnTheirFeet) {
  const Shape cone{ShapeKind::cone, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 50, 0.3};
  Eigen::Matrix3Xd points = points_about({0, 0, 0}, 400);
  std::vector<double> deviations;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    // On the cone, then 12.5 um out along its normal.
    const double angle = 0.1 * static_cast<double>(i), at = 0.05 * static_cast<double>(i);
    const Eigen::Vector3d radial(std::cos(angle), std::sin(angle), 0);
    points.col(i) = (50 + at * std::tan(0.3)) * radial + Eigen::Vector3d(0, 0, at) +
                    0.0125 * (std::cos(0.3) * radial - std::sin(0.3) * Eigen::Vector3d::UnitZ());
    deviations.push_back(distance(cone, points.col(i)));
    EXPECT_NEAR(deviations.back(), 0.0125, 1e-12);
  }
  std::vector<std::uint8_t> counted(400, 1);
  counted[7] = 0;
  const nlohmann::json page = fit_page(cone, points, deviations, counted, 1);
  EXPECT_FALSE(page.contains("histograms"));
  EXPECT_EQ(page.at("surface").at("points").at("counted"), 399);
  EXPECT_EQ(page.at("surface").at("points").at("measured"), 400);
  EXPECT_EQ(page.at("surface").at("limit_um"), 20);
}

}  // namespace
}  // namespace abbe
