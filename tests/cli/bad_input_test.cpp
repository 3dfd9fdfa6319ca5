#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/command_test.h"

namespace abbe {
namespace {

const char* const kEndlessTable =
    "name = \"m\"\nchain = \"w C' X' b Z t\"\n[axis.C]\nendless = true\n[axis.X]\ntravel_mm = [0, 1400]\n"
    "[axis.Z]\ntravel_mm = [0, 600]\n";

/// Bad input: exit code 2, nothing on standard output, one line on standard error that says where and what.
class BadInput : public CommandTest {
 protected:
  void expect_refused(const std::vector<std::string>& arguments, const std::string& message) const {
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, "abbe: " + message + "\n");
  }

  /// Checks the machine with one passage replaced.
  void expect_machine_refused(const std::string& from, const std::string& to, const std::string& message) const {
    std::string text = kEndlessTable;
    ASSERT_NE(text.find(from), std::string::npos);
    folder.write("m.toml", text.replace(text.find(from), from.size(), to));
    expect_refused({"check", "--machine", "m.toml"}, message);
  }
};

TEST_F(BadInput, NamesFileLineFieldAndUnit) {
  expect_machine_refused(
      "travel_mm = [0, 1400]", "travel_deg = [0, 1400]",
      "m.toml:6:1: axis.X.travel_deg: 'deg' is not a unit of a length; expected travel_mm, travel_um "
      "or travel_m");
  expect_machine_refused("[0, 1400]", "[0, nan]",
                         "m.toml:6:17: axis.X.travel_mm[2]: nan is not a finite number; expected a length in mm");
  expect_machine_refused(
      "[0, 1400]", "[0, 1e308]",
      "m.toml:6:17: axis.X.travel_mm[2]: 1e308 is too large; expected a length in mm, at most 1e9 mm");
  expect_machine_refused("[axis.X]", "[axis.Y]",
                         "m.toml:5:7: axis.Y: the chain has no axis Y; expected one of C, X, Z");
}

TEST_F(BadInput, ControlCharactersOfNamesAndArgumentsAreRefused) {
  expect_machine_refused("\"m\"", R"("m\u001b[2J\nall is well")",
                         "m.toml:1:8: name: has control characters in it; expected a text on one line");
  expect_refused({"check", "--machine", "a\nb\x1b[31m.toml"},
                 "a\\x0ab\\x1b[31m.toml: has control characters in it; expected a name or an option on one line");
  expect_refused({"check", "--machine", "a\xff\u202e.toml"}, "a\\xff\\xe2\\x80\\xae.toml: there is no such file");
}

TEST_F(BadInput, WhatATerminalWouldObeyIsShownAsNumbersAndReadsBackFromJson) {
  // Letters behind the direction override would be read from right to left, and the byte 0xff is no UTF-8.
  std::string text = kEndlessTable;
  text.replace(text.find("\"m\""), 3, "\"mill \\u202e\u00fc\"");
  const std::string name = "m\xff.toml";
  folder.write(name, text);
  const CommandResult people = abbe({"check", "--machine", name});
  EXPECT_EQ(people.exit_code, ExitCode::done) << people.err;
  EXPECT_THAT(people.out, testing::HasSubstr("mill \\xe2\\x80\\xae\u00fc"));
  EXPECT_THAT(people.out, testing::Not(testing::HasSubstr("\u202e")));
  const CommandResult programs = abbe({"check", "--machine", name, "--json"});
  EXPECT_THAT(programs.out, testing::HasSubstr("mill \\u202e\u00fc"));
  EXPECT_EQ(nlohmann::json::parse(programs.out).at("name"), "mill \u202e\u00fc");
  // Escape codes of a table of points come to the message of what is wrong with them, and of a file's name to the
  // title.
  std::filesystem::copy(ABBE_SOURCE_DIR "/examples/fit/bore.csv", folder.path() / "bore\xff.csv");
  const CommandResult fit = abbe({"fit", "bore\xff.csv", "--shape", "cylinder"});
  EXPECT_THAT(fit.out, testing::HasSubstr("bore\\xff.csv"));
  EXPECT_THAT(fit.out, testing::Not(testing::HasSubstr("\xff")));
  const CommandResult json = abbe({"fit", "bore\xff.csv", "--shape", "cylinder", "--json"});
  EXPECT_TRUE(nlohmann::json::accept(json.out)) << json.out;
}

TEST_F(BadInput, TrueErrorsThatNoMachineHasOrThatLeaveNothingToReadAreNamed) {
  const std::filesystem::path examples = ABBE_SOURCE_DIR "/examples";
  for (const std::string part : {"cradle_scanner", "machines"}) {
    std::filesystem::copy(examples / part, folder.path() / part, std::filesystem::copy_options::recursive);
  }
  const std::string text = folder.read("cradle_scanner/stages.errors.toml"), value = "value_deg = -0.8466";
  const auto simulated_with = [&](const std::string& other) {
    std::string changed = text;
    folder.write("cradle_scanner/stages.errors.toml", changed.replace(changed.find(value), value.size(), other));
    return abbe({"simulate", "cradle_scanner/calibration.study.toml", "-o", "out"});
  };
  const CommandResult implausible = simulated_with("value_deg = -846.6");
  EXPECT_EQ(implausible.exit_code, ExitCode::bad_input);
  EXPECT_THAT(implausible.err, testing::HasSubstr("stages.errors.toml:23:1: location[7].value_deg: is too large for an "
                                                  "error of a machine; expected at most 90 deg to either side"));
  const CommandResult unreadable = simulated_with("value_deg = 45");
  EXPECT_EQ(unreadable.exit_code, ExitCode::bad_input);
  EXPECT_THAT(unreadable.err,
              testing::HasSubstr("stages.errors.toml: indication: reads nothing at C = 90 deg, A = 0 deg, X = 3 mm"));
  EXPECT_THAT(unreadable.err, testing::HasSubstr("in set-up chuck with the true errors"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST_F(BadInput, EmptyAndMissingFiles) {
  folder.write("empty.toml", "");
  expect_refused({"check", "--machine", "empty.toml"}, "empty.toml: the file is empty");
  expect_refused({"check", "--machine", "none.toml"}, "none.toml: there is no such file");
  expect_refused({"check", "--machine", "."}, ".: is a folder; expected a file");
}

TEST_F(BadInput, FilesOfAnotherKindAreToldByTheirNames) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  const std::string machine = examples + "machines/three-axis-mill.machine.toml";
  const std::string errors = examples + "compensate/mill.errors.toml", study = examples + "aguado/aguado.study.toml";
  const std::string problem = ": has the name of another kind of file; expected a file named *";
  expect_refused({"map", "--machine", errors, "--errors", machine}, errors + problem + ".machine.toml");
  expect_refused({"map", "--machine", machine, "--errors", study}, study + problem + ".errors.toml");
  expect_refused({"run", machine}, machine + problem + ".study.toml");
  folder.write("errors.toml", "chain = \"w b X Y Z t\"\n");
  expect_refused({"run", "errors.toml"}, "errors.toml" + problem + ".study.toml");
  expect_refused({"run"}, "study is required\nabbe: Run with --help or --help-all for more information.");
}

TEST_F(BadInput, ErrorsOfAnotherMachine) {
  folder.write("m.toml", kEndlessTable);
  folder.write("e.toml", "chain = \"w b X Y Z t\"\n");
  expect_refused({"check", "--machine", "m.toml", "--errors", "e.toml"},
                 "e.toml:1:1: chain: the errors belong to \"w b X Y Z t\"; expected \"w C' X' b Z t\"");
}

TEST_F(BadInput, ByteOrderMarkAndCarriageReturnsAreGoodInput) {
  std::string text = "\xEF\xBB\xBF";
  for (const char* at = kEndlessTable; *at != 0; ++at) text += *at == '\n' ? std::string("\r\n") : std::string(1, *at);
  folder.write("m.toml", text);
  const CommandResult result = abbe({"check", "--machine", "m.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
}

}  // namespace
}  // namespace abbe
