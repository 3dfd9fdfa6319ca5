#include <gmock/gmock.h>

#include <regex>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class CommandLine : public CommandTest {};

TEST_F(CommandLine, HelpIsOnStandardOutputAndShowsAnExample) {
  const CommandResult result = abbe({"--help"});
  EXPECT_EQ(result.exit_code, ExitCode::done);
  EXPECT_THAT(result.out, HasSubstr("Example"));
  EXPECT_THAT(result.out, HasSubstr("abbe run"));
  EXPECT_EQ(result.err, "");
}

TEST_F(CommandLine, AnUnknownSubcommandIsBadInput) {
  const CommandResult result = abbe({"nonsense"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("nonsense"));
}

TEST_F(CommandLine, VersionIsOneLine) {
  const CommandResult result = abbe({"--version"});
  EXPECT_EQ(result.exit_code, ExitCode::done);
  EXPECT_TRUE(std::regex_match(result.out, std::regex("abbe [0-9]+\\.[0-9]+\\.[0-9]+\n"))) << result.out;
}

TEST_F(CommandLine, WhatDoesNotArriveIsNotDone) {
  if (!std::filesystem::is_character_file("/dev/full")) GTEST_SKIP() << "no /dev/full";
  for (const std::string& command : {std::string("--help"), std::string("test-piece cone-frustum")}) {
    const CommandResult result =
        run_program("/bin/sh", {"-c", "exec " ABBE_COMMAND " " + command + " > /dev/full"}, folder.path());
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << command;
    EXPECT_THAT(result.err, HasSubstr("standard output: cannot be written")) << command;
  }
}

}  // namespace
}  // namespace abbe
