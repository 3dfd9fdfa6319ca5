#include "cli/run_command.h"

#include <gtest/gtest.h>

#include <system_error>

namespace abbe {
namespace {

CommandResult shell(const std::string& script, const std::vector<std::string>& environment = {}) {
  return run_program("/bin/sh", {"-c", script}, "/", environment);
}

TEST(RunProgram, KeepsOutputErrorAndExitCodeApart) {
  const CommandResult result = shell("echo out; echo err >&2; exit 7");
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_EQ(result.out, "out\n");
  EXPECT_EQ(result.err, "err\n");
}

TEST(RunProgram, ReportsASignal) { EXPECT_EQ(shell("kill -9 $$").exit_code, 128 + 9); }

TEST(RunProgram, GivesAnEmptyStandardInput) { EXPECT_EQ(shell("cat; echo end").out, "end\n"); }

TEST(RunProgram, PassesArgumentsUnchanged) {
  const CommandResult result = run_program("/bin/echo", {"a b", "$HOME", "'"}, "/");
  EXPECT_EQ(result.out, "a b $HOME '\n");
}

TEST(RunProgram, ReplacesAndAddsEnvironmentVariables) {
  EXPECT_EQ(shell("echo $HOME $ABBE_NEW", {"HOME=/nowhere", "ABBE_NEW=1"}).out, "/nowhere 1\n");
}

TEST(RunProgram, SurvivesMuchOutputOnBothStreams) {
  const CommandResult result =
      shell("i=0; while [ $i -lt 3000 ]; do printf '%0100d' 0 >&2; printf '%0100d' 0; i=$((i+1)); done");
  EXPECT_EQ(result.out.size(), 300000U);
  EXPECT_EQ(result.err.size(), 300000U);
}

TEST(RunProgram, SaysWhenAProgramCannotBeStarted) {
  EXPECT_THROW(run_program("/nonexistent/program", {}, "/"), std::system_error);
}

TEST(TemporaryFolder, KeepsFilesAndGoesAway) {
  std::filesystem::path path;
  {
    const TemporaryFolder folder;
    path = folder.path();
    folder.write("deep/file.txt", "a\r\nb");
    EXPECT_EQ(folder.read("deep/file.txt"), "a\r\nb");
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace abbe
