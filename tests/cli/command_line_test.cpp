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

}  // namespace
}  // namespace abbe
