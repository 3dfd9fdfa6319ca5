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
  /// A program in the place of abbe-papers that does something else, but states the version of the command.
  std::string program_of_this_version(const std::string& contents) const {
    return program("#!/bin/sh\nif [ \"$1\" = --version ]; then echo \"abbe-papers " + version() + "\"; exit; fi\n" +
                   contents);
  }

  std::string version() const {
    const std::string said = abbe({"--version"}).out;
    return said.substr(5, said.size() - 6);  // between "abbe " and the line feed
  }

  /// Another program in the place of abbe-papers.
  std::string program(const std::string& contents) const {
    const fs::path path = folder.write("another-program", contents);
    fs::permissions(path, fs::perms::owner_all);
    return "ABBE_PAPERS_PROGRAM=" + path.string();
  }
};

TEST_F(PapersProgram, GetsTheOptionsThatWereGivenAndAnswersInPlaceOfTheCommand) {
  const std::string says = program_of_this_version("printf '%s\\n' \"$@\"; echo said >&2; exit 7\n");
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
            "abbe: ABBE_PAPERS_PROGRAM names /nowhere, which is not a program; expected the program abbe-papers, or no "
            "such variable\n");
  const CommandResult text = abbe({"reproduce", "ma"}, {program("no program\n")});
  EXPECT_EQ(text.exit_code, ExitCode::bad_input);
  EXPECT_EQ(text.err, "abbe: " + (folder.path() / "another-program").string() +
                          ": cannot be started: Exec format error; expected a program\n");
}

TEST_F(PapersProgram, OfAnotherVersionIsRefused) {
  const std::string path = folder.path() / "another-program";
  const std::string expected = "; expected abbe-papers " + version() + " (`make build` makes both)\n";
  const CommandResult older = abbe({"reproduce", "ma"}, {program("#!/bin/sh\necho abbe-papers 0.0.9\n")});
  EXPECT_EQ(older.exit_code, ExitCode::bad_input);
  EXPECT_EQ(older.out, "");
  EXPECT_EQ(older.err, "abbe: " + path + ": is version 0.0.9, and abbe is " + version() + expected);
  // Programs from before there was the question answer with a message or with something else.
  for (const char* const contents : {"#!/bin/sh\necho unknown option >&2; exit 2\n", "#!/bin/sh\necho 0.1.0\n"}) {
    const CommandResult silent = abbe({"reproduce", "ma"}, {program(contents)});
    EXPECT_EQ(silent.exit_code, ExitCode::bad_input);
    EXPECT_EQ(silent.err, "abbe: " + path + ": does not state its version, and abbe is " + version() + expected);
  }
}

TEST_F(PapersProgram, StatesTheVersionOfTheCommand) {
  const std::string papers = fs::path(ABBE_COMMAND).parent_path() / "abbe-papers";
  EXPECT_EQ(run_program(papers, {"--version"}, folder.path()).out, "abbe-papers " + version() + "\n");
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
