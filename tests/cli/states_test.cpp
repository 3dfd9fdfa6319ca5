// Errors with a state in commands that use errors: --state; readings with times and channels.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kMill = R"(name = "mill"
chain = "w X' b Y Z t"
[axis.X]
travel_mm = [0, 600]
[axis.Y]
travel_mm = [0, 400]
[axis.Z]
travel_mm = [0, 300]
[tool]
reference_mm = [0, 0, 250]
[state.hall]
kind = "measured"
unit = "degC"
[state.column]
kind = "lag"
of = "hall"
time_constant_min = 40
)";

std::string motion(const char* name, const char* state, const char* values, const char* uncertainties) {
  return std::string("[[motion]]\nname = \"") + name + "\"\n" + state +
         "basis = \"legendre\"\norder = 2\ncoefficients_um = " + values +
         "\nstandard_uncertainty_um = " + uncertainties + "\n";
}

/// The errors, and what they are at 24 degC of the hall and 22 degC of the column, by hand: 4 K and 2 K above 20 degC.
std::string errors_of(bool folded) {
  const char* const plain = "";
  std::string text = motion("EXX", plain, "[0, 12, -6]", "[0.1, 0.5, 0.25]");
  text += motion("EYY", plain, "[0, -8, 3]", "[0.1, 0.5, 0.25]");
  text += folded ? motion("EXX", plain, "[2, 14, 0]", "[0.5, 1, 0.25]")
                 : motion("EXX", "state = \"hall\"\n", "[0.5, 3.5, 0]", "[0.125, 0.25, 0.0625]");
  text += folded ? motion("EZZ", plain, "[1, 3, 0.5]", "[0.5, 0.5, 0.125]")
                 : motion("EZZ", "state = \"column\"\n", "[0.5, 1.5, 0.25]", "[0.25, 0.25, 0.0625]");
  text += folded
              ? "[[location]]\nname = \"EC0Y\"\nvalue_urad = -12\nstandard_uncertainty_urad = 2\n"
              : "[[location]]\nname = \"EC0Y\"\nstate = \"hall\"\nvalue_urad = -3\nstandard_uncertainty_urad = 0.5\n";
  return text;
}

class States : public CommandTest {
 protected:
  void SetUp() override {
    folder.write("mill.machine.toml", kMill);
    folder.write("warm.errors.toml", errors_of(false));
    folder.write("folded.errors.toml", errors_of(true));
    folder.write("part.ngc", "G21 G90 G17\nG0 X10 Y10 Z200\nG1 X500 Y350 Z100 F2000\nG1 X20 Y300\nM2\n");
    folder.write("poses.csv", "X_mm,Y_mm,Z_mm\n10,20,30\n590,390,290\n");
  }

  const std::vector<std::string> at = {"--state", "hall_degC=24", "--state", "column_degC=22"};

  CommandResult run(std::vector<std::string> arguments, const std::string& errors,
                    const std::vector<std::string>& more) const {
    for (const char* const one : {"--machine", "mill.machine.toml", "--errors"}) arguments.emplace_back(one);
    arguments.push_back(errors + ".errors.toml");
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }

  /// Frozen errors without the checksums of the file and of the texts they were made from, which tell their state.
  static std::string without_source(std::string bytes) {
    return bytes.rfind(
               "\x89"
               "ABBEC",
               0) == 0
               ? bytes.erase(24, 16)
               : bytes;
  }

  /// A command with the errors at their state writes what it writes with the errors that were folded by hand, and says
  /// at which state.
  void expect_same(const std::vector<std::string>& arguments, const std::vector<std::string>& options,
                   const std::string& output) const {
    const auto with = [&](const std::vector<std::string>& more) {
      std::vector<std::string> all = options;
      all.insert(all.end(), more.begin(), more.end());
      return all;
    };
    const CommandResult by_hand = run(arguments, "folded", with({"-o", output}));
    ASSERT_EQ(by_hand.exit_code, ExitCode::done) << by_hand.err;
    const std::string expected = output.empty() ? "" : folder.read(output);
    EXPECT_THAT(by_hand.out, Not(HasSubstr("errors taken at")));
    const CommandResult at_state = run(arguments, "warm", with({"-o", output, "--force", at[0], at[1], at[2], at[3]}));
    ASSERT_EQ(at_state.exit_code, ExitCode::done) << at_state.err;
    EXPECT_EQ(without_source(folder.read(output)), without_source(expected));
    EXPECT_THAT(at_state.out, HasSubstr("errors taken at hall_degC = 24, column_degC = 22\n"));
    const CommandResult json =
        run(arguments, "warm", with({"-o", output, "--force", "--json", at[0], at[1], at[2], at[3]}));
    ASSERT_EQ(json.exit_code, ExitCode::done) << json.err;
    EXPECT_EQ(nlohmann::json::parse(json.out)["at_state"], nlohmann::json({{"hall_degC", 24}, {"column_degC", 22}}));
  }
};

TEST_F(States, MapsTablesProgramsPosesAndFrozenErrorsAreThoseOfTheState) {
  expect_same({"map"}, {}, "map.csv");
  expect_same({"compensate", "gcode", "part.ngc"}, {}, "out.ngc");
  expect_same({"compensate", "poses", "poses.csv"}, {}, "out.csv");
  expect_same({"compensate", "freeze"}, {}, "mill.abbec");
  expect_same({"compensate", "table"}, {"--for", "aerotech-2d", "--positions", "4"}, "mill.cal");
}

TEST_F(States, UncertaintiesAreThoseOfTheStateToo) {
  const auto uncertainty = [&](const std::string& errors, const std::vector<std::string>& more) {
    const CommandResult result = run({"map", "--json"}, errors, more);
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return nlohmann::json::parse(result.out)["standard_uncertainty_um"]["mean"].get<double>();
  };
  EXPECT_DOUBLE_EQ(uncertainty("warm", at), uncertainty("folded", {}));
  EXPECT_GT(uncertainty("warm", {"--state", "hall_degC=40", "--state", "column_degC=22"}),
            1.5 * uncertainty("warm", at));
}

TEST_F(States, PosesBeyondWhatTheReadingsCoveredAreSaid) {
  folder.write("warm.errors.toml", errors_of(false) + "[covered]\nhall_degC = [18, 27]\ncolumn_degC = [19, 26]\n");
  const auto poses = [&](const std::string& rows) {
    folder.write("states.csv", "X_mm,Y_mm,Z_mm,hall_degC,column_degC\n" + rows);
    return run({"compensate", "poses", "states.csv"}, "warm", {"--dry-run", "--json"});
  };
  const CommandResult inside = poses("10,20,30,18,26\n300,200,150,27,19\n");
  EXPECT_EQ(inside.exit_code, ExitCode::done) << inside.err;
  EXPECT_FALSE(nlohmann::json::parse(inside.out).contains("states_outside_measured"));
  const CommandResult outside = poses("10,20,30,20,20\n300,200,150,31,20\n300,200,150,29,20\n");
  EXPECT_EQ(outside.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(outside.err, HasSubstr("hall_degC lies outside the 18 to 27 that the readings cover at 2 of 3 poses, "
                                     "furthest in row 2 (31): the errors are extrapolated there"));
  EXPECT_EQ(nlohmann::json::parse(outside.out)["states_outside_measured"].size(), 1U);
}

TEST_F(States, TablesOfOneStateSayWhatTheyLeaveOverADay) {
  const auto over = [&](const std::string& record) {
    folder.write("day.csv", record);
    const CommandResult result = run({"compensate", "table", "--for", "aerotech-2d", "--dry-run", "--json",
                                      "--positions", "4", "--state-over", "day.csv"},
                                     "warm", {"--state", "hall_degC=24", "--state", "column_degC=24"});
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return nlohmann::json::parse(result.out);
  };
  // At the state of the tables it is what they leave anyway; the lag is in equilibrium.
  const nlohmann::json still = over("time_h,hall_degC\n0,24\n");
  ASSERT_EQ(still["over_states"]["states"].size(), 1U);
  EXPECT_EQ(still["over_states"]["maximum_um"], still["volumetric_error_left_by_tables_um"]["max"]);
  EXPECT_EQ(still["over_states"]["at_state"], still["at_state"]);
  const nlohmann::json day = over("time_h,hall_degC\n0,24\n10,24\n18,30\n24,24\n");
  EXPECT_EQ(day["over_states"]["states"].size(), 145U);
  EXPECT_EQ(day["over_states"]["maximum_at_s"], 18 * 3600);
  EXPECT_EQ(day["over_states"]["at_state"]["hall_degC"], 30);
  EXPECT_LT(day["over_states"]["at_state"]["column_degC"], 30);
  EXPECT_GT(day["over_states"]["maximum_um"].get<double>(),
            5 + still["volumetric_error_left_by_tables_um"]["max"].get<double>());
  EXPECT_LT(day["over_states"]["rms_um"].get<double>(), day["over_states"]["maximum_um"].get<double>());
  folder.write("day.csv", "time_h,hall_degC\n0,24\n1,\n2,25\n");
  const CommandResult gap = run({"compensate", "table", "--for", "linuxcnc", "--dry-run", "--state-over", "day.csv"},
                                "warm", {"--state", "hall_degC=24", "--state", "column_degC=24"});
  EXPECT_EQ(gap.exit_code, ExitCode::bad_input);
  EXPECT_THAT(gap.err, HasSubstr("day.csv: time: hall is not known at 50 s, in a gap of day.csv"));
}

TEST_F(States, AVerificationTakesBothFilesAtTheState) {
  const CommandResult warm = run({"verify", "--truth", "warm.errors.toml", "--poses", "50", "--json"}, "warm", at);
  ASSERT_EQ(warm.exit_code, ExitCode::done) << warm.err;
  const nlohmann::json json = nlohmann::json::parse(warm.out);
  EXPECT_EQ(json["at_state"]["column_degC"], 22);
  const CommandResult folded =
      run({"verify", "--truth", "folded.errors.toml", "--poses", "50", "--json"}, "folded", {});
  EXPECT_EQ(json["unseen_poses"], nlohmann::json::parse(folded.out)["unseen_poses"]);
}

TEST_F(States, WithoutTheStateTheWayOutIsSaid) {
  const std::vector<std::vector<std::string>> commands = {{"map"},
                                                          {"compensate", "gcode", "part.ngc", "--dry-run"},
                                                          {"compensate", "poses", "poses.csv", "--dry-run"},
                                                          {"compensate", "freeze", "--dry-run"},
                                                          {"compensate", "table", "--for", "linuxcnc", "--dry-run"},
                                                          {"compensate", "kinematics", "--for", "siemens", "--dry-run"},
                                                          {"verify", "--truth", "warm.errors.toml"}};
  for (const std::vector<std::string>& command : commands) {
    const CommandResult result = run(command, "warm", {"--state", "hall_degC=24"});
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << command.back();
    EXPECT_EQ(result.err,
              "abbe: warm.errors.toml: the errors depend on column, and no value is given; expected --state "
              "column_degC=VALUE for the errors at a state\n");
  }
  const CommandResult misspelt = run({"map"}, "warm", {"--state", "hal_degC=24"});
  EXPECT_EQ(misspelt.exit_code, ExitCode::bad_input);
  EXPECT_THAT(misspelt.err,
              HasSubstr("--state hal_degC=24: the machine has no state 'hal_degC' (did you mean hall_degC?)"));
}

TEST_F(States, ReadingsTakeTheirTemperaturesFromAChannel) {
  folder.write("truth.errors.toml", errors_of(false));
  std::string poses = "time_min,X_mm,Y_mm,Z_mm\n", hall = "time_h,hall_degC\n";
  for (int k = 0; k < 150; ++k) {
    poses += std::to_string(4 * k) + "," + std::to_string(37 * k % 601) + "," + std::to_string(53 * k % 401) + "," +
             std::to_string(71 * k % 301) + "\n";
  }
  for (int k = -3; k <= 10; ++k) hall += std::to_string(k) + "," + std::to_string(20 + (k * k) % 7) + "\n";
  folder.write("poses.csv", poses);
  folder.write("hall.csv", hall);
  const std::string study =
      "machine = \"mill.machine.toml\"\nchannels = [\"hall.csv\"]\n[simulate]\nerrors = \"truth.errors.toml\"\n"
      "[[setup]]\nname = \"tracker\"\ninstrument = \"tracker\"\nmounted_on = \"workpiece\"\nnoise = { xyz_um = 1 }\n"
      "[[setup.station]]\nname = \"S\"\npose = \"find\"\ntrue_pose = { position_mm = [900, -1500, 300] }\n"
      "[[setup.reflector]]\nname = \"R\"\noffset_mm = [0, 0, 0]\n"
      "[[setup.plan]]\nkind = \"poses\"\nfile = \"poses.csv\"\n";
  folder.write("day.study.toml", study);
  const CommandResult simulated = abbe({"simulate", "day.study.toml", "-o", "readings"});
  ASSERT_EQ(simulated.exit_code, ExitCode::done) << simulated.err;
  EXPECT_THAT(folder.read("readings/tracker.csv"), HasSubstr("time_s,hall_degC,column_degC\n"));
  folder.write("hall.csv", "time_h,hall_degC\n0,20\n9,21\n");
  const CommandResult short_record = abbe({"simulate", "day.study.toml", "-o", "again"});
  EXPECT_EQ(short_record.exit_code, ExitCode::bad_input);
  EXPECT_THAT(short_record.err,
              HasSubstr("poses.csv:138: time_min: hall is not known at 32640 s: hall.csv covers 0 s to "
                        "32400 s; expected a channel that covers all readings"));
}

}  // namespace
}  // namespace abbe
