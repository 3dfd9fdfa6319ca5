#include "abbe/instruments/triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "abbe/geometry/parts_for_test.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/engraved_edge.h"

namespace abbe {
namespace {

LineScanner exact_scanner() {
  LineScanner scanner;
  scanner.width = 0.6;
  scanner.points = 301;
  scanner.largest_angle = 89.9 * std::numbers::pi / 180;
  return scanner;
}

/// Distance of a point from a polyline.
double distance_to(const Eigen::Matrix2Xd& profile, const Eigen::Vector2d& p) {
  double best = HUGE_VAL;
  for (Eigen::Index i = 0; i + 1 < profile.cols(); ++i) {
    const Eigen::Vector2d a = profile.col(i), side = profile.col(i + 1) - a;
    const double t = std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (p - a - t * side).norm());
  }
  return best;
}

TEST(Triangulation, ExactSectionsLieOnTheProfileWhereverTheScannerStands) {
  EngravedEdge edge;
  edge.corner = {0.02, 0.01};
  edge.beam_tilt = 0.1;
  edge.surface_curvature = 1 / 528.0;
  const RayTracer part(engraved_mesh(edge, 0.6, 1));
  const Eigen::Matrix2Xd profile = engraved_profile(edge, 0.6);
  RandomStream random(1);
  for (const double turn : {0.0, 0.2}) {
    // Turned within the plane of the section and shifted: the points come back by the same motion.
    const RigidTransform part_from_scanner = {rotation_about(Eigen::Vector3d::UnitY(), turn), {0.03, 0, -0.02}};
    const ScannedSection section = scan_section(exact_scanner(), part, part_from_scanner, random);
    EXPECT_GT(section.points.cols(), 200);
    for (Eigen::Index i = 0; i < section.points.cols(); ++i) {
      const Eigen::Vector3d p = part_from_scanner * Eigen::Vector3d(section.points(0, i), 0, section.points(1, i));
      EXPECT_NEAR(p.y(), 0, 1e-12);
      EXPECT_LT(distance_to(profile, {p.x(), p.z()}), 1e-10);
    }
    EXPECT_EQ(section.points.cols() + static_cast<Eigen::Index>(section.hidden + section.too_flat + section.missed),
              301);
  }
}

TEST(Triangulation, TheSurfaceHidesTheBottomFromACameraOnTheOtherSideOnly) {
  EngravedEdge groove;
  groove.corner = {-0.1, 0};
  groove.groove_width = 0.2;
  groove.depth = 0.2;
  const RayTracer part(engraved_mesh(groove, 0.6, 2));
  RandomStream random(2);
  LineScanner scanner = exact_scanner();
  // The camera across the groove, 45 degrees: it sees of the bottom what is further from its wall than the depth.
  for (const double side : {1.0, -1.0}) {
    scanner.camera = {side * 50, 0, 50};
    const ScannedSection section = scan_section(scanner, part, {}, random);
    EXPECT_GT(section.hidden, 50U);
    for (Eigen::Index i = 0; i < section.points.cols(); ++i) {
      const double x = side * section.points(0, i), z = section.points(1, i);
      if (z > -0.19) continue;
      EXPECT_LT(x, 0.1 + 0.015 - 0.2 + 0.003) << "from its near wall on the bottom is in the shadow";
    }
  }
  // Along the groove nothing is in the way.
  scanner.camera = {0, 30, 49};
  const ScannedSection along = scan_section(scanner, part, {}, random);
  EXPECT_LT(along.hidden, 8U);
  // A camera outside of the drawn groove, nearly level, sees nothing at all.
  scanner.camera = {0, 50, 0.5};
  scanner.largest_angle = 80 * std::numbers::pi / 180;
  EXPECT_EQ(scan_section(scanner, part, {}, random).points.cols(), 0);
}

TEST(Triangulation, NoiseIsAsStatedAndOfTheRayAlone) {
  EngravedEdge flat;
  flat.corner = {0.5, 0};
  const RayTracer part(engraved_mesh(flat, 1, 1));
  LineScanner scanner = exact_scanner();
  scanner.height_noise = 2e-3;
  scanner.across_noise = 1e-3;
  scanner.linearity = 13.6e-3;
  double heights = 0, across = 0;
  std::set<double> means;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    RandomStream random(3, static_cast<std::uint64_t>(run));
    const ScannedSection section = scan_section(scanner, part, {}, random);
    ASSERT_EQ(section.points.cols(), 301);
    const double mean = section.points.row(1).mean();
    EXPECT_LT(std::abs(mean), 13.6e-3 + 1e-3);
    means.insert(mean);
    heights += (section.points.row(1).array() - mean).square().sum() / 300 / kRuns;
    for (Eigen::Index i = 0; i < 301; ++i) {
      const double x = 0.6 * ((static_cast<double>(i) + 0.5) / 301 - 0.5);
      across += (section.points(0, i) - x) * (section.points(0, i) - x) / 301 / kRuns;
    }
  }
  EXPECT_NEAR(std::sqrt(heights), 2e-3, 0.05e-3);
  EXPECT_NEAR(std::sqrt(across), 1e-3, 0.03e-3);
  EXPECT_GT(*means.rbegin() - *means.begin(), 15e-3);  // linearity: all points of a section alike
}

TEST(Triangulation, AnAreaScannerSeesWhatProjectorAndCameraBothSee) {
  // A sphere: a place is seen within the angle of both lines of sight, and never on the far side.
  const TriangleMesh sphere = parts::sphere(12.7, 96, 48);
  const RayTracer scene(sphere);
  AreaScanner scanner;
  const RigidTransform scene_from_scanner = {rotation_about(Eigen::Vector3d::UnitX(), std::numbers::pi), {0, 0, 600}};
  Eigen::Matrix3Xd places(3, 500), normals(3, 500);
  RandomStream random(4);
  for (Eigen::Index i = 0; i < 500; ++i) {
    normals.col(i) = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    places.col(i) = 12.7 * normals.col(i);
  }
  std::vector<Eigen::Index> seen;
  const Eigen::Matrix3Xd points = scan_places(scanner, scene, scene_from_scanner, places, normals, random, &seen);
  ASSERT_EQ(points.cols(), static_cast<Eigen::Index>(seen.size()));
  std::set<Eigen::Index> among(seen.begin(), seen.end());
  const Eigen::Vector3d projector = scene_from_scanner * scanner.projector();
  const Eigen::Vector3d camera = scene_from_scanner * scanner.camera();
  for (Eigen::Index i = 0; i < 500; ++i) {
    const auto cosine = [&](const Eigen::Vector3d& eye) {
      return Eigen::Vector3d(normals.col(i)).dot((eye - places.col(i)).normalized());
    };
    const double least = std::cos(scanner.largest_angle);
    EXPECT_EQ(among.contains(i), cosine(projector) >= least && cosine(camera) >= least) << i;
  }
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Eigen::Vector3d back = scene_from_scanner * Eigen::Vector3d(points.col(static_cast<Eigen::Index>(k)));
    EXPECT_LT((back - places.col(seen[k])).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace abbe
