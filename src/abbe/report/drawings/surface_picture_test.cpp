#include "abbe/report/drawings/surface_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "abbe/geometry/surface/meshes_for_test.h"
#include "abbe/report/report.h"

namespace abbe {
namespace {

/// Points on a ball of 10 mm whose deviation is 50 um times the cosine of the polar angle.
Eigen::Matrix3Xd scan_of_a_ball(Eigen::Index n) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  Eigen::Matrix3Xd points(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d direction = Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
    points.col(i) = direction * (10 + 0.05 * direction.z());
  }
  return points;
}

TEST(SurfacePicture, APageOfAFinePartAndALongScanStaysBelowItsSize) {
  const TriangleMesh ball = sphere_for_test({0, 0, 0}, 10, 180);
  const Eigen::Matrix3Xd points = scan_of_a_ball(120000);
  const ClosestPointFinder finder(ball, 2);
  const std::vector<SurfacePoint> closest = finder.closest(points, 2);
  const SurfaceDeviation deviation = surface_deviation(closest);
  const nlohmann::json page = deviation_page(ball, closest, deviation, 0.05, 2);
  nlohmann::json data = page;
  data["format"] = "abbe-report/1";
  data["title"] = "A ball";
  EXPECT_LT(report_page(data).size(), kReportSizeLimit);
  const nlohmann::json& surface = page.at("surface");
  EXPECT_EQ(surface.at("triangles_of_part"), ball.size());
  EXPECT_LE(surface.at("triangle_count").get<Eigen::Index>(), kTrianglesDrawn);
  EXPECT_GT(surface.at("triangle_count").get<Eigen::Index>(), kTrianglesDrawn / 2);
  EXPECT_GT(surface.at("thinned_cell_mm").get<double>(), 0);
  EXPECT_EQ(surface.at("points").at("measured"), 120000);
  EXPECT_LE(surface.at("points").at("drawn").get<std::size_t>(), kPointsDrawn);
  EXPECT_GT(surface.at("points").at("drawn").get<std::size_t>(), kPointsDrawn / 2);
  const nlohmann::json& classes = page.at("histograms").at(0);
  std::size_t counted = classes.at("below").get<std::size_t>() + classes.at("above").get<std::size_t>();
  for (const auto& count : classes.at("counts")) counted += count.get<std::size_t>();
  EXPECT_EQ(counted, 120000U);
}

TEST(SurfacePicture, ColoursOfACoarsePartFollowTheScan) {
  const TriangleMesh block = block_for_test({0, 0, 0}, {40, 20, 10});
  // The upper face 30 um high, the others not seen.
  Eigen::Matrix3Xd points(3, 2000);
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> along(0.5, 39.5), across(0.5, 19.5);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    points.col(i) = Eigen::Vector3d(along(engine), across(engine), 10.03);
  }
  const std::vector<SurfacePoint> closest = ClosestPointFinder(block, 1).closest(points, 1);
  const SurfaceDeviation deviation = surface_deviation(closest);
  const nlohmann::json surface = deviation_page(block, closest, deviation, 0.05, 1).at("surface");
  EXPECT_EQ(surface.at("triangles_of_part"), 12);
  EXPECT_GT(surface.at("triangle_count"), 300);
  EXPECT_FALSE(surface.contains("thinned_cell_mm"));
  EXPECT_EQ(surface.at("points").at("drawn"), 2000);
  const double radius = surface.at("averaging_radius_mm");
  EXPECT_GT(radius, 0.5);
  EXPECT_LT(radius, 5);
  // 30 um are 1200 steps of 50 um / 2000: as base64 of i16 0x04b0, which stands for all vertices of the upper face.
  const std::string values = surface.at("values");
  std::size_t known = 0;
  const std::size_t vertices = surface.at("vertex_count");
  for (std::size_t i = 0; i + 8 <= values.size(); i += 8) known += values.substr(i, 8) == "sASwBLAE" ? 3U : 0U;
  EXPECT_GT(known, vertices / 10);
  EXPECT_LT(known, vertices / 2);
}

TEST(SurfacePicture, WithoutAPointThatCountsThereIsNone) {
  const TriangleMesh block = block_for_test({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(deviation_page(block, {}, surface_deviation({}), 0.01, 1).empty());
}

}  // namespace
}  // namespace abbe
