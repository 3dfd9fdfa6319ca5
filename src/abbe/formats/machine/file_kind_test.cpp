#include "abbe/formats/machine/file_kind.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "abbe/formats/files/temporary_file_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using test::TemporaryFile;
using testing::HasSubstr;

TEST(TheKindOfAFile, IsToldByItsName) {
  for (const char* const name : {"a.stl", "b.OBJ", "c.step", "d.stp", "e.ply", "f.xyz", "g.csv", "h.pcd", "i.e57"}) {
    EXPECT_TRUE(is_geometry_file(name)) << name;
    EXPECT_FALSE(is_frozen_file(name)) << name;
  }
  for (const char* const name : {"mill.machine.toml", "mill.abbec", "stl", ""}) EXPECT_FALSE(is_geometry_file(name));
  EXPECT_TRUE(is_frozen_file("mill.abbec"));
  EXPECT_FALSE(is_frozen_file("abbec"));
}

TEST(TheKindOfAFile, SaysWhetherThereAreOnlyPoints) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_TRUE(has_points_only("points.xyz"));
  const TemporaryFile points(header + "end_header\n" + corners, "_points.ply");
  EXPECT_TRUE(has_points_only(points.path().string()));
  const TemporaryFile faces(
      header + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + corners + "3 0 1 2\n",
      "_faces.ply");
  EXPECT_FALSE(has_points_only(faces.path().string()));
  const TemporaryFile object("v 0 0 0\nv 1 0 0\nv 0 1 0\n", ".obj");
  EXPECT_FALSE(has_points_only(object.path().string())) << "it is read as a mesh, which says that there is no face";
  const TemporaryFile damaged(header, "_damaged.ply");
  EXPECT_THAT(message_of([&] { has_points_only(damaged.path().string()); }), HasSubstr("_damaged.ply"));
}

class TomlKinds : public testing::Test {
 protected:
  TomlKinds() { std::filesystem::create_directories(folder_); }
  ~TomlKinds() override { std::filesystem::remove_all(folder_); }
  TomlKinds(const TomlKinds&) = delete;
  TomlKinds& operator=(const TomlKinds&) = delete;

  std::string file(const std::string& name, const std::string& contents) const {
    std::ofstream(folder_ / name) << contents;
    return (folder_ / name).string();
  }
  std::string refusal(const std::string& name, const std::string& contents) const {
    return message_of([&] { require_machine_file(file(name, contents)); });
  }

 private:
  // Tests may run at the same time.
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("abbe_toml_kinds_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(TomlKinds, AStudyIsToldByItsNameOrItsSetUps) {
  EXPECT_TRUE(is_study_file(file("a.study.toml", "#")));
  EXPECT_TRUE(is_study_file(file("study.toml", "#")));
  EXPECT_TRUE(is_study_file(file("b.toml", "name = \"mill\"\n[[setup]]\n")));
  EXPECT_FALSE(is_study_file(file("c.toml", "chain = \"w b X t\"\n# [[setup]]\n")));
  EXPECT_FALSE(is_study_file(file("d.csv", "[[setup]]\n")));
}

TEST_F(TomlKinds, OtherKindsAreRefusedWithWhatTakesThem) {
  EXPECT_THAT(refusal("a.toml", "[[motion]]\n"), HasSubstr("this is an errors file; expected --machine"));
  EXPECT_THAT(refusal("placement.toml", "#"), HasSubstr("abbe path --placement"));
  EXPECT_THAT(refusal("b.positioning.toml", "#"), HasSubstr("abbe position"));
  EXPECT_THAT(refusal("part.step.bak", "ISO-10303-21;\n"), HasSubstr("its name does not tell its kind"));
  EXPECT_NO_THROW(require_machine_file(file("mill.toml", "chain = \"w b X t\"\n")));
}

}  // namespace
}  // namespace abbe
