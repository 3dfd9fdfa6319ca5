#include "abbe/formats/shapes/step_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

StepMesh step_block() {
  StepMesh mesh;
  mesh.mesh = block_for_test({0, 0, 0}, {1, 2, 3});
  mesh.faces = 6;
  mesh.solids = 1;
  for (Eigen::Index i = 0; i < mesh.mesh.size(); ++i) {
    mesh.face_of_triangle.push_back(static_cast<std::uint32_t>(i) / 2);
  }
  mesh.unit = "inch";
  mesh.deviation_mm = 0.1;
  mesh.chord_mm = 0.3;
  mesh.size_mm = 40;
  mesh.left_out = {"#78 (cone) could not be converted"};
  mesh.left_out_share = 0.25;
  mesh.notes = {"a note", "bytes that are not text: \xff"};
  return mesh;
}

TEST(StepMesh, ComesThroughWithTheSameBits) {
  const StepMesh given = step_block();
  const StepMesh read = parse_step_mesh(step_mesh_bytes(given), "part.step");
  EXPECT_EQ(read.mesh.vertices, given.mesh.vertices);
  EXPECT_EQ(read.mesh.triangles, given.mesh.triangles);
  EXPECT_EQ(read.face_of_triangle, given.face_of_triangle);
  EXPECT_EQ(read.faces, 6U);
  EXPECT_EQ(read.solids, 1U);
  EXPECT_EQ(read.unit, "inch");
  EXPECT_EQ(read.deviation_mm, 0.1);
  EXPECT_EQ(read.chord_mm, 0.3);
  EXPECT_EQ(read.size_mm, 40);
  EXPECT_EQ(read.left_out, given.left_out);
  EXPECT_EQ(read.left_out_share, 0.25);
  EXPECT_EQ(read.notes[0], "a note");
}

TEST(StepMesh, AnyCutIsRefused) {
  const std::string bytes = step_mesh_bytes(step_block());
  for (std::size_t length = 0; length < bytes.size(); length += 7) {
    EXPECT_THAT(message_of([&] { parse_step_mesh(bytes.substr(0, length), "part.step"); }),
                testing::HasSubstr("part.step: abbe-step gave no mesh"));
  }
  EXPECT_THAT(message_of([&] { parse_step_mesh(bytes + "x", "part.step"); }),
              testing::HasSubstr("the length does not fit"));
}

TEST(StepMesh, WhatCannotBeAMeshIsRefused) {
  const auto message = [](const StepMesh& mesh) {
    return message_of([&] { parse_step_mesh(step_mesh_bytes(mesh), "part.step"); });
  };
  StepMesh mesh = step_block();
  mesh.mesh.triangles(2, 11) = 8;
  EXPECT_THAT(message(mesh), testing::HasSubstr("a vertex that does not exist"));
  mesh = step_block();
  mesh.face_of_triangle[3] = 6;
  EXPECT_THAT(message(mesh), testing::HasSubstr("a face that does not exist"));
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), 1.1e9}) {
    mesh = step_block();
    mesh.mesh.vertices(1, 7) = wrong;
    EXPECT_THAT(message(mesh), testing::HasSubstr("not finite or too large"));
  }
  mesh = step_block();
  mesh.mesh.triangles.resize(3, 0);
  mesh.face_of_triangle.clear();
  EXPECT_THAT(message(mesh), testing::HasSubstr("no triangles"));
  mesh = step_block();
  mesh.mesh.vertices.resize(3, 0);
  EXPECT_THAT(message(mesh), testing::HasSubstr("no vertices"));
  std::string other = step_mesh_bytes(step_block());
  other.replace(other.find("mesh 3"), 6, "mesh 2");
  EXPECT_THAT(message_of([&] { parse_step_mesh(other, "part.step"); }), testing::HasSubstr("another version"));
}

TEST(StepMesh, CountsBeyondAllMemoryAreRefused) {
  const std::string head =
      R"({"kind":"abbe-step mesh 3","vertices":768614336404564651,"triangles":1,"faces":1,"solids":1,"unit":"",)"
      R"("deviation_mm":0,"chord_mm":1,"size_mm":1,"left_out":[],"left_out_share":-1,"notes":[]})";
  EXPECT_THAT(message_of([&] { parse_step_mesh(head + "\n" + std::string(40, '\0'), "part.step"); }),
              testing::HasSubstr("the length does not fit"));
}

TEST(StepMesh, TheChordFollowsTheSizeOfThePart) {
  EXPECT_DOUBLE_EQ(default_step_chord(0.5), 0.0005);
  EXPECT_DOUBLE_EQ(default_step_chord(10), 0.01);
  EXPECT_DOUBLE_EQ(default_step_chord(100), 0.01);
  EXPECT_DOUBLE_EQ(default_step_chord(400), 0.04);
  EXPECT_DOUBLE_EQ(default_step_chord(5000), 0.1);
}

TEST(StepMesh, ProgressComesThroughAsALine) {
  const auto read = parse_step_progress(step_progress_line({"dividing faces", 3, 7}));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->what, "dividing faces");
  EXPECT_EQ(read->done, 3U);
  EXPECT_EQ(read->total, 7U);
  EXPECT_FALSE(parse_step_progress("progress"));
  EXPECT_FALSE(parse_step_progress("progress 3"));
  EXPECT_FALSE(parse_step_progress("a file that is not a STEP file"));
}

TEST(StepMesh, CountsAreWholeNumbers) {
  for (const char* wrong : {"1e300", "-1", "2.0", "\"8\"", "null"}) {
    std::string bytes = step_mesh_bytes(step_block());
    bytes.replace(bytes.find("\"vertices\":8") + 11, 1, wrong);
    EXPECT_THAT(message_of([&] { parse_step_mesh(bytes, "part.step"); }),
                testing::HasSubstr("the first line is not understood"))
        << wrong;
  }
}

}  // namespace
}  // namespace abbe
