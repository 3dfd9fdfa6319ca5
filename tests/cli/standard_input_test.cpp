// "-" for the name of a file that is read.
#include <gmock/gmock.h>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kExamples = ABBE_SOURCE_DIR "/examples/";

class StandardInput : public CommandTest {
 protected:
  /// `abbe` with a file on its standard input: redirected, or through a pipe.
  CommandResult abbe_reads(const std::string& file, const std::string& arguments, bool through_pipe = true) const {
    const std::string command = ABBE_COMMAND " " + arguments;
    return run_program("/bin/sh",
                       {"-c", through_pipe ? "cat '" + file + "' | " + command : command + " < '" + file + "'"},
                       folder.path());
  }

  /// What is printed is the same as with the name of the file, except for the name.
  void expect_same(const std::string& file, const std::string& before, const std::string& after = "") const {
    const CommandResult named =
        run_program("/bin/sh", {"-c", ABBE_COMMAND " " + before + " " + file + " " + after}, folder.path());
    ASSERT_NE(named.exit_code, ExitCode::bad_input) << named.err;
    for (const bool through_pipe : {true, false}) {
      CommandResult read = abbe_reads(file, before + " - " + after, through_pipe);
      EXPECT_EQ(read.exit_code, named.exit_code) << read.err;
      EXPECT_EQ(without(read.out, {"<stdin>"}), without(named.out, {file, file.substr(file.rfind('/') + 1)})) << before;
    }
  }

 private:
  static std::string without(std::string text, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      for (std::size_t at = 0; (at = text.find(name)) != std::string::npos;) text.erase(at, name.size());
    }
    return text;
  }
};

TEST_F(StandardInput, IsReadForAnyFile) {
  const std::string mill = kExamples + "machines/trunnion-mill.machine.toml",
                    errors = kExamples + "compensate/trunnion.errors.toml",
                    both = " --machine " + mill + " --errors " + errors;
  expect_same(mill, "check --machine");
  expect_same(errors, "map --machine " + mill + " --errors", "--grid X_mm=0 --json");
  expect_same(kExamples + "compensate/cone.ngc", "compensate gcode", "--dry-run" + both);
  expect_same(kExamples + "compensate/poses.csv", "compensate poses", "--dry-run" + both);
  expect_same(kExamples + "evaluate/linear.csv", "evaluate positioning", "--json");
  expect_same(kExamples + "cradle_scanner/readings.csv", "scan points",
              "--force -o p.csv --machine " + kExamples + "machines/liu-scanner.machine.toml");
  expect_same(kExamples + "laser_engraver/five-steps.csv", "evaluate linkage",
              "--exit-to-axis-mm 120 --board-mm 4 --json");
}

TEST_F(StandardInput, KindsOfShapesAndCurvesAreToldFromTheContents) {
  const std::string engraver = " --machine " + kExamples + "machines/yin-engraver-u.machine.toml";
  expect_same(kExamples + "parts/wedge.stl", "check");
  expect_same(kExamples + "scan/pin-scan.csv", "check");
  expect_same(kExamples + "scan/pin-scan.csv", "deviate",
              kExamples + "scan/pin.stl --transform " + kExamples + "scan/pin-transform.csv");
  expect_same(kExamples + "fit/scanned-ball.xyz", "fit", "--shape sphere --method robust");
  expect_same(kExamples + "laser_engraver/table-a4.csv", "path",
              "--placement " + kExamples + "laser_engraver/part.placement.toml" + engraver);
  expect_same(kExamples + "laser_engraver/regions.ngc", "path", "--retract-mm 20" + engraver);
  const std::string obj = folder.write("part.obj", "# part\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").string();
  expect_same(obj, "check");
  const std::string frozen = (folder.path() / "mill.abbec").string();
  ASSERT_EQ(abbe({"compensate", "freeze", "--machine", kExamples + "machines/trunnion-mill.machine.toml", "--errors",
                  kExamples + "compensate/trunnion.errors.toml", "-o", frozen})
                .exit_code,
            ExitCode::done);
  expect_same(frozen, "check");
}

TEST_F(StandardInput, AFileThatWasCutShortIsStillOfItsKind) {
  std::filesystem::copy(kExamples + "scan/bracket.stl", folder.path() / "cut.stl");
  std::filesystem::resize_file(folder.path() / "cut.stl", 1000);
  const std::string scan = kExamples + "scan/bracket-scan.csv";
  for (const std::string& words : {std::string("check -"), "register " + scan + " -", "deviate " + scan + " -",
                                   std::string("fit - --shape plane")}) {
    const CommandResult result = abbe_reads("cut.stl", words);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    EXPECT_EQ(result.err,
              "abbe: <stdin>: number of triangles: at byte 80: 48 triangles are stated in a file of 1000 bytes; "
              "expected a file of 2484 bytes: 84 and 50 for each triangle\n")
        << words;
  }
  const auto checked = [&](const std::string& contents) {
    const CommandResult result = abbe_reads(folder.write("cut", contents).string(), "check -");
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    return result.err;
  };
  EXPECT_THAT(checked("ply\nformat ascii 1.0\nelem"), HasSubstr("<stdin>:3:1: 'elem' in the header"));
  EXPECT_THAT(checked("ply"), HasSubstr("the header does not end"));
  EXPECT_THAT(checked("ISO-10303"), HasSubstr("this is not a STEP file"));
  EXPECT_THAT(checked("solid\n facet normal 0 0"), HasSubstr("<stdin>:2"));
  EXPECT_THAT(checked("# a machine\nname = \"mill\"\nchain = \"w b"), HasSubstr("write --machine -\nabbe: <stdin>:3"));
}

TEST_F(StandardInput, FilesForOtherCommandsAreNotTakenForMachines) {
  const std::string errors =
                        "this is an errors file; expected --machine with the file of its machine, and --errors "
                        "with this one\n",
                    placement = "this is the placement of a workpiece; expected abbe path --placement with it\n";
  for (const auto& [file, words] : {std::pair{"compensate/trunnion.errors.toml", errors},
                                    std::pair{"laser_engraver/part.placement.toml", placement}}) {
    const CommandResult read = abbe_reads(kExamples + file, "check -"), named = abbe({"check", kExamples + file});
    EXPECT_EQ(read.exit_code, ExitCode::bad_input);
    EXPECT_EQ(read.err, "abbe: <stdin>: " + words);
    EXPECT_EQ(named.exit_code, ExitCode::bad_input);
    EXPECT_EQ(named.err, "abbe: " + kExamples + file + ": " + words);
  }
}

TEST_F(StandardInput, ContentsThatCannotBeToldAreRefusedWithWhatToDo) {
  const std::string text = folder.write("text", "hello\n").string(), scan = kExamples + "scan/bracket-scan.csv",
                    part = kExamples + "scan/bracket.stl",
                    engraver = kExamples + "machines/yin-engraver-u.machine.toml",
                    untold = "abbe: <stdin>: its kind cannot be recognised from its contents; expected ",
                    mesh =
                        "a mesh that begins like an STL file ('solid', or 80 bytes and the number of triangles), a "
                        "PLY file ('ply'), an OBJ file ('v X Y Z') or a STEP file ('ISO-10303-21;')",
                    cloud =
                        "a point cloud that begins like an XYZ file (numbers), a CSV file ('x_mm,y_mm,z_mm'), a "
                        "PLY file ('ply'), a PCD file ('# .PCD'), an E57 file ('ASTM-E57') or an OBJ file ('v X Y Z')",
                    named = "; or give the name of a file, whose extension shows its kind\n";
  const auto said = [&](const std::string& file, const std::string& words) {
    const CommandResult result = abbe_reads(file, words);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    return result.err;
  };
  EXPECT_EQ(said(text, "check -"),
            untold +
                "a file that begins like a machine file ('name = ...'), a frozen compensation (byte 0x89, 'ABBEC'), an "
                "STL file ('solid', or 80 bytes and the number of triangles), a PLY file ('ply'), an OBJ file ('v X Y "
                "Z'), a STEP file ('ISO-10303-21;'), a CSV file ('x_mm,y_mm,z_mm'), a PCD file ('# .PCD'), an E57 file "
                "('ASTM-E57') or an XYZ file (numbers)" +
                named);
  EXPECT_EQ(said(text, "scan plan - --machine " + kExamples + "machines/liu-scanner.machine.toml"),
            untold + mesh + named);
  EXPECT_EQ(said(text, "register " + scan + " -"), untold + mesh + named);
  EXPECT_EQ(said(text, "register - " + part), untold + cloud + named);
  EXPECT_EQ(said(text, "deviate - " + part), untold + cloud + named);
  EXPECT_EQ(said(text, "fit - --shape sphere"), untold + cloud + named);
  EXPECT_EQ(said(text, "path - --machine " + engraver),
            untold +
                "a curve that begins like a CSV file ('x_mm,y_mm,z_mm') or an NC program (a letter and a number, '%' "
                "or a comment)" +
                named);
  // What it is instead, where that is known.
  EXPECT_EQ(said(scan, "register " + scan + " -"), "abbe: <stdin>: begins like a CSV file; expected " + mesh + named);
  EXPECT_EQ(said(engraver, "register - " + part),
            "abbe: <stdin>: begins like a machine file; expected " + cloud + named);
  EXPECT_THAT(said(part, "path - --machine " + engraver),
              HasSubstr("<stdin>: begins like an STL file; expected a curve"));
  // A file has a name, which has to tell.
  EXPECT_EQ(abbe({"check", "text"}).err,
            "abbe: text: its name does not tell its kind; expected a name ending in .abbec, .stl, .ply, "
            ".obj, .step, .stp, .xyz, .asc, .pts, .csv, .pcd or .e57, or --machine with a machine file\n");
  EXPECT_EQ(abbe({"check", "none"}).err, "abbe: none: there is no such file\n");
}

TEST_F(StandardInput, AStudyNamesFilesOfTheCurrentFolder) {
  folder.write("m.toml", "format = \"abbe-machine-1\"\n");
  const std::string study =
      folder.write("a/b.study.toml", "format = \"abbe-study-1\"\nmachine = \"none.toml\"\n").string();
  EXPECT_THAT(abbe_reads(study, "run -").err, HasSubstr("<stdin>"));
  EXPECT_THAT(abbe_reads(study, "run -").err, HasSubstr("none.toml"));
  std::filesystem::copy(kExamples + "three_axis", folder.path() / "three_axis",
                        std::filesystem::copy_options::recursive);
  std::filesystem::copy(kExamples + "machines", folder.path() / "machines", std::filesystem::copy_options::recursive);
  const std::filesystem::path place = folder.path() / "three_axis";
  const auto run = [&](const std::string& words) {
    return run_program("/bin/sh", {"-c", ABBE_COMMAND " " + words}, place);
  };
  const std::string name = "level-and-autocollimator.study.toml";
  const CommandResult named = run("run " + name + " -o ../named --json");
  const CommandResult read = run("run - -o ../read --json < " + name);
  ASSERT_EQ(named.exit_code, ExitCode::done) << named.err;
  EXPECT_EQ(read.exit_code, ExitCode::done) << read.err;
  EXPECT_EQ(folder.read("read/errors.toml"), folder.read("named/errors.toml"));
  // Elsewhere its files are not found.
  EXPECT_EQ(abbe_reads((place / name).string(), "run - -o elsewhere").exit_code, ExitCode::bad_input);
}

TEST_F(StandardInput, IsOneFileAtMost) {
  const CommandResult result = abbe({"map", "--machine", "-", "--errors", "-"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_EQ(result.err,
            "abbe: --machine, --errors: more than one file is standard input; expected - for one of them at most\n");
  EXPECT_THAT(abbe({"verify", "--truth", "-", "s-shape", "--before", "-", "--after", "a.csv"}).err,
              HasSubstr("--truth, --before: more than one file is standard input"));
}

TEST_F(StandardInput, MessagesNameIt) {
  const std::string broken = folder.write("broken.toml", "format = \"abbe-machine-1\"\nname = 3\n").string();
  EXPECT_THAT(abbe_reads(broken, "check --machine -").err, HasSubstr("abbe: <stdin>:"));
  EXPECT_THAT(abbe({"check", "--machine", "-"}).err, HasSubstr("abbe: <stdin>: "));  // it is /dev/null
  EXPECT_THAT(abbe({"check", "--machine", "<stdin>"}).err, HasSubstr("<stdin>: there is no such file"));
  const CommandResult closed =
      run_program("/bin/sh", {"-c", "exec " ABBE_COMMAND " check --machine - <&-"}, folder.path());
  EXPECT_EQ(closed.exit_code, ExitCode::bad_input);
  EXPECT_THAT(closed.err, HasSubstr("abbe: <stdin>: cannot be read: "));
}

TEST_F(StandardInput, IsAnInputThatNoOutputReplaces) {
  std::filesystem::copy(kExamples + "compensate/poses.csv", folder.path() / "poses.csv");
  const CommandResult result =
      abbe_reads("poses.csv",
                 "compensate poses - --force -o poses.csv --machine " + kExamples +
                     "machines/trunnion-mill.machine.toml --errors " + kExamples + "compensate/trunnion.errors.toml",
                 false);
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("poses.csv: is an input of the command"));
}

}  // namespace
}  // namespace abbe
