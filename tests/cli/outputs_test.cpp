// What outputs may take the place of.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>

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
      EXPECT_THAT(result.err, HasSubstr("holds files that are no results of abbe")) << output;
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

TEST_F(Outputs, WhereNothingCanBeSaidTheExitCodeStillTells) {
  const auto shell = [&](const std::string& words) {
    return run_program("/bin/sh", {"-c", ABBE_COMMAND " " + words}, folder.path()).exit_code;
  };
  for (const std::string silent : {"2>&-", "2>/dev/full", "0<&- 1>&- 2>&-"}) {
    EXPECT_EQ(shell("check nothing.machine.toml " + silent), ExitCode::bad_input) << silent;
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
