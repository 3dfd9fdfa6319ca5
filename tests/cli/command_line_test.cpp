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

TEST_F(CommandLine, WhatIsMisspelledIsNamedWithWhatWasMeant) {
  const auto refusal = [&](const std::vector<std::string>& words) {
    const CommandResult result = abbe(words);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.find("abbe: "), 0U) << result.err;
    return result.err;
  };
  EXPECT_THAT(refusal({"verfy"}), HasSubstr("there is no subcommand 'verfy'; did you mean verify?"));
  EXPECT_THAT(refusal({"compensate", "tabel"}),
              HasSubstr("'tabel' is not expected by abbe compensate; did you mean table?"));
  EXPECT_THAT(refusal({"run", "--jsn", "a.study.toml"}),
              HasSubstr("'--jsn' is not an option of abbe run; did you mean --json?"));
  // Also where something is missing because of it, and with a value.
  EXPECT_THAT(refusal({"map", "--grd=X_mm=1", "m.toml"}),
              HasSubstr("'--grd' is not an option of abbe map; did you mean --grid?"));
  EXPECT_THAT(refusal({"run", "a.study.toml", "b.study.toml"}),
              HasSubstr("'b.study.toml' is not expected by abbe run\n"));
}

TEST_F(CommandLine, HelpIsASubcommandToo) {
  const CommandResult help = abbe({"help", "compensate", "table"});
  EXPECT_EQ(help.exit_code, ExitCode::done);
  EXPECT_EQ(help.out, abbe({"compensate", "table", "--help"}).out);
  EXPECT_EQ(abbe({"help"}).out, abbe({"--help"}).out);
  EXPECT_THAT(abbe({"help", "tabel"}).err, HasSubstr("there is no subcommand 'tabel'"));
}

TEST_F(CommandLine, VersionIsOneLine) {
  const CommandResult result = abbe({"--version"});
  EXPECT_EQ(abbe({"-V"}).out, result.out);
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
