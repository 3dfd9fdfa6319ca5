#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;
using MeasuringPrograms = CommandTest;

const std::string kPlannedPoses = ABBE_SOURCE_DIR "/examples/measuring_program/poses.csv";
const std::string kTrunnionMill = ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml";

TEST_F(MeasuringPrograms, AreWrittenWithASheet) {
  const CommandResult result = abbe({"program", kPlannedPoses, "--machine", kTrunnionMill, "--dialect", "linuxcnc",
                                     "-o", "m.ngc", "--sheet", "m.html"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("12 readings"));
  const std::string program = folder.read("m.ngc");
  EXPECT_THAT(program, HasSubstr("(MSG, station front)\nM0\n"));
  EXPECT_THAT(program, HasSubstr("(reading 12, station left, reflector nose)\nG0 C135.123456 A-60.000000"));
  EXPECT_THAT(folder.read("m.html"), HasSubstr("Station left: 5 readings"));
  const CommandResult again =
      abbe({"program", kPlannedPoses, "--machine", kTrunnionMill, "--dialect", "linuxcnc", "-o", "m.ngc"});
  EXPECT_EQ(again.exit_code, bad_input);
  EXPECT_THAT(again.err, HasSubstr("--force"));
}

TEST_F(MeasuringPrograms, GoAroundABoxOrAreNotWritten) {
  const std::vector<std::string> common = {"program",
                                           kPlannedPoses,
                                           "--machine",
                                           kTrunnionMill,
                                           "--dialect",
                                           "heidenhain",
                                           "-o",
                                           "m.h",
                                           "--obstacle-box-mm",
                                           "table=-60,-60,0,60,60,80",
                                           "--tool-radius-mm",
                                           "5",
                                           "--tool-length-mm",
                                           "150"};
  const CommandResult refused = abbe(common);
  EXPECT_EQ(refused.exit_code, computation_says_no) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("reading 2 (line 4) to reading 3 (line 5) the tool touches box 1 at"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "m.h"));
  std::vector<std::string> around = common;
  around.insert(around.end(), {"--clearance-mm", "200", "--json"});
  const CommandResult found = abbe(around);
  ASSERT_EQ(found.exit_code, done) << found.err;
  EXPECT_GE(nlohmann::json::parse(found.out).at("ways_around"), 2);
  EXPECT_THAT(folder.read("m.h"), HasSubstr("BEGIN PGM M MM"));
}

TEST_F(MeasuringPrograms, TakeMeshesOnAnAxis) {
  folder.write("post.stl", folder.read(ABBE_SOURCE_DIR "/examples/parts/wedge.stl"));
  const CommandResult result =
      abbe({"program", kPlannedPoses, "--machine", kTrunnionMill, "--dialect", "siemens", "--dry-run",
            "--obstacle-mesh", "Y=post.stl", "--tool-radius-mm", "5", "--clear-at", "Z_mm=0"});
  EXPECT_EQ(result.exit_code, done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("clear of post.stl"));
  EXPECT_THAT(result.out, HasSubstr("dry run: nothing written"));
}

/// The log that LinuxCNC would write if every touch came where it is planned.
std::string log_of_touches(const std::string& touches) {
  std::istringstream lines(touches);
  std::string line, log;
  std::getline(lines, line);  // comment
  std::getline(lines, line);  // header: C, A, Y, X, Z, ...
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::array<std::string, 5> value;
    for (std::string& one : value) std::getline(fields, one, ',');
    log += value[3] + " " + value[2] + " " + value[4] + " " + value[1] + " 0.000000 " + value[0] +
           " 0.000000 0.000000 0.000000\n";
  }
  return log;
}

TEST_F(MeasuringPrograms, TouchABallAndTheirLogBecomesReadings) {
  const std::vector<std::string> common = {
      "program",   kPlannedPoses, "--machine",      kTrunnionMill, "--dialect",       "linuxcnc", "-o", "p.ngc",
      "--touches", "touches.csv", "--clearance-mm", "150",         "--probe-ball-mm", "80",       "0"};
  std::vector<std::string> reached = common;
  reached.insert(reached.end(), {"60", "12.5"});
  const CommandResult planned = abbe(reached);
  ASSERT_EQ(planned.exit_code, done) << planned.err;
  EXPECT_THAT(planned.out, HasSubstr("60 touches of a ball at 12 positions"));
  const std::string log = log_of_touches(folder.read("touches.csv"));
  folder.write("log.txt", log);
  const CommandResult imported =
      abbe({"import", "log.txt", "--touches", "touches.csv", "--machine", kTrunnionMill, "-o", "readings.csv"});
  ASSERT_EQ(imported.exit_code, done) << imported.err;
  EXPECT_THAT(folder.read("readings.csv"),
              HasSubstr("0.000000,0.000000,0.000000,80.000000,-334.500000,nose,0,0,-1,0,"));
  folder.write("short.txt", log.substr(log.find('\n') + 1));
  const CommandResult refused = abbe({"import", "short.txt", "--touches", "touches.csv", "--machine", kTrunnionMill});
  EXPECT_EQ(refused.exit_code, bad_input);
  EXPECT_THAT(refused.err, HasSubstr("short.txt"));
  EXPECT_EQ(abbe({"import", "log.txt", "--touches", "touches.csv"}).exit_code, bad_input);

  std::vector<std::string> too_high = common;
  too_high.insert(too_high.end(), {"600", "12.5", "--force"});
  const CommandResult out_of_reach = abbe(too_high);
  EXPECT_EQ(out_of_reach.exit_code, computation_says_no);
  EXPECT_THAT(out_of_reach.err, HasSubstr("reading 1 (line 3): the ball is out of reach: Z"));
  std::vector<std::string> other = reached;
  other[5] = "siemens";
  EXPECT_THAT(abbe(other).err, HasSubstr("--force"));
  other.emplace_back("--force");
  EXPECT_THAT(abbe(other).err, HasSubstr("touches are written for LinuxCNC only"));
  EXPECT_EQ(abbe({"program", kPlannedPoses, "--machine", kTrunnionMill, "--dialect", "linuxcnc", "-o", "q.ngc",
                  "--probe-ball-mm", "80", "0", "60", "12.5", "--trigger", "dwell"})
                .exit_code,
            bad_input);
}

TEST_F(MeasuringPrograms, RefuseBadOptions) {
  const auto message = [&](std::vector<std::string> more) {
    std::vector<std::string> all = {"program", kPlannedPoses, "--machine", kTrunnionMill, "-o", "m.ngc"};
    all.insert(all.end(), more.begin(), more.end());
    const CommandResult result = abbe(all);
    EXPECT_EQ(result.exit_code, bad_input) << result.out;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "m.ngc"));
    return result.err;
  };
  EXPECT_THAT(message({"--dialect", "mazak"}), HasSubstr("--dialect"));
  EXPECT_THAT(message({"--dialect", "iso", "--trigger", "m-function"}), HasSubstr("--trigger-number: missing"));
  EXPECT_THAT(message({"--dialect", "siemens", "--obstacle-box-mm", "W=0,0,0,1,1,1"}), HasSubstr("ON is base, table"));
  EXPECT_THAT(message({"--dialect", "siemens", "--obstacle-box-mm", "base=0,0,0,1,1"}), HasSubstr("not six numbers"));
  EXPECT_THAT(message({"--dialect", "siemens", "--obstacle-box-mm", "base=0,0,0,1,1,0"}), HasSubstr("without volume"));
  EXPECT_THAT(message({"--dialect", "siemens", "--obstacle-mesh", "base=none.stl"}), HasSubstr("none.stl"));
  EXPECT_THAT(message({"--dialect", "iso", "--obstacle-box-mm", "base=0,0,0,1,1,1"}), HasSubstr("--feed-mm-per-min"));
}

}  // namespace
}  // namespace abbe
