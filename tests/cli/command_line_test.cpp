#include <gmock/gmock.h>

#include <regex>

#include "abbe/formats/text/utf8.h"
#include "cli/all_commands.h"
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

TEST_F(CommandLine, NoLineOfHelpIsWiderThan120Columns) {
  std::vector<CommandWithHelp> all = all_commands([this](const auto& words) { return abbe(words); });
  all.push_back({{"--help-all"}, abbe({"--help-all"}).out});
  EXPECT_GT(all.size(), 20U);
  for (const CommandWithHelp& one : all) {
    std::istringstream lines(one.help);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(characters_in(line), 120U) << testing::PrintToString(one.words) << ": " << line;
    }
  }
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
  EXPECT_THAT(refusal({"verfy"}),
              HasSubstr("there is no subcommand 'verfy'. Did you mean verify? abbe --help lists them all."));
  EXPECT_THAT(refusal({"compensate", "tabel"}),
              HasSubstr("'tabel' is not expected by abbe compensate; did you mean table?"));
  EXPECT_THAT(refusal({"run", "--jsn", "a.study.toml"}),
              HasSubstr("'--jsn' is not an option of abbe run; did you mean --json?"));
  // Also where something is missing because of it, and with a value.
  EXPECT_THAT(refusal({"map", "--grd=X_mm=1", "m.toml"}),
              HasSubstr("'--grd' is not an option of abbe map; did you mean --grid?"));
  EXPECT_THAT(refusal({"run", "a.study.toml", "b.study.toml"}),
              HasSubstr("'b.study.toml' is not expected by abbe run\n"));
  EXPECT_THAT(refusal({"--json", "run", "a.study.toml"}), HasSubstr("'--json' is expected behind abbe run\n"));
}

TEST_F(CommandLine, EveryCommandRefusesWhatItDoesNotKnow) {
  const auto run = [this](const std::vector<std::string>& words) { return abbe(words); };
  const std::vector<CommandWithHelp> commands = all_commands(run);
  ASSERT_GT(commands.size(), 30U);
  for (const CommandWithHelp& one : commands) {
    std::string typed = "abbe";
    for (const std::string& word : one.words) typed += " " + word;
    const auto expect_refused = [&](const std::string& word, const std::string& problem) {
      std::vector<std::string> words = one.words;
      words.push_back(word);
      const CommandResult result = abbe(words);
      EXPECT_EQ(result.exit_code, ExitCode::bad_input) << typed << " " << word;
      EXPECT_EQ(result.out, "") << typed << " " << word;
      EXPECT_EQ(result.err.find("abbe: '" + word + "' is " + problem), 0U)
          << typed << " " << word << ": " << result.err;
    };
    expect_refused("--hlp", "not an option of " + typed + "; did you mean --help?");
    if (one.help.find("SUBCOMMAND") != std::string::npos && typed != "abbe" && typed != "abbe verify") {
      expect_refused("nonsense", "not expected by " + typed + "\n");
    }
  }
}

TEST_F(CommandLine, EveryCommandCanBeQuiet) {
  for (const CommandWithHelp& one : all_commands([this](const auto& words) { return abbe(words); })) {
    EXPECT_THAT(one.help, HasSubstr("-q,--quiet")) << testing::PrintToString(one.words);
  }
}

TEST_F(CommandLine, QuietLeavesResultsWarningsAndExitCodes) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  const std::vector<std::string> files = {"--machine", examples + "machines/trunnion-mill.machine.toml", "--errors",
                                          examples + "compensate/trunnion.errors.toml"};
  const auto run = [&](std::vector<std::string> words, const std::vector<std::string>& more = {}) {
    words.insert(words.end(), more.begin(), more.end());
    return abbe(words);
  };
  std::vector<std::string> map = {"map", "--grid", "X_mm=0", "--force", "-o", "map.csv"};
  map.insert(map.end(), files.begin(), files.end());
  ASSERT_THAT(run(map).out, HasSubstr("map.csv written"));
  const std::string written = folder.read("map.csv");
  const CommandResult quiet = run(map, {"--quiet"});
  EXPECT_EQ(quiet.exit_code, ExitCode::done) << quiet.err;
  EXPECT_EQ(quiet.out + quiet.err, "");
  map.insert(map.begin(), "-q");
  EXPECT_EQ(run(map).out, "");
  map.erase(map.begin());
  EXPECT_EQ(folder.read("map.csv"), written);
  // What was asked for comes nevertheless.
  EXPECT_EQ(run(map, {"-q", "--json"}).out, run(map, {"--json"}).out);
  const std::vector<std::vector<std::string>> on_standard_output = {
      {"new", "w X b Z t"}, {"test-piece", "s-shape"}, {"completion", "bash"}, {"man"}, {"man", "--list"}};
  for (const std::vector<std::string>& words : on_standard_output) {
    const std::string text = run(words).out;
    EXPECT_NE(text, "") << words[0];
    EXPECT_EQ(run(words, {"-q"}).out, text) << words[0];
  }
  EXPECT_EQ(run({"new", "w X b Z t"}, {"-q", "-o", "new.machine.toml"}).out, "");
  // An answer of no, and bad input.
  const std::vector<std::string> positioning = {"evaluate", "positioning", examples + "evaluate/linear.csv",
                                                "--tolerance", "A_um=0.001"};
  const CommandResult no = run(positioning, {"--quiet"});
  EXPECT_EQ(no.exit_code, ExitCode::computation_says_no);
  EXPECT_EQ(no.out, "");
  const CommandResult bad = abbe({"run", "none.study.toml", "--quiet"});
  EXPECT_EQ(bad.exit_code, ExitCode::bad_input);
  EXPECT_THAT(bad.err, HasSubstr("there is no such file"));
}

TEST_F(CommandLine, MachineAndErrorsAsArgumentsAreAnOldFormThatStillWorks) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/", mill = examples + "machines/trunnion-mill.machine.toml",
                    errors = examples + "compensate/trunnion.errors.toml",
                    three_axes = examples + "machines/three-axis-mill.machine.toml",
                    three_errors = examples + "compensate/mill.errors.toml",
                    engraver = examples + "machines/yin-engraver-u.machine.toml",
                    curve = examples + "laser_engraver/table-a4.csv",
                    scanner = examples + "machines/liu-scanner.machine.toml",
                    readings = examples + "cradle_scanner/readings.csv", poses = examples + "compensate/poses.csv";
  struct Form {
    std::vector<std::string> old, now;
  };
  const std::string placement = examples + "laser_engraver/part.placement.toml";
  const Form forms[] = {
      {{"check", mill, "--errors", errors}, {"check", "--machine", mill, "--errors", errors}},
      {{"map", mill, errors, "--grid", "X_mm=0"}, {"map", "--grid", "X_mm=0", "--errors", errors, "--machine", mill}},
      {{"compensate", "table", three_axes, three_errors, "--for", "linuxcnc", "--dry-run"},
       {"compensate", "table", "--machine", three_axes, "--errors", three_errors, "--for", "linuxcnc", "--dry-run"}},
      {{"compensate", "freeze", three_axes, three_errors, "--dry-run"},
       {"compensate", "freeze", "--machine", three_axes, "--errors", three_errors, "--dry-run"}},
      {{"compensate", "poses", mill, errors, poses, "--dry-run"},
       {"compensate", "poses", poses, "--machine", mill, "--errors", errors, "--dry-run"}},
      {{"path", engraver, "--placement", placement, curve},
       {"path", "--placement", placement, "--machine", engraver, curve}},
      {{"scan", "points", scanner, readings, "--force", "-o", "p.csv"},
       {"scan", "points", readings, "--machine", scanner, "--force", "-o", "p.csv"}}};
  for (const Form& form : forms) {
    const CommandResult now = abbe(form.now), old = abbe(form.old);
    EXPECT_NE(now.exit_code, ExitCode::bad_input) << now.err;
    EXPECT_EQ(old.exit_code, now.exit_code) << old.err;
    EXPECT_EQ(old.out, now.out);
    const std::string machine = form.old[form.old[0] == "compensate" || form.old[0] == "scan" ? 2 : 1];
    EXPECT_EQ(old.err.find("abbe: warning: this is an old form of the command; write --machine " + machine), 0U)
        << old.err;
    EXPECT_EQ(old.err.substr(old.err.find('\n') + 1), now.err);
    EXPECT_EQ(old.err.substr(0, old.err.find('\n')).find(" --errors ") != std::string::npos,
              form.old[0] == "map" || form.old[0] == "compensate");
  }
  // Neither the old form nor the new one.
  EXPECT_THAT(abbe({"map", mill}).err, HasSubstr("'" + mill + "' is not expected by abbe map\n"));
  EXPECT_THAT(abbe({"map", mill, "--machine", mill, "--errors", errors}).err,
              HasSubstr("is not expected by abbe map\n"));
  EXPECT_THAT(abbe({"path", curve}).err, HasSubstr("abbe: --machine is required"));
  EXPECT_EQ(abbe({"map", mill, errors, "--machine", mill}).exit_code, ExitCode::bad_input);
  EXPECT_EQ(abbe({"map", "--help"}).out.find("arguments"), std::string::npos);
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
