// Every command that uses errors with states: what it does with them, and what it says beyond what was measured.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

const char* const kMillOfStates = R"(name = "mill"
chain = "w b X Y Z t"
[axis.X]
travel_mm = [0, 600]
[axis.Y]
travel_mm = [0, 400]
[axis.Z]
travel_mm = [0, 300]
[state.hall]
kind = "measured"
unit = "degC"
[state.ram]
kind = "axis"
axis = "Z"
reference_mm = 100
[state.side]
kind = "approach"
axis = "X"
)";

std::string line_motion(const char* name, const char* state, const char* values) {
  const std::string of = *state == '\0' ? "" : std::string("state = \"") + state + "\"\n";
  return std::string("[[motion]]\nname = \"") + name + "\"\n" + of +
         "basis = \"legendre\"\norder = 1\ncoefficients_um = " + values + "\nstandard_uncertainty_um = [0.1, 0.1]\n";
}

/// Errors in length only: the tool is displaced by their sum.
std::string computed_errors() {
  return line_motion("EXX", "", "[0, 12]") + line_motion("EZX", "ram", "[0.05, 0.03]") +
         line_motion("EYX", "side", "[3, 1]") + line_motion("EYY", "ram", "[0, -0.04]");
}

std::string measured_errors(double per_kelvin) {
  return line_motion("EXX", "", "[0, 12]") + line_motion("EYY", "", "[0, 5]") +
         line_motion("EXX", "hall", ("[0, " + std::to_string(per_kelvin) + "]").c_str());
}

const char* const kCoveredHall = "[covered]\nhall_degC = [18, 27]\n";

class StateUses : public CommandTest {
 protected:
  void SetUp() override {
    folder.write("mill.machine.toml", kMillOfStates);
    folder.write("computed.errors.toml", computed_errors());
    folder.write("warm.errors.toml", measured_errors(2) + kCoveredHall);
    folder.write("part.ngc",
                 "G21 G90 G17\nG0 X10 Y10 Z200\nG1 X500 Y350 Z100 F2000\nG1 X20 Y300 Z20\nG1 X400 Y50 Z250\nM2\n");
    folder.write("poses.csv", "X_mm,Y_mm,Z_mm\n10,20,30\n590,390,290\n");
  }

  CommandResult run(std::vector<std::string> arguments, const std::string& errors,
                    const std::vector<std::string>& more = {}) const {
    for (const char* const one : {"--machine", "mill.machine.toml", "--errors"}) arguments.emplace_back(one);
    arguments.push_back(errors + ".errors.toml");
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }
};

using ToolPlace = std::array<double, 3>;

/// Ends of the moves of a program in X, Y and Z, words that are left out included.
std::vector<ToolPlace> ends_of_moves(const std::string& program) {
  std::vector<ToolPlace> ends;
  std::istringstream lines(program);
  ToolPlace at{};
  for (std::string line; std::getline(lines, line);) {
    bool moves = false;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const std::size_t axis = std::string("XYZ").find(word[0]);
      if (axis == std::string::npos || word.size() < 2) continue;
      at[axis] = std::stod(word.substr(1));
      moves = true;
    }
    if (moves) ends.push_back(at);
  }
  return ends;
}

/// Where the tool of the machine with computed_errors() is, by hand.
ToolPlace tool_with_states(const ToolPlace& q, double side) {
  const double x = (q[0] - 300) / 300, y = (q[1] - 200) / 200, ram = q[2] - 100;
  return {q[0] + 1e-3 * 12 * x, q[1] + 1e-3 * side * (3 + x) - 1e-3 * 0.04 * y * ram,
          q[2] + 1e-3 * (0.05 + 0.03 * x) * ram};
}

double way_between(const ToolPlace& a, const ToolPlace& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

TEST_F(StateUses, ProgramsAreCorrectedForStatesThatFollowFromTheirMotions) {
  const CommandResult result =
      run({"compensate", "gcode", "part.ngc", "-o", "out.ngc", "--decimals", "9", "--json"}, "computed");
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["not_proven"]["count"], 0);
  const std::vector<ToolPlace> ends = ends_of_moves(folder.read("out.ngc"));
  const std::vector<ToolPlace> wanted = {{500, 350, 100}, {20, 300, 20}, {400, 50, 250}};
  const std::array<double, 3> side = {1, -1, 1};  // from which X comes
  std::size_t next = 0, take_ups = 0;
  ToolPlace from = {10, 10, 200};
  for (const ToolPlace& end : ends) {
    if (next == wanted.size()) break;
    // On the line of the move, but for the few micrometres where X turns round.
    const ToolPlace& to = wanted[next];
    const ToolPlace at = tool_with_states(end, side[next]);
    double share = 0, square = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      share += (at[i] - from[i]) * (to[i] - from[i]);
      square += (to[i] - from[i]) * (to[i] - from[i]);
    }
    share /= square;
    const ToolPlace on_line = {from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]),
                               from[2] + share * (to[2] - from[2])};
    if (share > 1e-4) {
      EXPECT_LE(way_between(at, on_line), 1e-6) << "move " << next;
    } else {
      ++take_ups;
    }
    if (way_between(at, to) > 1e-6) continue;
    from = to;
    ++next;
  }
  EXPECT_EQ(next, wanted.size());
  EXPECT_GE(take_ups, 2U);
}

TEST_F(StateUses, WhatLiesBeyondTheReadingsIsSaidInOneWay) {
  const std::vector<std::vector<std::string>> commands = {{"map"},
                                                          {"verify", "--truth", "warm.errors.toml", "--poses", "20"},
                                                          {"compensate", "gcode", "part.ngc", "--dry-run"},
                                                          {"compensate", "poses", "poses.csv", "--dry-run"},
                                                          {"compensate", "freeze", "--dry-run"},
                                                          {"compensate", "table", "--for", "linuxcnc", "--dry-run"}};
  for (const std::vector<std::string>& command : commands) {
    SCOPED_TRACE(command[0] + " " + command[1 % command.size()]);
    const CommandResult inside = run(command, "warm", {"--state", "hall_degC=26"});
    EXPECT_EQ(inside.exit_code, ExitCode::done) << inside.err;
    EXPECT_EQ(inside.err.find("outside"), std::string::npos) << inside.err;
    const CommandResult outside = run(command, "warm", {"--state", "hall_degC=31", "--json"});
    EXPECT_EQ(outside.exit_code, ExitCode::computation_says_no);
    EXPECT_THAT(outside.err, HasSubstr("hall_degC = 31 lies outside the 18 to 27 that the readings cover: the errors "
                                       "are extrapolated"));
    EXPECT_EQ(nlohmann::json::parse(outside.out)["states_outside_measured"].size(), 1U);
  }
}

TEST_F(StateUses, TablesOverADaySayWhenItWasWarmerThanMeasured) {
  folder.write("day.csv", "time_h,hall_degC\n0,24\n10,24\n18,30\n24,24\n");
  const CommandResult day =
      run({"compensate", "table", "--for", "aerotech-2d", "--positions", "4", "--dry-run", "--state-over", "day.csv"},
          "warm", {"--state", "hall_degC=24"});
  EXPECT_EQ(day.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(day.err, HasSubstr("the states of day.csv lie outside what the readings cover at "));
}

TEST_F(StateUses, ReadingsAreVerifiedAtTheirOwnStates) {
  std::string poses = "X_mm,Y_mm,Z_mm,hall_degC\n", plain = "X_mm,Y_mm,Z_mm\n";
  for (int k = 0; k < 150; ++k) {
    const std::string place =
        std::to_string(37 * k % 601) + "," + std::to_string(53 * k % 401) + "," + std::to_string(71 * k % 301);
    poses += place + "," + std::to_string(18 + k % 9) + "\n";
    plain += place + "\n";
  }
  folder.write("warm-poses.csv", poses);
  folder.write("plain-poses.csv", plain);
  const auto study = [&](const char* name, const std::string& simulated, const std::string& readings) {
    folder.write(name, "machine = \"mill.machine.toml\"\nseed = 3\n" + simulated +
                           "[[setup]]\nname = \"tracker\"\ninstrument = \"tracker\"\nmounted_on = \"workpiece\"\n"
                           "noise = { xyz_um = 1 }\n[[setup.station]]\nname = \"S\"\npose = \"find\"\n" +
                           (simulated.empty() ? "" : "true_pose = { position_mm = [900, -1500, 300] }\n") +
                           "[[setup.reflector]]\nname = \"R\"\noffset_mm = [0, 0, 0]\n" + readings);
  };
  const std::string truth = "[simulate]\nerrors = \"warm.errors.toml\"\n";
  study("day.study.toml", truth, "[[setup.plan]]\nkind = \"poses\"\nfile = \"warm-poses.csv\"\n");
  const CommandResult simulated = abbe({"simulate", "day.study.toml", "-o", "readings"});
  ASSERT_EQ(simulated.exit_code, ExitCode::done) << simulated.err;
  study("new.study.toml", "", "[[setup.data]]\nfile = \"readings/tracker.csv\"\n");
  const auto verified = [&](const std::string& of, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"verify", "--readings", of, "--errors", "warm.errors.toml", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  };
  const CommandResult own = verified("new.study.toml", {});
  EXPECT_EQ(own.exit_code, ExitCode::done) << own.err << own.out;
  // The same errors without their states explain much less of the same readings.
  folder.write("cold.errors.toml", line_motion("EXX", "", "[0, 12]") + line_motion("EYY", "", "[0, 5]"));
  const CommandResult cold = abbe({"verify", "--readings", "new.study.toml", "--errors", "cold.errors.toml", "--json"});
  EXPECT_EQ(cold.exit_code, ExitCode::computation_says_no);
  const CommandResult twice = verified("new.study.toml", {"--state", "hall_degC=22"});
  EXPECT_EQ(twice.exit_code, ExitCode::bad_input);
  EXPECT_THAT(twice.err, HasSubstr("the readings of 'tracker' have this state"));
  folder.write("warm.errors.toml", measured_errors(2) + "[covered]\nhall_degC = [18, 24]\n");
  const CommandResult beyond = verified("new.study.toml", {});
  EXPECT_EQ(beyond.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(beyond.err, HasSubstr("tracker: hall_degC lies outside the 18 to 24 that the readings cover at "));
  EXPECT_EQ(verified("new.study.toml", {"--accept-uncovered"}).exit_code, ExitCode::done);

  // Readings that do not say how warm it was.
  folder.write("at24.errors.toml", line_motion("EXX", "", "[0, 20]") + line_motion("EYY", "", "[0, 5]"));
  study("plain.study.toml", "[simulate]\nerrors = \"at24.errors.toml\"\n",
        "[[setup.plan]]\nkind = \"poses\"\nfile = \"plain-poses.csv\"\n");
  const CommandResult cool = abbe({"simulate", "plain.study.toml", "-o", "plain"});
  ASSERT_EQ(cool.exit_code, ExitCode::done) << cool.err;
  study("plain-new.study.toml", "", "[[setup.data]]\nfile = \"plain/tracker.csv\"\n");
  const CommandResult missing = verified("plain-new.study.toml", {});
  EXPECT_EQ(missing.exit_code, ExitCode::bad_input);
  EXPECT_THAT(missing.err, HasSubstr("the errors depend on hall, which is not given at all readings; expected a "
                                     "column hall_degC in the readings, a channel, or --state hall_degC=VALUE"));
  EXPECT_EQ(verified("plain-new.study.toml", {"--state", "hall_degC=24"}).exit_code, ExitCode::done);
}

TEST_F(StateUses, CampaignsAreComparedByWhatChangesWithTheState) {
  folder.write("later.errors.toml", measured_errors(4));
  const auto compared = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"compare",   "warm.errors.toml",  "later.errors.toml",
                                          "--machine", "mill.machine.toml", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  };
  const CommandResult at_reference = compared({});
  ASSERT_EQ(at_reference.exit_code, ExitCode::done) << at_reference.err;
  EXPECT_THAT(at_reference.out, HasSubstr("EXX*hall"));
  EXPECT_THAT(at_reference.out, HasSubstr("hall_degC = 20"));
  const auto largest = [](const CommandResult& result) {
    return nlohmann::json::parse(result.out)["figures"]["V_max"];
  };
  EXPECT_NEAR(largest(at_reference)["value_um"].get<double>(), 0, 1e-9);
  // 5 K at 2 um/K more; u of the slopes of EXX, EXX*hall and EYY 0.1 um in either campaign.
  const CommandResult warm = compared({"--state", "hall_degC=25"});
  ASSERT_EQ(warm.exit_code, ExitCode::done) << warm.err;
  EXPECT_NEAR(largest(warm)["value_um"].get<double>(), 10, 1e-6);
  EXPECT_NEAR(largest(warm)["expanded_uncertainty_um"].get<double>(), 2 * std::sqrt(2 * 0.01 * (1 + 25 + 1)), 1e-2);
  EXPECT_EQ(compared({"--state", "hall_degC=31"}).exit_code, ExitCode::computation_says_no);

  // Results of machines that mean something else by the same name.
  const auto results = [&](const std::string& name, const std::string& machine, double per_kelvin) {
    std::filesystem::create_directories(folder.path() / name);
    folder.write(name + "/machine.toml", machine);
    folder.write(name + "/errors.toml", measured_errors(per_kelvin));
    folder.write(name + "/summary.json", "{}");
  };
  std::string other = kMillOfStates;
  const std::string unit = "unit = \"degC\"\n";
  other.insert(other.find(unit) + unit.size(), "reference_degC = 22\n");
  results("march", kMillOfStates, 2);
  results("june", other, 2);
  const CommandResult differ = abbe({"compare", "march", "june"});
  EXPECT_EQ(differ.exit_code, ExitCode::bad_input);
  EXPECT_THAT(differ.err, HasSubstr("state.hall: hall has the reference 22 instead of 20 (in march/errors.toml)"));
}

/// Every command that takes errors, with errors that depend on a measured state and on the commands.
TEST_F(StateUses, NoCommandOverlooksAState) {
  folder.write("both.errors.toml", computed_errors() + line_motion("EXX", "hall", "[0, 2]"));
  folder.write("curve.csv", "x_mm,y_mm,z_mm,i,j,k\n10,10,10,0,0,1\n20,10,10,0,0,1\n");
  folder.write("scan.csv", "X_mm,Y_mm,Z_mm,distance_mm\n10,10,10,1\n");
  const std::vector<std::vector<std::string>> commands = {
      {"map"},
      {"verify", "--truth", "both.errors.toml", "--poses", "20"},
      {"path", "curve.csv", "-o", "curve.ngc", "--feed-mm-per-min", "100"},
      {"compensate", "gcode", "part.ngc", "--dry-run"},
      {"compensate", "freeze", "--dry-run"},
      {"compensate", "table", "--for", "linuxcnc", "--dry-run"},
      {"compensate", "table", "--for", "lattice-csv", "--dry-run"},
      {"compensate", "kinematics", "--for", "siemens", "--dry-run"}};
  for (const std::vector<std::string>& command : commands) {
    SCOPED_TRACE(command[0] + " " + command[1 % command.size()]);
    if (command[1 % command.size()] != "freeze") {
      const CommandResult without = run(command, "both");
      EXPECT_EQ(without.exit_code, ExitCode::bad_input);
      EXPECT_THAT(without.err, HasSubstr("--state hall_degC=VALUE"));
    }
    // With the measured state the rest is taken, or it is said of which error it is not.
    const CommandResult with = run(command, "both", {"--state", "hall_degC=22"});
    if (with.exit_code != ExitCode::done) {
      EXPECT_EQ(with.exit_code, ExitCode::bad_input) << with.err;
      EXPECT_THAT(with.err,
                  AnyOf(HasSubstr("depends on"), HasSubstr("depend on"), HasSubstr("state"), HasSubstr("rotary axes")))
          << with.err;
    }
  }
}

TEST_F(StateUses, APathIsCorrectedAtEveryPose) {
  folder.write("curve.csv", "x_mm,y_mm,z_mm,i,j,k\n10,10,10,0,0,1\n400,10,250,0,0,1\n20,300,90,0,0,1\n");
  const CommandResult result =
      run({"path", "curve.csv", "-o", "path.csv", "--feed-mm-per-min", "100", "--json"}, "computed");
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_THAT(json["errors_along"].dump(), HasSubstr("\"EZX*ram\""));
  std::istringstream lines(folder.read("path.csv"));
  std::string head, first, second;
  std::getline(lines, head) && std::getline(lines, first) && std::getline(lines, second);
  EXPECT_THAT(second, Not(HasSubstr(",400,"))) << "EXX has not been taken off";
}

TEST_F(StateUses, AHistoryIsFollowedAtOneState) {
  std::vector<std::string> add = {"history", "add", "mill.history", "--machine", "mill.machine.toml"};
  for (const int k : {1, 2, 3}) {
    const std::string name = "c" + std::to_string(k) + ".errors.toml";
    folder.write(name, measured_errors(2 + 0.01 * k) + kCoveredHall);
    add.insert(add.begin() + 2 + k, name);
    add.insert(add.end(), {"--date", "2026-0" + std::to_string(k) + "-01"});
  }
  ASSERT_EQ(abbe(add).exit_code, ExitCode::done) << abbe(add).err;
  const CommandResult inside = abbe({"history", "trends", "mill.history", "--state", "hall_degC=22", "--json"});
  ASSERT_EQ(inside.exit_code, ExitCode::done) << inside.err;
  EXPECT_EQ(nlohmann::json::parse(inside.out)["at_state"]["hall_degC"], 22);
  const CommandResult outside = abbe({"history", "trends", "mill.history", "--state", "hall_degC=60", "-o", "out"});
  EXPECT_EQ(outside.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(outside.err, HasSubstr("abbe: c3: hall_degC = 60 lies outside the "));
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("hall_degC = 60"));
}

}  // namespace
}  // namespace abbe
