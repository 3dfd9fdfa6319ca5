// The options that say how a STEP file is read, in every command that reads a mesh.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/placement_file.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/geometry/surface/surface_samples.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class StepOptionsCommand : public CommandTest {
 protected:
  /// The commands that read a mesh, each with this one.
  static std::vector<std::vector<std::string>> commands_with(const std::string& mesh) {
    const std::string examples = ABBE_SOURCE_DIR "/examples/";
    return {{"check", mesh},
            {"register", "scan.csv", mesh},
            {"deviate", "scan.csv", mesh},
            {"position", "mesh.positioning.toml"},
            {"path", examples + "laser_engraver/table-a4.csv", "--machine",
             examples + "machines/yin-engraver-u.machine.toml", "--report", "page.html", "--part", mesh},
            {"scan", "plan", mesh, "--machine", examples + "machines/liu-scanner.machine.toml"}};
  }

  static bool has_step_program() {
    return std::filesystem::exists(std::filesystem::path(ABBE_COMMAND).parent_path() / "abbe-step");
  }

  static std::string step_file(const char* name) { return std::string(ABBE_SOURCE_DIR "/tests/golden/step/") + name; }

  /// part.step: a STEP file with its first `from` replaced.
  void write_part(const std::string& whole, const std::string& from, const std::string& to) const {
    folder.write("part.step", test::replaced(read_text_file(whole), from, to));
  }

  CommandResult abbe_with(std::vector<std::string> command, const std::vector<std::string>& options) const {
    command.insert(command.end(), options.begin(), options.end());
    return abbe(command);
  }

  /// mesh.positioning.toml: the scans of the example, the workpiece by this mesh.
  void write_positioning(const std::string& mesh) const {
    const std::string folder_of_example = ABBE_SOURCE_DIR "/examples/laser_engraver/";
    std::string text = read_text_file(folder_of_example + "scanner.positioning.toml");
    text.resize(text.find("[workpiece]"));
    std::ifstream scans(folder_of_example + "scans.csv");
    std::string targets;
    for (std::string line; std::getline(scans, line);) {
      const std::string target = line.substr(0, line.find(','));
      if (target != "cylinder" && target != "top" && target != "side") targets += line + "\n";
    }
    folder.write("scans.csv", targets);
    folder.write("mesh.positioning.toml", text + "[workpiece]\npart = \"" + mesh + "\"\nscan = \"scan.csv\"\n");
  }
};

TEST_F(StepOptionsCommand, AreRefusedWithAMeshThatIsNoStepFile) {
  folder.write("part.stl",
               "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
               "endfacet\nendsolid\n");
  folder.write("scan.csv", "x_mm,y_mm,z_mm\n0.1,0.1,0\n");
  write_positioning("part.stl");
  for (const std::vector<std::string>& command : commands_with("part.stl")) {
    const CommandResult result = abbe_with(command, {"--chord-mm", "0.1"});
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << command[0];
    EXPECT_THAT(result.err, HasSubstr("--chord-mm: part.stl is not a STEP file and has no exact faces")) << command[0];
  }
}

TEST_F(StepOptionsCommand, AreRefusedWhereNoMeshIsRead) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"position", examples + "laser_engraver/scanner.positioning.toml"},
                                             {"path", examples + "laser_engraver/table-a4.csv", "--machine",
                                              examples + "machines/yin-engraver-u.machine.toml"}}) {
    const CommandResult result = abbe_with(command, {"--chord-mm", "0.1"});
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << command[0];
    EXPECT_THAT(result.err, HasSubstr("--chord-mm: no mesh is read")) << command[0];
  }
}

TEST_F(StepOptionsCommand, ReachTheReaderInEveryCommand) {
  const std::string part = step_file("cylinder.step");
  folder.write("scan.csv", "x_mm,y_mm,z_mm\n0.1,0.1,0\n");
  write_positioning(part);
  // In place of abbe-step a program that says how it was called.
  const std::string said = folder.write("said.sh", "#!/bin/sh\necho \"called with $*\" >&2\nexit 2\n");
  std::filesystem::permissions(said, std::filesystem::perms::owner_all);
  for (std::vector<std::string> command : commands_with(part)) {
    command.insert(command.end(), {"--chord-mm", "0.125"});
    const CommandResult result = abbe(command, {"ABBE_STEP_PROGRAM=" + said});
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << command[0];
    EXPECT_THAT(result.err, HasSubstr("called with " + part + " 0.125 ")) << command[0];
  }
}

TEST_F(StepOptionsCommand, AnIncompletePartIsSaidEverywhere) {
  if (!has_step_program()) GTEST_SKIP() << "built without OpenCASCADE";
  write_part(step_file("block.step"), "#32 = PLANE(", "#32 = PLONE(");
  folder.write("scan.csv", "x_mm,y_mm,z_mm\n0.1,0.1,10.01\n3,4,10.02\n");
  EXPECT_EQ(abbe({"check", "part.step"}).exit_code, ExitCode::bad_input);
  const CommandResult check = abbe({"check", "part.step", "--leave-out-faces"});
  EXPECT_EQ(check.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(check.err,
              HasSubstr("abbe: warning: part.step: 1 face is left out (of unknown area): #17 (AdvancedFace): "));
  EXPECT_THAT(check.out, HasSubstr("incomplete: 1 face is"));
  const CommandResult deviate = abbe({"deviate", "scan.csv", "part.step", "--leave-out-faces"});
  EXPECT_EQ(deviate.exit_code, ExitCode::done) << deviate.err;
  EXPECT_THAT(deviate.err, HasSubstr("1 face is"));
  EXPECT_THAT(deviate.out, HasSubstr("incomplete: 1 face is"));
  const CommandResult plan = abbe({"scan", "plan", "part.step", "--machine",
                                   ABBE_SOURCE_DIR "/examples/machines/liu-scanner.machine.toml", "--leave-out-faces"});
  EXPECT_EQ(plan.exit_code, ExitCode::bad_input);
  EXPECT_THAT(plan.err, HasSubstr("part.step: 1 face is left out (of unknown area): #17 (AdvancedFace): "));
  EXPECT_THAT(plan.err, HasSubstr("expected all faces of the part and the stage"));
}

TEST_F(StepOptionsCommand, AnIncompletePartIsSaidInThePlacement) {
  if (!has_step_program()) GTEST_SKIP() << "built without OpenCASCADE";
  const std::string whole = step_file("assembly.step");
  write_part(whole, "= PLANE(", "= PLONE(");
  const RigidTransform scanner_from_part{rotation_xyz({0.1, -0.2, 0.3}), {20, -10, 500}};
  const Eigen::Matrix3Xd points = sample_surface(read_mesh(whole).mesh, 300, 7).points;
  std::string scan = "x_mm,y_mm,z_mm\n";
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d seen = scanner_from_part * Eigen::Vector3d(points.col(i));
    scan += fmt::format("{:.4f},{:.4f},{:.4f}\n", seen.x(), seen.y(), seen.z());
  }
  folder.write("scan.csv", scan);
  write_positioning("part.step");
  const CommandResult found =
      abbe({"position", "mesh.positioning.toml", "--leave-out-faces", "-o", "part.placement.toml"});
  ASSERT_EQ(found.exit_code, ExitCode::done) << found.err;
  EXPECT_THAT(found.err, HasSubstr("part.step: 1 face is left out"));
  EXPECT_THAT(found.out, HasSubstr("warning: the part is incomplete: 1 face is left out"));
  const std::vector<std::string> warnings = read_placement(folder.path() / "part.placement.toml").warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], testing::StartsWith("the part is incomplete: 1 face is left out (of unknown area): #"));
}

}  // namespace
}  // namespace abbe
