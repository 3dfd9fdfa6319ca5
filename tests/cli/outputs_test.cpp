// What outputs may take the place of.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/command_test.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Outputs : public CommandTest {
 protected:
  Outputs() {
    fs::create_directory(folder.path() / "mine");
    folder.write("mine/keep.txt", "mine");
  }
  /// A command that names its results so: exit code 2, nothing is made or lost.
  void expect_refused(const std::string& output) {
    const std::string fit = ABBE_SOURCE_DIR "/examples/fit/bore.csv", study = ABBE_SOURCE_DIR "/examples/aguado/";
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"fit", fit, "--shape", "cylinder", "-o", output},
          std::vector<std::string>{"run", study + "aguado.study.toml", "-o", output}}) {
      const CommandResult result = abbe(command);
      EXPECT_EQ(result.exit_code, ExitCode::bad_input) << output;
      EXPECT_THAT(result.err, HasSubstr("holds files that are not results of abbe")) << output;
      EXPECT_EQ(folder.read("mine/keep.txt"), "mine") << output;
      EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1) << output;
    }
  }
};

TEST_F(Outputs, AFolderOfSomebodyIsNotReplacedWhateverLeadsToIt) {
  for (const char* const output :
       {"mine", "mine/", "new/../mine", "new/other/../../mine", "./new/.././mine", "mine/."}) {
    expect_refused(output);
  }
}

TEST_F(Outputs, ASummaryAloneMakesNoFolderOurs) {
  folder.write("mine/summary.json", "{}");
  folder.write("mine/evaluation.json", "{}");
  expect_refused("mine");
}

TEST_F(Outputs, NotesInAFolderOfResultsStay) {
  const std::vector<std::string> fit{"fit",    ABBE_SOURCE_DIR "/examples/fit/bore.csv", "--shape", "cylinder", "-o",
                                     "results"};
  ASSERT_EQ(abbe(fit).exit_code, ExitCode::done);
  folder.write("results/notes.txt", "mine");
  ASSERT_EQ(abbe(fit).exit_code, ExitCode::done);
  EXPECT_EQ(folder.read("results/notes.txt"), "mine");
}

/// A command and its option that names a file to write; the kind of file is right for it.
struct FileOutput {
  std::vector<std::string> command;
  std::string option;

  std::string ending() const { return command[0] == "verify" ? ".html" : ".csv"; }
};

/// All of them. What they read does not exist: outputs are looked at first.
std::vector<FileOutput> file_outputs() {
  const std::vector<std::string> path{"path", "table", "--machine", "machine"},
      table{"compensate", "table", "--machine", "machine", "--errors", "errors", "--for", "siemens-eec"};
  const std::vector<std::string> scan{"scan", "plan", "part.stl", "--machine", "machine"};
  return {{{"new", "w X b Z t"}, "-o"},
          {{"test-piece", "s-shape"}, "-o"},
          {{"map", "--machine", "machine", "--errors", "errors"}, "-o"},
          {{"identify", "study"}, "-o"},
          {{"plan", "study"}, "-o"},
          {{"plan", "study"}, "--svg"},
          {{"plan", "study"}, "--report"},
          {path, "-o"},
          {path, "--report"},
          {{"position", "marks"}, "-o"},
          {{"fit", "points.csv", "--shape", "cylinder"}, "--residuals"},
          {scan, "-o"},
          {scan, "--program"},
          {scan, "--coverage"},
          {scan, "--report"},
          {{"scan", "points", "readings", "--machine", "machine"}, "-o"},
          {{"verify", "results"}, "-o"},
          {{"compensate", "gcode", "program", "--machine", "machine", "--errors", "errors"}, "-o"},
          {{"compensate", "freeze", "--machine", "machine", "--errors", "errors"}, "-o"},
          {{"compensate", "poses", "poses", "--machine", "machine", "--errors", "errors"}, "-o"},
          {{"compensate", "kinematics", "--machine", "machine", "--errors", "errors", "--for", "siemens"}, "-o"},
          {table, "-o"},
          {table, "--map"}};
}

/// Commands that write a folder of results, without its name.
std::vector<std::vector<std::string>> folder_outputs() {
  return {{"run", "study", "-o"},
          {"simulate", "study", "-o"},
          {"reproduce", "aguado", "-o"},
          {"fit", "points.csv", "--shape", "cylinder", "-o"},
          {"evaluate", "positioning", "readings", "-o"},
          {"register", "scan.csv", "part.stl", "-o"},
          {"deviate", "scan.csv", "part.stl", "-o"},
          {"compensate", "table", "--machine", "machine", "--errors", "errors", "--for", "siemens-cec", "-o"}};
}

TEST_F(Outputs, NoCommandReplacesAFileUnasked) {
  for (const std::string name : {"mine.csv", "mine.html"}) folder.write(name, "mine");
  for (const FileOutput& output : file_outputs()) {
    const std::string name = "mine" + output.ending();
    std::vector<std::string> command = output.command;
    command.insert(command.end(), {output.option, name});
    const CommandResult result = abbe(command);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << testing::PrintToString(command);
    EXPECT_THAT(result.err, HasSubstr(name + ": the file exists; expected another name, or --force to replace it"))
        << testing::PrintToString(command);
    EXPECT_EQ(folder.read(name), "mine") << testing::PrintToString(command);
  }
}

TEST_F(Outputs, APlaceThatCannotBeWrittenToIsFoundBeforeAnythingIsRead) {
  const auto expect_refused_for = [&](std::vector<std::string> command, const std::string& name, const char* reason) {
    command.push_back(name);
    const CommandResult result = abbe(command);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << testing::PrintToString(command);
    EXPECT_EQ(result.err,
              "abbe: " + name + ": cannot be written: " + reason + "; expected a writable folder with enough space\n")
        << testing::PrintToString(command);
  };
  for (FileOutput output : file_outputs()) {
    output.command.push_back(output.option);
    expect_refused_for(output.command, "none/out" + output.ending(), "No such file or directory");
  }
  // Folders on the way of one for results are made; what is in the way is not removed.
  for (const std::vector<std::string>& command : folder_outputs()) {
    expect_refused_for(command, "mine/keep.txt/results", "Not a directory");
  }
  // Tables and a map in the folder that is made for them.
  EXPECT_THAT(abbe({"compensate", "table", "--machine", "machine", "--errors", "errors", "--for", "siemens-cec", "-o",
                    "tables", "--map", "tables/map.csv"})
                  .err,
              HasSubstr("machine: "));
}

TEST_F(Outputs, AFolderWithoutPermissionIsFoundBeforeAnythingIsRead) {
  if (::geteuid() == 0) GTEST_SKIP() << "everything is permitted to root";
  fs::permissions(folder.path() / "mine", fs::perms::owner_read | fs::perms::owner_exec);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"map", "--machine", "machine", "--errors", "errors", "-o", "mine/x.csv"},
        std::vector<std::string>{"run", "study", "-o", "mine/a/b"}}) {
    const CommandResult result = abbe(command);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    EXPECT_THAT(result.err, HasSubstr("cannot be written: Permission denied"));
  }
  fs::permissions(folder.path() / "mine", fs::perms::owner_all);
}

TEST_F(Outputs, AFileThatExistsIsReplacedWhereThatIsAskedFor) {
  const std::vector<std::string> map{"map",
                                     "--machine",
                                     ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml",
                                     "--errors",
                                     ABBE_SOURCE_DIR "/examples/compensate/trunnion.errors.toml",
                                     "--grid",
                                     "X_mm=0",
                                     "-o",
                                     "map.csv"};
  folder.write("map.csv", "mine");
  std::vector<std::string> forced = map;
  forced.emplace_back("--force");
  EXPECT_NE(abbe(forced).exit_code, ExitCode::bad_input);
  EXPECT_THAT(folder.read("map.csv"), HasSubstr("X_mm"));
  fs::remove(folder.path() / "map.csv");
  EXPECT_NE(abbe(map).exit_code, ExitCode::bad_input);
  EXPECT_THAT(folder.read("map.csv"), HasSubstr("X_mm"));
  // A link that leads nowhere is somebody's too, and the name of a folder is none of a file.
  fs::create_symlink("nowhere", folder.path() / "link.csv");
  EXPECT_THAT(abbe({"new", "w X b Z t", "-o", "link.csv"}).err, HasSubstr("the file exists"));
  EXPECT_THAT(abbe({"new", "w X b Z t", "-o", "mine"}).err, HasSubstr("mine: cannot be written: Is a directory"));
  EXPECT_THAT(abbe({"plan", ABBE_SOURCE_DIR "/examples/trunnion/trunnion.study.toml", "-o", "x", "--svg", "./x"}).err,
              HasSubstr("./x: is the name of two outputs"));
}

TEST_F(Outputs, WhereSomethingFailsTheMessageSaysWhatIsComplete) {
  const auto shell = [&](const std::string& words) {
    return run_program("/bin/sh", {"-c", ABBE_COMMAND " " + words}, folder.path());
  };
  const CommandResult full = shell("test-piece cone-frustum -o cone.csv >/dev/full");
  EXPECT_EQ(full.exit_code, ExitCode::bad_input);
  EXPECT_EQ(full.err,
            "abbe: standard output: cannot be written: No space left on device; expected a place with enough space\n"
            "abbe: complete before that: cone.csv\n");
  EXPECT_THAT(folder.read("cone.csv"), HasSubstr("# cone frustum"));
  // There is room for the first file, not for the second, which is larger: half way between them, in blocks of 512.
  const std::string map =
      "map --machine " ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml --errors " ABBE_SOURCE_DIR
      "/examples/compensate/trunnion.errors.toml --grid X_mm=0 -o ";
  ASSERT_EQ(shell(map + "whole.vtu -o whole.csv").exit_code, ExitCode::done);
  const auto first_size = fs::file_size(folder.path() / "whole.vtu"),
             second_size = fs::file_size(folder.path() / "whole.csv");
  ASSERT_GT(second_size, first_size + 2048);
  const CommandResult second = run_program("/bin/sh",
                                           {"-c", "ulimit -f " + std::to_string((first_size + second_size) / 2 / 512) +
                                                      "; exec " ABBE_COMMAND " " + map + "map.vtu -o map.csv"},
                                           folder.path());
  EXPECT_EQ(second.exit_code, ExitCode::bad_input);
  EXPECT_THAT(second.err, HasSubstr("map.csv: cannot be written: File too large"));
  EXPECT_THAT(second.err, HasSubstr("\nabbe: complete before that: map.vtu\n"));
  EXPECT_THAT(shell("check --machine nothing.machine.toml").err, testing::Not(HasSubstr("complete")));
}

TEST_F(Outputs, TheCovarianceBesideAnErrorsFileIsNotReplacedEither) {
  folder.write("found.covariance.csv", "mine");
  const CommandResult result =
      abbe({"identify", ABBE_SOURCE_DIR "/examples/aguado/aguado.study.toml", "-o", "found.errors.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("found.covariance.csv: the file exists"));
  EXPECT_EQ(folder.read("found.covariance.csv"), "mine");
  EXPECT_FALSE(fs::exists(folder.path() / "found.errors.toml"));
}

TEST_F(Outputs, WhereNothingCanBeSaidTheExitCodeStillTells) {
  const auto shell = [&](const std::string& words) {
    return run_program("/bin/sh", {"-c", ABBE_COMMAND " " + words}, folder.path()).exit_code;
  };
  for (const std::string silent : {"2>&-", "2>/dev/full", "0<&- 1>&- 2>&-"}) {
    EXPECT_EQ(shell("check --machine nothing.machine.toml " + silent), ExitCode::bad_input) << silent;
    EXPECT_EQ(shell("no-command " + silent), ExitCode::bad_input) << silent;
    EXPECT_EQ(shell("fit --no-option " + silent), ExitCode::bad_input) << silent;
  }
  // Nor is it said into the file that got the number of standard error.
  ASSERT_EQ(shell("test-piece cone-frustum -o a.csv"), ExitCode::done);
  ASSERT_EQ(shell("test-piece cone-frustum -o b.csv 0<&- 2>&-"), ExitCode::done);
  EXPECT_EQ(folder.read("a.csv"), folder.read("b.csv"));
  EXPECT_EQ(shell("test-piece cone-frustum -o c.csv 1>&-"), ExitCode::bad_input);
  EXPECT_TRUE(!fs::exists(folder.path() / "c.csv") || folder.read("a.csv") == folder.read("c.csv"));
}

TEST_F(Outputs, TheNameOfASetUpStaysInTheFolder) {
  std::string study = R"(machine = "m.machine.toml"
[[setup]]
name = "../victim"
instrument = "tracker"
)";
  ASSERT_EQ(abbe({"new", "w X b Z t", "-o", "m.machine.toml"}).exit_code, ExitCode::done);
  folder.write("a.study.toml", study);
  const CommandResult result = abbe({"simulate", "a.study.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("setup[1].name: cannot be the name of a file; expected 1 to 100 bytes without"));
}

}  // namespace
}  // namespace abbe
