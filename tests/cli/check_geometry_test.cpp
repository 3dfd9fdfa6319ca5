// `abbe check` of meshes and point clouds.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 0\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
}

const std::string kA = "0 0 0", kB = "1 0 0", kC = "0 1 0", kD = "0 0 1";

std::string tetrahedron() { return facet(kA, kC, kB) + facet(kA, kB, kD) + facet(kA, kD, kC) + facet(kB, kC, kD); }

class CheckGeometry : public CommandTest {
 protected:
  nlohmann::json checked(const std::string& file, int exit_code = ExitCode::done) const {
    const CommandResult result = abbe({"check", file, "--json"});
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    return nlohmann::json::parse(result.out);
  }
};

TEST_F(CheckGeometry, AClosedMeshHasAreaVolumeAndABox) {
  folder.write("part.stl", "solid\n" + tetrahedron() + "endsolid\n");
  const nlohmann::json json = checked("part.stl");
  EXPECT_EQ(json["kind"], "mesh");
  EXPECT_EQ(json["file_unit_is"], "assumed");
  EXPECT_EQ(json["triangles"], 4);
  EXPECT_EQ(json["vertices"], 4);
  EXPECT_EQ(json["rims"], 0);
  EXPECT_EQ(json["sound"], true);
  EXPECT_NEAR(json["volume_mm3"].get<double>(), 1.0 / 6, 1e-15);
  EXPECT_NEAR(json["area_mm2"].get<double>(), 1.5 + std::sqrt(3) / 2, 1e-14);
  const CommandResult inches = abbe({"check", "part.stl", "--unit", "inch"});
  EXPECT_EQ(inches.exit_code, ExitCode::done);
  EXPECT_THAT(inches.out, HasSubstr("inch (as given)"));
  EXPECT_THAT(inches.out, HasSubstr("(25.4, 25.4, 25.4) mm"));
}

TEST_F(CheckGeometry, AHoleIsCountedAndIsNoError) {
  folder.write("open.stl", "solid\n" + facet(kA, kC, kB) + facet(kA, kB, kD) + facet(kA, kD, kC) + "endsolid\n");
  const nlohmann::json json = checked("open.stl");
  EXPECT_EQ(json["border_edges"], 3);
  EXPECT_EQ(json["rims"], 1);
  EXPECT_EQ(json["closed"], false);
  EXPECT_TRUE(json["volume_mm3"].is_null());
}

TEST_F(CheckGeometry, WhatDoesNotTellInsideFromOutsideIsExitCodeOne) {
  folder.write("turned.stl", "solid\n" + facet(kA, kB, kC) + facet(kA, kB, kD) + facet(kA, kD, kC) + facet(kB, kC, kD) +
                                 "endsolid\n");
  EXPECT_EQ(checked("turned.stl", ExitCode::computation_says_no)["turned_edges"], 3);
  folder.write("inside_out.stl", "solid\n" + facet(kA, kB, kC) + facet(kA, kD, kB) + facet(kA, kC, kD) +
                                     facet(kB, kD, kC) + "endsolid\n");
  EXPECT_THAT(checked("inside_out.stl", ExitCode::computation_says_no)["verdict"].get<std::string>(),
              HasSubstr("inside out"));
  folder.write("twice.stl", "solid\n" + tetrahedron() + facet(kA, kC, kB) + "endsolid\n");
  const nlohmann::json twice = checked("twice.stl", ExitCode::computation_says_no);
  EXPECT_EQ(twice["duplicate_triangles"], 1);
  EXPECT_EQ(twice["branching_edges"], 3);
}

TEST_F(CheckGeometry, PointsOfACloudAreCountedAndMeasured) {
  folder.write("scan.csv", "x_mm,y_mm,z_um\n0,0,0\n1,2,3000\n0,0,0\n2,4,0\n");
  const nlohmann::json json = checked("scan.csv");
  EXPECT_EQ(json["kind"], "point_cloud");
  EXPECT_EQ(json["points"], 4);
  EXPECT_EQ(json["repeated_points"], 1);
  EXPECT_EQ(json["file_unit_is"], "stated");
  EXPECT_EQ(json["upper_mm"], nlohmann::json({2, 4, 3}));
  EXPECT_EQ(json["centroid_mm"], nlohmann::json({0.75, 1.5, 0.75}));
  folder.write(
      "points.ply",
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
      "1 2 3\n4 5 6\n");
  EXPECT_EQ(checked("points.ply")["kind"], "point_cloud");
  const CommandResult words = abbe({"check", "scan.csv"});
  EXPECT_THAT(words.out, HasSubstr("repeated points        1"));
}

TEST_F(CheckGeometry, AStepFileSaysHowNearItsTrianglesAre) {
  const std::filesystem::path program = std::filesystem::path(ABBE_COMMAND).parent_path() / "abbe-step";
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "built without OpenCASCADE";
  const std::string part = std::string(ABBE_SOURCE_DIR "/tests/golden/step/cylinder.step");
  const CommandResult result = abbe({"check", part, "--json", "--chord-mm", "0.1"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["format"], "STEP");
  EXPECT_EQ(json["faces"], 3);
  EXPECT_LE(json["deviation_mm"].get<double>(), 0.1);
  const CommandResult refused = abbe({"check", part}, {"ABBE_STEP_PROGRAM=/nowhere"});
  EXPECT_EQ(refused.exit_code, ExitCode::bad_input);
  EXPECT_THAT(refused.err, HasSubstr("ABBE_STEP_PROGRAM names /nowhere, which is not a program"));
}

TEST_F(CheckGeometry, DamagedFilesAndOptionsThatDoNotFitAreRefused) {
  folder.write("part.stl", "solid a\nfacet normal 0 0 1\n outer loop\n vertex 0 0");
  const CommandResult damaged = abbe({"check", "part.stl"});
  EXPECT_EQ(damaged.exit_code, ExitCode::bad_input);
  EXPECT_THAT(damaged.err, HasSubstr("part.stl:4"));
  folder.write("whole.stl", "solid\n" + tetrahedron() + "endsolid\n");
  EXPECT_THAT(abbe({"check", "whole.stl", "--unit", "cubit"}).err, HasSubstr("--unit: 'cubit' is not a unit"));
  EXPECT_THAT(abbe({"check", "whole.stl", "--errors", "e.toml"}).err,
              HasSubstr("--errors: a mesh or a point cloud has no"));
  EXPECT_THAT(abbe({"check", "--machine", "m.toml", "--unit", "mm"}).err,
              HasSubstr("--unit: a machine file states its units"));
}

}  // namespace
}  // namespace abbe
