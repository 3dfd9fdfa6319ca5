#include "abbe/instruments/triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

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
  groove.depth = 0.1;
  const RayTracer part(engraved_mesh(groove, 0.6, 2));
  RandomStream random(2);
  LineScanner scanner = exact_scanner();
  // The camera across the groove, 45 degrees: it sees of the bottom what is further from its wall than the depth.
  for (const double side : {1.0, -1.0}) {
    scanner.camera = {side * 50, 0, 50};
    const ScannedSection section = scan_section(scanner, part, {}, random);
    // The last line of sight touches the rounding of the near edge, of 15 um: on the bottom it is that deep further on.
    const double shadow = 0.1 + 0.015 * (2 - std::numbers::sqrt2) - 0.1;
    double farthest = -HUGE_VAL;
    int on_bottom = 0;
    for (Eigen::Index i = 0; i < section.points.cols(); ++i) {
      const double x = side * section.points(0, i), z = section.points(1, i);
      if (z > -0.09) continue;
      ++on_bottom;
      farthest = std::max(farthest, x);
    }
    EXPECT_GT(on_bottom, 45);
    EXPECT_NEAR(farthest, shadow, 2.5e-3) << "rays are 2 um apart";
    EXPECT_NEAR(static_cast<double>(section.hidden), (0.1 - shadow) / 2e-3, 8);
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
  double heights = 0, across = 0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    RandomStream random(3, static_cast<std::uint64_t>(run));
    const ScannedSection section = scan_section(scanner, part, {}, random);
    ASSERT_EQ(section.points.cols(), 301);
    for (Eigen::Index i = 0; i < 301; ++i) {
      const double x = 0.6 * ((static_cast<double>(i) + 0.5) / 301 - 0.5);
      heights += section.points(1, i) * section.points(1, i) / 301 / kRuns;
      across += (section.points(0, i) - x) * (section.points(0, i) - x) / 301 / kRuns;
    }
  }
  // 12040 readings: 0.65 % of a standard deviation.
  EXPECT_NEAR(std::sqrt(heights), 2e-3, 0.05e-3);
  EXPECT_NEAR(std::sqrt(across), 1e-3, 0.03e-3);
  // Where the same surface is met, the same points: what other rays meet behind an edge does not matter.
  EngravedEdge edge;
  edge.corner = {-0.1, 0};
  edge.groove_width = 0.15;
  edge.depth = 0.3;
  RandomStream first(4), second(4);
  const ScannedSection whole = scan_section(scanner, part, {}, first);
  const ScannedSection cut = scan_section(scanner, RayTracer(engraved_mesh(edge, 1, 1)), {}, second);
  ASSERT_LT(cut.points.cols(), 301);
  EXPECT_LT((whole.points.leftCols(80) - cut.points.leftCols(80)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((whole.points.rightCols(100) - cut.points.rightCols(100)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Triangulation, LinearityIsOneWaveOverTheRangeWithAPhaseOfItsOwnInEachSection) {
  EngravedEdge flat;
  flat.corner = {0.5, 0};
  const RayTracer part(engraved_mesh(flat, 1, 1));
  LineScanner scanner = exact_scanner();
  scanner.linearity = 13.6e-3;
  std::vector<double> at_zero;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const auto deviation = [&](double height) {
      RandomStream random(5, run);
      const ScannedSection section =
          scan_section(scanner, part, RigidTransform::translate(Eigen::Vector3d(0, 0, -height)), random);
      EXPECT_EQ(section.points.cols(), 301);
      const Eigen::ArrayXd off = section.points.row(1).array().transpose() - height;
      EXPECT_LT(off.maxCoeff() - off.minCoeff(), 1e-12);  // all points of one height alike
      return off[0];
    };
    // A sine of one period: a quarter and half of the range on.
    for (const double height : {-3.5, -1.2, 0.0, 1.4}) {
      EXPECT_NEAR(std::hypot(deviation(height), deviation(height + 2)), 13.6e-3, 1e-12);
      if (height >= 0) continue;
      EXPECT_NEAR(deviation(height), -deviation(height + 4), 1e-12);
    }
    at_zero.push_back(deviation(0));
  }
  // 20 phases: some of each sign, and the extremes are met nearly.
  EXPECT_GT(*std::max_element(at_zero.begin(), at_zero.end()), 10e-3);
  EXPECT_LT(*std::min_element(at_zero.begin(), at_zero.end()), -10e-3);
}

/// A sphere of 12.7 mm at the origin under an area scanner 600 mm above it.
struct BallUnderScanner {
  AreaScanner scanner;
  RigidTransform scene_from_scanner = {rotation_about(Eigen::Vector3d::UnitX(), std::numbers::pi), {0, 0, 600}};
  Eigen::Matrix3Xd places = Eigen::Matrix3Xd(3, 500), normals = Eigen::Matrix3Xd(3, 500);

  BallUnderScanner() {
    RandomStream random(4);
    for (Eigen::Index i = 0; i < 500; ++i) {
      normals.col(i) = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
      places.col(i) = 12.7 * normals.col(i);
    }
  }
  Eigen::Vector3d projector() const { return scene_from_scanner * scanner.projector(); }
  Eigen::Vector3d camera() const { return scene_from_scanner * scanner.camera(); }
  bool within_angle(Eigen::Index i) const {
    const auto cosine = [&](const Eigen::Vector3d& eye) {
      return Eigen::Vector3d(normals.col(i)).dot((eye - places.col(i)).normalized());
    };
    const double least = std::cos(scanner.largest_angle);
    return cosine(projector()) >= least && cosine(camera()) >= least;
  }
  /// Scanned places by their number.
  std::map<Eigen::Index, Eigen::Vector3d> scan(const RayTracer& scene) const {
    RandomStream random(6);
    std::vector<Eigen::Index> seen;
    const Eigen::Matrix3Xd points = scan_places(scanner, scene, scene_from_scanner, places, normals, random, &seen);
    std::map<Eigen::Index, Eigen::Vector3d> found;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      found[seen[k]] = scene_from_scanner * Eigen::Vector3d(points.col(static_cast<Eigen::Index>(k)));
    }
    EXPECT_EQ(points.cols(), static_cast<Eigen::Index>(found.size()));
    return found;
  }
};

TEST(Triangulation, AnAreaScannerSeesWhatProjectorAndCameraBothSee) {
  const BallUnderScanner ball;
  // Alone, a place is seen within the angle of both lines of sight, and never on the far side.
  const auto found = ball.scan(RayTracer(parts::sphere(12.7, 96, 48)));
  EXPECT_GT(found.size(), 60U);
  for (Eigen::Index i = 0; i < 500; ++i) EXPECT_EQ(found.contains(i), ball.within_angle(i)) << i;
  for (const auto& [i, point] : found) EXPECT_LT((point - ball.places.col(i)).norm(), 1e-12);
}

TEST(Triangulation, APlateInOneOfTheLinesOfSightHidesWhatLiesBehindIt) {
  const BallUnderScanner ball;
  const TriangleMesh sphere = parts::sphere(12.7, 96, 48);
  const auto free = ball.scan(RayTracer(sphere));
  for (const bool before_projector : {true, false}) {
    // Half way up, from the middle of the lines of sight of one eye outwards; those of the other pass beside it.
    const double outwards = before_projector ? -1 : 1;
    TriangleMesh scene = sphere;
    const Eigen::Index n = sphere.vertices.cols(), m = sphere.triangles.cols();
    scene.vertices.conservativeResize(3, n + 4);
    scene.triangles.conservativeResize(3, m + 2);
    const double edge = 59.5 * outwards, end = 200 * outwards;
    scene.vertices.rightCols(4) << edge, end, end, edge, -100, -100, 100, 100, 300, 300, 300, 300;
    const auto first = static_cast<std::uint32_t>(n);
    scene.triangles.rightCols(2) << first, first, first + 1, first + 2, first + 2, first + 3;
    const auto found = ball.scan(RayTracer(scene));
    const Eigen::Vector3d eye = before_projector ? ball.projector() : ball.camera();
    std::size_t hidden = 0;
    for (const auto& [i, point] : free) {
      const Eigen::Vector3d place = ball.places.col(i);
      const double crossing = place.x() + (300 - place.z()) / (eye.z() - place.z()) * (eye.x() - place.x());
      const bool behind = outwards * crossing > 59.5;
      hidden += behind ? 1 : 0;
      EXPECT_EQ(found.contains(i), !behind) << i << " crosses at " << crossing;
    }
    EXPECT_EQ(found.size(), free.size() - hidden);
    EXPECT_GT(hidden, free.size() / 5);
    EXPECT_LT(hidden, free.size() * 4 / 5);
  }
}

TEST(Triangulation, NoiseOfAnAreaScannerIsAsStatedAndOfThePlaceAlone) {
  BallUnderScanner ball;
  const RayTracer scene(parts::sphere(12.7, 96, 48));
  ball.scanner.noise = 0.02;
  const auto found = ball.scan(scene);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const auto& [i, point] : found) {
    squares += (point - ball.places.col(i)).cwiseAbs2() / static_cast<double>(found.size());
  }
  // Standard deviations of that many readings: 1 / sqrt(2 n), four times.
  const double chance = 4 / std::sqrt(2.0 * static_cast<double>(found.size()));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::sqrt(squares[k]) / 0.02, 1, chance);
  // Fewer places are seen at a smaller angle, those with the same noise.
  ball.scanner.largest_angle = 40 * std::numbers::pi / 180;
  const auto fewer = ball.scan(scene);
  EXPECT_LT(fewer.size(), found.size());
  EXPECT_FALSE(fewer.empty());
  for (const auto& [i, point] : fewer) EXPECT_LT((point - found.at(i)).norm(), 1e-12);
}

}  // namespace
}  // namespace abbe
