#include "abbe/formats/shapes/step_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "abbe/formats/files/temporary_file_for_test.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/step_files_for_test.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/surface/mesh_check.h"

namespace abbe {
namespace {

using test::golden_step_file;

constexpr double kPi = std::numbers::pi;

MeshFile read_within(const char* name, double chord_mm) {
  MeshFileOptions options;
  options.step.chord_mm = chord_mm;
  return read_mesh(golden_step_file(name), options);
}

class StepFile : public testing::Test {
 protected:
  void SetUp() override {
    if (step_program().empty()) GTEST_SKIP() << "built without OpenCASCADE";
  }
};

TEST_F(StepFile, ABlockHasItsExactSizeAndVolumeAndTurnsOutwards) {
  const MeshFile file = read_mesh(golden_step_file("block.step"));
  EXPECT_EQ(file.format, "STEP");
  EXPECT_EQ(unit_words(file.unit), "mm (stated by the file)");
  const MeshCheck check = check_mesh(file.mesh);
  EXPECT_TRUE(check.encloses_volume());
  EXPECT_EQ(check.triangles, 12U);
  EXPECT_NEAR(check.volume, 64000, 1e-8);
  EXPECT_NEAR((check.lower - Eigen::Vector3d(-10, -20, -30)).norm(), 0, 1e-12);
  EXPECT_NEAR((check.upper - Eigen::Vector3d(30, 20, 10)).norm(), 0, 1e-12);
  // Each face in its plane: two triangles, one normal.
  EXPECT_EQ(file.faces, 6U);
  std::array<Eigen::Vector3d, 6> sums;
  sums.fill(Eigen::Vector3d::Zero());
  for (Eigen::Index i = 0; i < file.mesh.size(); ++i) {
    const Eigen::Vector3d a = file.mesh.corner(i, 0);
    sums[file.face_of_triangle[static_cast<std::size_t>(i)]] +=
        0.5 * (file.mesh.corner(i, 1) - a).cross(file.mesh.corner(i, 2) - a);
  }
  for (const Eigen::Vector3d& sum : sums) EXPECT_NEAR(sum.norm(), 1600, 1e-9);
}

TEST_F(StepFile, InchesBecomeMillimetres) {
  const MeshFile file = read_mesh(golden_step_file("block_inch.step"));
  EXPECT_EQ(unit_words(file.unit), "inch (stated by the file)");
  EXPECT_NEAR((check_mesh(file.mesh).upper - Eigen::Vector3d(25.4, 50.8, 76.2)).norm(), 0, 1e-9);
}

/// Exact distances of points from the surface of a file, and what it encloses.
struct Exact {
  const char* file;
  double volume, area;
  std::function<double(const Eigen::Vector3d&)> distance;
};

/// Distance to a segment of the half plane (radius, height), which makes the surface when it turns about z.
double distance_to_line(double r, double z, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from, at(r - from.x(), z - from.y());
  return (at - along * std::clamp(at.dot(along) / along.squaredNorm(), 0.0, 1.0)).norm();
}

/// Distance to a surface that turns about z, whose half section has these corners.
std::function<double(const Eigen::Vector3d&)> turned(std::vector<Eigen::Vector2d> section) {
  return [corners = std::move(section)](const Eigen::Vector3d& p) {
    double nearest = 1e300;
    for (std::size_t i = 1; i < corners.size(); ++i) {
      nearest = std::min(nearest, distance_to_line(std::hypot(p.x(), p.y()), p.z(), corners[i - 1], corners[i]));
    }
    return nearest;
  };
}

std::vector<Exact> exact_parts() {
  return {
      {"sphere.step", 4.0 / 3 * kPi * std::pow(12.703, 3), 4 * kPi * 12.703 * 12.703,
       [](const Eigen::Vector3d& p) { return std::abs((p - Eigen::Vector3d(5, 6, 7)).norm() - 12.703); }},
      {"cylinder.step", kPi * 144 * 40, 2 * kPi * (144 + 12 * 40), turned({{0, -15}, {12, -15}, {12, 25}, {0, 25}})},
      {"cone.step", kPi * 100 * 20 / 3, kPi * (100 + 10 * std::hypot(10, 20)), turned({{0, 0}, {10, 0}, {0, 20}})},
      {"torus.step", 2 * kPi * kPi * 25 * 36, 4 * kPi * kPi * 25 * 6,
       [](const Eigen::Vector3d& p) { return std::abs(std::hypot(std::hypot(p.x(), p.y()) - 25, p.z()) - 6); }},
  };
}

TEST_F(StepFile, NoPointOfATriangleIsFartherFromTheExactSurfaceThanTheToleranceAndWhatWasMeasured) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  for (const Exact& part : exact_parts()) {
    for (const double chord : {0.2, 0.02}) {
      SCOPED_TRACE(std::string(part.file) + " within " + std::to_string(chord));
      const MeshFile file = read_within(part.file, chord);
      EXPECT_LE(file.deviation_mm, chord);
      double largest = 0, largest_vertex = 0;
      for (Eigen::Index i = 0; i < file.mesh.size(); ++i) {
        const Eigen::Vector3d a = file.mesh.corner(i, 0), b = file.mesh.corner(i, 1), c = file.mesh.corner(i, 2);
        largest_vertex = std::max(largest_vertex, part.distance(a));
        for (int k = 0; k < 20; ++k) {
          double u = share(random), v = share(random);
          if (u + v > 1) u = 1 - u, v = 1 - v;
          largest = std::max(largest, part.distance(a + u * (b - a) + v * (c - a)));
        }
      }
      EXPECT_LE(largest, chord);
      // What is said is 1.03 times the farthest of 28 points of a triangle.
      EXPECT_LE(largest, file.deviation_mm);
      EXPECT_GE(largest, 0.9 * file.deviation_mm);
      EXPECT_LE(largest_vertex, 1e-9);
      const MeshCheck check = check_mesh(file.mesh);
      EXPECT_TRUE(check.encloses_volume());
      EXPECT_EQ(check.degenerate_triangles, 0U);
      EXPECT_NEAR(check.volume, part.volume, chord * part.area);
      EXPECT_NEAR(check.area, part.area, 0.02 * part.area);
    }
  }
}

TEST_F(StepFile, AFreeFormBladeKeepsTheTolerance) {
  // Against triangles forty times finer: what lies between the two is at most the sum of both tolerances.
  const MeshFile coarse = read_within("blade.step", 0.4), fine = read_within("blade.step", 0.1);
  EXPECT_LE(coarse.deviation_mm, 0.4);
  EXPECT_LE(fine.deviation_mm, 0.1);
  const MeshCheck check = check_mesh(fine.mesh);
  EXPECT_TRUE(check.encloses_volume());
  EXPECT_NEAR(check_mesh(coarse.mesh).volume, check.volume, 0.5 * check.area);
}

TEST_F(StepFile, BoresAreClosedAndFacesOfAnAssemblyStandInTheirPlaces) {
  const MeshCheck bored = check_mesh(read_mesh(golden_step_file("bored_block.step")).mesh);
  EXPECT_TRUE(bored.encloses_volume());
  EXPECT_NEAR(bored.volume, 30 * (1600 - kPi * 100), 0.01 * 2 * kPi * 10 * 30);
  const MeshFile assembly = read_mesh(golden_step_file("assembly.step"));
  const MeshCheck check = check_mesh(assembly.mesh);
  EXPECT_EQ(assembly.faces, 6U + 3 * 3);
  EXPECT_EQ(check.parts, 4U);
  EXPECT_TRUE(check.encloses_volume());
  EXPECT_NEAR(check.volume, 64000 + 3 * kPi * 16 * 10, 3 * 0.01 * 2 * kPi * 4 * 10);
  EXPECT_NEAR((check.upper - Eigen::Vector3d(44, 20, 15)).norm(), 0, 0.01);
}

TEST_F(StepFile, ACountersinkWhoseSeamIsTakenForItsOtherSideIsDivided) {
  test::StepShell shell;
  shell.add_countersink(5, 12);
  const MeshFile file = read_mesh(test::TemporaryFile(shell.text(), ".step").path());
  EXPECT_LE(file.deviation_mm, 0.01);
  EXPECT_NEAR(check_mesh(file.mesh).area, kPi * (12 + 5) * 7 * std::sqrt(2), 0.5);
}

TEST_F(StepFile, TheSameFileGivesTheSameTriangles) {
  const MeshFile one = read_within("torus.step", 0.1), other = read_within("torus.step", 0.1);
  EXPECT_EQ(one.mesh.vertices, other.mesh.vertices);
  EXPECT_EQ(one.mesh.triangles, other.mesh.triangles);
}

}  // namespace
}  // namespace abbe
