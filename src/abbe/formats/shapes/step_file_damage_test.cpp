// Damaged STEP files, and what can go wrong with the program that reads them: an InputError, never a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "abbe/formats/files/temporary_file_for_test.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/step_file.h"
#include "abbe/formats/shapes/step_files_for_test.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"

namespace abbe {
namespace {

using test::golden_step_file;
using test::replaced;
using test::TemporaryFile;
using testing::EndsWith;
using testing::HasSubstr;

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
              EndsWith("this is not a STEP file; expected a first line 'ISO-10303-21;'"));
  EXPECT_THAT(message_of_step(sphere_.substr(0, sphere_.size() / 2)),
              EndsWith("the file ends early; expected a last line 'END-ISO-10303-21;'"));
  EXPECT_THAT(message_of_step("ISO-10303-21;\n\xff\x01 garbage\nEND-ISO-10303-21;\n"),
              HasSubstr("line 3: Incorrect syntax"));
  EXPECT_THAT(message_of_step("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
              HasSubstr("Incorrect syntax"));
}

TEST_F(DamagedStepFile, NumbersThatAreNoneAreNotTakenAsZero) {
  EXPECT_THAT(
      message_of_step(replaced(sphere_, "12.703", "12..703,,")),
      testing::ContainsRegex("face #[0-9]+ \\(SphericalSurface\\) refers to #22 \\(SphericalSurface\\): Count of "
                             "Parameters.*; expected faces that can be read, or --leave-out-faces"));
  EXPECT_THAT(message_of_step(replaced(sphere_, "12.703", "nan")), HasSubstr("#22 (SphericalSurface): Parameter"));
  EXPECT_THAT(message_of_step(replaced(sphere_, "12.703", "1.E+300")), HasSubstr("the shape reaches beyond 1e+09 mm"));
  EXPECT_THAT(message_of_step(replaced(sphere_, "12.703", "-5.")),
              HasSubstr("(SphericalSurface) could not be converted; expected faces that can be read, or --leave-out"));
  const TemporaryFile large(replaced(sphere_, "12.703", "1.E+8"), ".large.step");
  MeshFileOptions options;
  options.step.chord_mm = 0.01;
  EXPECT_THAT(message_of([&] { read_mesh(large.path(), options); }),
              HasSubstr("too much for a chord tolerance of 0.01 mm; expected a chord tolerance of at least"));
}

TEST_F(DamagedStepFile, AFaceIsNotLostInSilence) {
  EXPECT_THAT(message_of_step(replaced(read_text_file(golden_step_file("block.step")), "PLANE(", "PLONE(")),
              HasSubstr("#17 (AdvancedFace)"));
}

TEST_F(DamagedStepFile, AFaceThatCannotBeReadIsLeftOutOnRequest) {
  const TemporaryFile file(replaced(read_text_file(golden_step_file("block.step")), "#32 = PLANE(", "#32 = PLONE("),
                           ".step");
  MeshFileOptions options;
  options.step.leave_out_faces = true;
  const MeshFile read = read_mesh(file.path(), options);
  ASSERT_EQ(read.left_out.size(), 1U);
  EXPECT_THAT(read.left_out[0], testing::StartsWith("#17 (AdvancedFace): "));
  EXPECT_FALSE(read.left_out_share);
  EXPECT_EQ(read.mesh.size(), 10);
}

TEST_F(DamagedStepFile, WhereAllFacesAreLeftOutThatIsSaid) {
  MeshFileOptions options;
  options.step.leave_out_faces = true;
  const TemporaryFile unread(replaced(sphere_, "12.703", "12..703,,"), ".step");
  EXPECT_THAT(message_of([&] { read_mesh(unread.path(), options); }), HasSubstr("no face of the file can be read: #"));
  test::StepShell shell;
  shell.add_open_polygon({{10, 10}, {10, 0}, {0, 0}}, 0);
  shell.add_open_polygon({{30, 10}, {30, 0}, {20, 0}}, 0);
  const TemporaryFile undivided(shell.text(), ".undivided.step");
  EXPECT_THAT(message_of([&] { read_mesh(undivided.path(), options); }),
              testing::ContainsRegex("no face of the file could be divided: #[0-9]+ .*; #[0-9]+ "));
}

TEST_F(DamagedStepFile, WhereNoFaceHasAnAreaThatIsSaid) {
  test::StepShell shell;
  shell.add_polygon({{0, 0}, {10, 0}}, 0);
  EXPECT_THAT(message_of_step(shell.text()), HasSubstr("no face of the file has an area"));
}

TEST_F(DamagedStepFile, AFaceThatNothingRefersToIsNotMissed) {
  const TemporaryFile file(replaced(read_text_file(golden_step_file("block.step")), "#26 = ",
                                    "#9000 = ADVANCED_FACE('',(),#9001,.T.);\n"
                                    "#9001 = SPHERICAL_SURFACE('',#33,1.,2.);\n#26 = "),
                           ".step");
  MeshFileOptions options;
  for (const bool leave_out : {false, true}) {
    options.step.leave_out_faces = leave_out;
    const MeshFile read = read_mesh(file.path(), options);
    EXPECT_TRUE(read.left_out.empty());
    EXPECT_EQ(read.mesh.size(), 12);
    EXPECT_THAT(read.notes, testing::Contains("1 entity of parameter-space curves (PCURVE) or of unused faces was not "
                                              "understood"));
  }
}

TEST_F(DamagedStepFile, AParameterSpaceCurveIsNoted) {
  const TemporaryFile file(
      replaced(read_text_file(golden_step_file("block.step")), "PCURVE('',#32,#37)", "PCURVE('',#32)"), ".step");
  const MeshFile read = read_mesh(file.path());
  EXPECT_THAT(read.notes,
              testing::Contains(HasSubstr("1 entity of parameter-space curves (PCURVE) or of unused faces was not")));
  EXPECT_EQ(read.mesh.size(), 12);
}

TEST_F(DamagedStepFile, GeometryInAnotherFileIsMissedWhateverTheLettersOfItsExtension) {
  const TemporaryFile file(replaced(read_text_file(golden_step_file("block.step")), "#26 = ",
                                    "#9000 = DOCUMENT_FILE('OTHER.STP','',$,#9001,'',$);\n"
                                    "#9001 = DOCUMENT_TYPE('part');\n#26 = "),
                           ".step");
  EXPECT_THAT(read_mesh(file.path()).notes,
              testing::Contains(HasSubstr("what stands in other files is missing: OTHER.STP")));
}

TEST_F(DamagedStepFile, FacesThatNoAlgorithmDividesAreGivenUpAtOnce) {
  // The open face makes OpenCASCADE divide all faces again along finer edges.
  test::StepShell shell;
  shell.add_open_polygon({{10, 10}, {10, 0}, {0, 0}}, 0);
  shell.add_polygon({{20, 0}, {30, 0}, {30, 10}, {20, 10}}, 0);
  for (int i = 0; i < 24; ++i) shell.add_polygon_across({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0);
  const TemporaryFile file(shell.text(), ".step");
  MeshFileOptions options;
  options.step.leave_out_faces = true;
  options.step.most_seconds = 6;
  const MeshFile read = read_mesh(file.path(), options);
  EXPECT_EQ(read.mesh.size(), 2);
  ASSERT_EQ(read.left_out.size(), 1U);
  EXPECT_THAT(read.left_out[0], HasSubstr("divided into triangles: its edges cross one another or do not close"));
  EXPECT_THAT(read.notes, testing::Contains(HasSubstr("24 faces have no area")));
}

TEST_F(DamagedStepFile, AFaceWithoutAreaIsNoneThatIsMissed) {
  test::StepShell shell;
  shell.add_polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0);
  shell.add_polygon({{0, 0}, {10, 0}}, 0);
  const TemporaryFile file(shell.text(), ".step");
  const MeshFile read = read_mesh(file.path());
  EXPECT_EQ(read.mesh.size(), 2);
  EXPECT_TRUE(read.left_out.empty());
  EXPECT_THAT(read.notes, testing::Contains(HasSubstr("1 face has no area")));
}

TEST_F(DamagedStepFile, EdgesBesideAFaceAreSaidAndRefusedOnlyWhereAToleranceIsGiven) {
  const TemporaryFile file(replaced(read_text_file(golden_step_file("cylinder.step")),
                                    "CYLINDRICAL_SURFACE('',#32,12.)", "CYLINDRICAL_SURFACE('',#32,12.05)"),
                           ".step");
  MeshFileOptions options;
  const MeshFile read = read_mesh(file.path(), options);
  EXPECT_THAT(read.notes, testing::Contains(HasSubstr("the file's own edges lie up to 0.05 mm beside it")));
  EXPECT_GE(read.deviation_mm, 0.05);
  EXPECT_LE(read.deviation_mm, 0.07);
  options.step.chord_mm = 0.01;
  EXPECT_THAT(message_of([&] { read_mesh(file.path(), options); }),
              testing::ContainsRegex("face #[0-9]+ \\(cylinder about \\(0, 0, 5\\) mm\\) is up to 0.05.* mm off"));
}

TEST_F(DamagedStepFile, AFaceThatTakesTooLongIsNamed) {
  MeshFileOptions options;
  // The face takes about four times its limit, a third of that of the file. OpenCASCADE looks at the clock all the
  // while but for the first second, which becomes several where other programs run.
  options.step.chord_mm = 7e-4;
  options.step.most_seconds = 9;
  EXPECT_THAT(message_of([&] { read_mesh(golden_step_file("sphere.step"), options); }),
              HasSubstr("(sphere about (5, 6, 7) mm) was not divided into triangles within 3 s"));
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
  using Heard = std::function<void(const std::string& what, std::size_t done, std::size_t total)>;

  void TearDown() override { ::unsetenv("ABBE_STEP_PROGRAM"); }

  static void read_with(const std::string& script, double most_seconds = 3600, Heard progress = {}) {
    const TemporaryFile program("#!/bin/sh\n" + script, ".sh");
    std::filesystem::permissions(program.path(), std::filesystem::perms::owner_all);
    ::setenv("ABBE_STEP_PROGRAM", program.path().c_str(), 1);
    MeshFileOptions options;
    options.step.most_seconds = most_seconds;
    options.step.progress = std::move(progress);
    read_mesh(golden_step_file("block.step"), options);
  }

  static std::string message_with(const std::string& script, double most_seconds = 3600, Heard progress = {}) {
    return message_of([&] { read_with(script, most_seconds, std::move(progress)); });
  }
};

TEST_F(StepProgram, ThatIsMissingIsSaid) {
  ::setenv("ABBE_STEP_PROGRAM", "/nowhere/abbe-step", 1);
  EXPECT_THAT(
      message_of([] { read_mesh(golden_step_file("block.step")); }),
      EndsWith("ABBE_STEP_PROGRAM names /nowhere/abbe-step, which is not a program; expected the program abbe-step, or "
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

TEST_F(StepProgram, SaysHowFarItIsAndWhatItWasAtWhenItEnded) {
  std::string heard;
  const std::string message =
      message_with("echo 'progress 2 7 dividing faces' >&2; exec sleep 600\n", 0.2,
                   [&](const std::string& what, std::size_t done, std::size_t total) {
                     heard += what + " " + std::to_string(done) + " of " + std::to_string(total) + ";";
                   });
  EXPECT_EQ(heard, "dividing faces 2 of 7;");
  EXPECT_THAT(message,
              HasSubstr("was not done with the file after 0.2 s (it was dividing faces, 2 of 7 done); expected "
                        "a coarser tolerance (--chord-mm) or more time (--step-seconds)"));
}

TEST_F(StepProgram, ThatGivesUpByItselfIsSaidToHaveBeenAtWhatItWasAt) {
  std::string heard;
  const std::string message = message_with("echo 'progress 2 7 dividing faces' >&2; exit 3\n", 60,
                                           [&](const std::string& what, std::size_t, std::size_t) { heard = what; });
  EXPECT_EQ(heard, "dividing faces");
  EXPECT_THAT(message, HasSubstr("was not done with the file after 60 s (it was dividing faces, 2 of 7 done); expected "
                                 "a coarser tolerance (--chord-mm) or more time (--step-seconds)"));
}

TEST_F(StepProgram, IsEndedIfItsProgressCannotBePassedOn) {
  const auto fails = [](const std::string&, std::size_t, std::size_t) { throw std::runtime_error("no terminal"); };
  EXPECT_THROW(read_with("echo 'progress 2 7 dividing faces' >&2; exec sleep 600\n", 3600, fails), std::runtime_error);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child is left";
}

TEST_F(StepProgram, ThatSaysNothingOrTooMuchIsRefused) {
  EXPECT_THAT(message_with("exit 0\n"), HasSubstr("abbe-step gave no mesh: no first line"));
  EXPECT_THAT(message_with("echo '{}'\n"), HasSubstr("abbe-step gave no mesh: the first line is not understood"));
  EXPECT_THAT(message_with("exit 1\n"), HasSubstr("OpenCASCADE could not read the file"));
  EXPECT_THAT(message_with("echo a reason >&2; echo something else >&2; exit 2\n"),
              EndsWith("a reason; expected something else"));
}

TEST_F(StepProgram, GetsNamesAsTheyAre) {
  EXPECT_THAT(message_with("echo \"$1\" >&2; exit 2\n"),
              HasSubstr(golden_step_file("block.step").string() + "; expected"));
}

}  // namespace
}  // namespace abbe
