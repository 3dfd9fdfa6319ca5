// `abbe reproduce` goes on as abbe-papers, a program beside it.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "cli/command_test.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

class PapersProgram : public CommandTest {
 protected:
  /// Another program in the place of abbe-papers.
  std::string program(const std::string& contents) const {
    const fs::path path = folder.write("another-program", contents);
    fs::permissions(path, fs::perms::owner_all);
    return "ABBE_PAPERS_PROGRAM=" + path.string();
  }
};

TEST_F(PapersProgram, GetsTheOptionsThatWereGivenAndAnswersInPlaceOfTheCommand) {
  const std::string says = program("#!/bin/sh\nprintf '%s\\n' \"$@\"; echo said >&2; exit 7\n");
  const CommandResult all =
      abbe({"reproduce", "wang", "--grids", "my grids", "--json", "--output=-out", "--threads", "3"}, {says});
  EXPECT_EQ(all.exit_code, 7);
  EXPECT_EQ(all.out, "wang\n--output=-out\n--grids=my grids\n--threads=3\n--json\n");
  EXPECT_EQ(all.err, "said\n");
  EXPECT_EQ(abbe({"reproduce", "ma"}, {says}).out, "ma\n");
}

TEST_F(PapersProgram, ThatIsMissingIsSaidWithWhereItWasLookedFor) {
  const std::string alone = folder.path() / "abbe", beside = fs::canonical(folder.path()) / "abbe-papers";
  fs::copy_file(ABBE_COMMAND, alone);
  const CommandResult result = run_program(alone, {"reproduce", "ma"}, folder.path(), {"ABBE_PAPERS_PROGRAM="});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err,
            "abbe: abbe-papers: this program, which recomputes the published studies, is missing; expected it at " +
                beside + " (`make build` makes it), or its name in the environment variable ABBE_PAPERS_PROGRAM\n");
  EXPECT_EQ(run_program(alone, {"reproduce", "--help"}, folder.path()).exit_code, ExitCode::done);
}

TEST_F(PapersProgram, ThatIsNoProgramIsRefused) {
  const CommandResult none = abbe({"reproduce", "ma"}, {"ABBE_PAPERS_PROGRAM=/nowhere"});
  EXPECT_EQ(none.exit_code, ExitCode::bad_input);
  EXPECT_EQ(none.err,
            "abbe: ABBE_PAPERS_PROGRAM names /nowhere, which is no program; expected the program abbe-papers, or no "
            "such variable\n");
  const CommandResult text = abbe({"reproduce", "ma"}, {program("no program\n")});
  EXPECT_EQ(text.exit_code, ExitCode::bad_input);
  EXPECT_EQ(text.err, "abbe: " + (folder.path() / "another-program").string() +
                          ": cannot be started: Exec format error; expected the program abbe-papers\n");
}

TEST_F(PapersProgram, HasTheHelpAndTheMessagesOfTheSubcommand) {
  const std::string papers = fs::path(ABBE_COMMAND).parent_path() / "abbe-papers";
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"--help"}, {}, {"euler"}, {"ma", "--nonsense"}, {"ma", "--grids", "grids"}, {"wang", "--grids", "grids"}}) {
    std::vector<std::string> words{"reproduce"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const CommandResult command = abbe(words), program = run_program(papers, arguments, folder.path());
    EXPECT_EQ(program.exit_code, command.exit_code) << testing::PrintToString(arguments);
    EXPECT_EQ(program.out, command.out);
    EXPECT_EQ(program.err, command.err);
  }
}

}  // namespace
}  // namespace abbe
