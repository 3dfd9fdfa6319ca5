#include "abbe/formats/machine/toml_kind.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

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
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "abbe_toml_kinds";
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
