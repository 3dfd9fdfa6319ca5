// Damaged STEP files, and what can go wrong with the program that reads them: an InputError, never a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "abbe/formats/message_of.h"
#include "abbe/formats/replaced_text_for_test.h"
#include "abbe/formats/step_file.h"
#include "abbe/formats/step_files_for_test.h"
#include "abbe/formats/text_file.h"

namespace abbe {
namespace {

using test::golden_step_file;
using test::replaced;
using testing::EndsWith;
using testing::HasSubstr;

/// A file that is gone after the test; tests of one program may run side by side.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& contents, const std::string& ending)
      : path_(std::filesystem::path(testing::TempDir()) /
              (std::string("abbe_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ending)) {
    std::ofstream(path_, std::ios::binary) << contents;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string message_of_step(const std::string& contents) {
  const TemporaryFile file(contents, ".step");
  std::string text = message_of([&] { read_mesh(file.path()); });
  EXPECT_THAT(text, testing::StartsWith(file.path().string()));
  return text;
}

class DamagedStepFile : public testing::Test {
 protected:
  void SetUp() override {
    if (step_program().empty()) GTEST_SKIP() << "built without OpenCASCADE";
  }
  std::string sphere_ = read_text_file(golden_step_file("sphere.step"));
};

TEST_F(DamagedStepFile, SaysWhatIsWrongWithIt) {
  EXPECT_THAT(message_of_step(""), EndsWith("the file is empty"));
  EXPECT_THAT(message_of_step("solid of something else"),
              EndsWith("this is no STEP file; expected a first line 'ISO-10303-21;'"));
  EXPECT_THAT(message_of_step(sphere_.substr(0, sphere_.size() / 2)),
              EndsWith("the file ends early; expected a last line 'END-ISO-10303-21;'"));
  EXPECT_THAT(message_of_step("ISO-10303-21;\n\xff\x01 garbage\nEND-ISO-10303-21;\n"),
              HasSubstr("line 3: Incorrect syntax"));
  EXPECT_THAT(message_of_step("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
              HasSubstr("Incorrect syntax"));
}

TEST_F(DamagedStepFile, NumbersThatAreNoneAreNotTakenAsZero) {
  EXPECT_THAT(message_of_step(replaced(sphere_, "12.703", "12..703,,")),
              HasSubstr("#22 (SphericalSurface): Count of Parameters"));
  EXPECT_THAT(message_of_step(replaced(sphere_, "12.703", "nan")), HasSubstr("#22 (SphericalSurface): Parameter"));
  EXPECT_THAT(message_of_step(replaced(sphere_, "12.703", "1.E+300")), HasSubstr("the shape reaches beyond 1e+09 mm"));
  EXPECT_THAT(message_of_step(replaced(sphere_, "12.703", "-5.")),
              HasSubstr("of the file's faces could not be converted"));
  EXPECT_THAT(message_of_step(replaced(sphere_, "12.703", "1.E+8")),
              HasSubstr("too much for a chord tolerance of 0.01 mm; expected a chord tolerance of at least"));
}

TEST_F(DamagedStepFile, AFaceIsNotLostInSilence) {
  EXPECT_THAT(message_of_step(replaced(read_text_file(golden_step_file("block.step")), "PLANE(", "PLONE(")),
              HasSubstr("#17 (AdvancedFace)"));
}

TEST_F(DamagedStepFile, IsRefusedOrReadButNeverStopsUs) {
  std::mt19937_64 random(17);
  for (int i = 0; i < 12; ++i) {
    std::string damaged = sphere_;
    for (int k = 0; k < 4; ++k) damaged[600 + random() % (damaged.size() - 700)] = "0#,().$'-9"[random() % 10];
    const TemporaryFile file(damaged, ".step");
    try {
      MeshFileOptions options;
      options.step.chord_mm = 0.5;
      EXPECT_TRUE(read_mesh(file.path(), options).mesh.vertices.allFinite());
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(file.path().string()));
    }
  }
}

TEST_F(DamagedStepFile, UnitsAndTolerancesThatMakeNoSenseAreRefused) {
  MeshFileOptions options;
  options.unit = FileLength::inch;
  EXPECT_THAT(message_of([&] { read_mesh(golden_step_file("block.step"), options); }),
              EndsWith("unit: a STEP file states its unit itself; expected no unit"));
  options.unit.reset();
  options.step.chord_mm = 0;
  EXPECT_EQ(message_of([&] { read_mesh(golden_step_file("block.step"), options); }),
            "chord_mm: is 0; expected a length above zero in mm");
}

/// Another program in the place of abbe-step.
class StepProgram : public testing::Test {
 protected:
  void TearDown() override { ::unsetenv("ABBE_STEP_PROGRAM"); }

  static std::string message_with(const std::string& script, double most_seconds = 3600) {
    const TemporaryFile program("#!/bin/sh\n" + script, ".sh");
    std::filesystem::permissions(program.path(), std::filesystem::perms::owner_all);
    ::setenv("ABBE_STEP_PROGRAM", program.path().c_str(), 1);
    MeshFileOptions options;
    options.step.most_seconds = most_seconds;
    return message_of([&] { read_mesh(golden_step_file("block.step"), options); });
  }
};

TEST_F(StepProgram, ThatIsMissingIsSaid) {
  ::setenv("ABBE_STEP_PROGRAM", "/nowhere/abbe-step", 1);
  EXPECT_THAT(
      message_of([] { read_mesh(golden_step_file("block.step")); }),
      EndsWith("ABBE_STEP_PROGRAM names /nowhere/abbe-step, which is no program; expected the program abbe-step, or "
               "no such variable"));
}

TEST_F(StepProgram, ThatCrashesIsAnErrorAboutTheFile) {
  EXPECT_THAT(message_with("kill -SEGV $$\n"),
              HasSubstr("block.step: OpenCASCADE stopped at the file (Segmentation fault)"));
}

TEST_F(StepProgram, ThatDoesNotEndIsKilled) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(message_with("exec sleep 600\n", 0.2), HasSubstr("OpenCASCADE was not done with the file after 0.2 s"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
}

TEST_F(StepProgram, ThatSaysNothingOrTooMuchIsRefused) {
  EXPECT_THAT(message_with("exit 0\n"), HasSubstr("abbe-step gave no mesh: no first line"));
  EXPECT_THAT(message_with("echo '{}'\n"), HasSubstr("abbe-step gave no mesh: the first line is not understood"));
  EXPECT_THAT(message_with("exit 1\n"), HasSubstr("OpenCASCADE could not read the file"));
  EXPECT_THAT(message_with("echo a reason >&2; echo something else >&2; exit 3\n"),
              EndsWith("a reason; expected something else"));
}

TEST_F(StepProgram, GetsNamesAsTheyAre) {
  EXPECT_THAT(message_with("echo \"$1\" >&2; exit 2\n"),
              HasSubstr(golden_step_file("block.step").string() + "; expected"));
}

}  // namespace
}  // namespace abbe
