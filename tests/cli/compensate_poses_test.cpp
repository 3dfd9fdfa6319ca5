// `abbe compensate poses`: corrected commands are judged by the exact model of the errors, not by the command's own
// word.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

struct PoseRow {
  std::vector<double> commands;  // mm, rad
  std::vector<std::string> rest;
};

std::vector<PoseRow> pose_rows(const std::string& text, const Machine& machine) {
  std::vector<PoseRow> rows;
  std::istringstream stream(text);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    PoseRow row;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      const std::size_t i = row.commands.size();
      if (i < machine.axes.size()) {
        const bool rotary = machine.axes[i].kind == AxisKind::rotary;
        row.commands.push_back(std::stod(field) * (rotary ? std::numbers::pi / 180 : 1));
      } else {
        row.rest.push_back(field);
      }
    }
    rows.push_back(row);
  }
  return rows;
}

class CompensatePoses : public CommandTest {
 protected:
  const std::filesystem::path source = ABBE_SOURCE_DIR;
  const std::string mill = (source / "examples/machines/trunnion-mill.machine.toml").string();
  const std::string errors = (source / "examples/compensate/trunnion.errors.toml").string();
  const Machine machine = read_machine(mill);
  const ErrorSet known = read_errors(errors, machine).errors;

  CommandResult poses(const std::string& file, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"compensate", "poses", file, "--machine", mill, "--errors", errors};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }
  Eigen::Vector3d missed(const std::vector<double>& nominal, const std::vector<double>& commands) const {
    return actual_workpiece_from_tool(machine, known, commands).translation -
           nominal_workpiece_from_tool(machine, nominal).translation;
  }
};

TEST_F(CompensatePoses, BringTheActualToolToItsPlaceAndSaySoRowByRow) {
  // Chain order C A Y X Z; the second pose is where C hardly turns the tool.
  folder.write("poses.csv",
               "C_deg,A_deg,Y_mm,X_mm,Z_mm\n30,-40,20,100,-200\n35,0.001,-30,20,-250\n200,25,0,-150,-80\n");
  const CommandResult result = poses("poses.csv", {"-o", "out.csv", "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  const std::string text = folder.read("out.csv");
  EXPECT_THAT(text, HasSubstr("C_deg,A_deg,Y_mm,X_mm,Z_mm,status,correction_um,u_correction_um,position_left_um,"
                              "orientation_left_urad\n"));
  const std::vector<PoseRow> rows = pose_rows(text, machine), in = pose_rows(folder.read("poses.csv"), machine);
  ASSERT_EQ(rows.size(), 3U);
  double largest = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double before = missed(in[k].commands, in[k].commands).norm();
    EXPECT_GT(before, 1e-3);
    EXPECT_LE(missed(in[k].commands, rows[k].commands).norm(), 1.1e-9);
    EXPECT_NEAR(std::stod(rows[k].rest[1]), 1e3 * before, 1e-6);
    EXPECT_GT(std::stod(rows[k].rest[2]), 0.1);
    EXPECT_EQ(rows[k].rest[0], k == 1 ? "turn limited" : "reached");
    const Eigen::Vector3d wanted = nominal_workpiece_from_tool(machine, in[k].commands).rotation.col(2);
    const Eigen::Vector3d there = actual_workpiece_from_tool(machine, known, rows[k].commands).rotation.col(2);
    EXPECT_NEAR(1e-6 * std::stod(rows[k].rest[4]), std::atan2(wanted.cross(there).norm(), wanted.dot(there)), 1e-12);
    largest = std::max(largest, before);
  }
  EXPECT_NEAR(json["largest_correction_um"].get<double>(), 1e3 * largest, 1e-6);
  EXPECT_EQ(json["status"]["turn limited"], 1);
}

TEST_F(CompensatePoses, ADryRunSaysWhereTheCorrectionsAreLargestAndWritesNothing) {
  const std::string example = (source / "examples/compensate/poses.csv").string();
  const CommandResult result = poses(example, {"--dry-run", "-o", "out.csv"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("largest correction of the functional point "));
  EXPECT_THAT(result.out, HasSubstr(", row "));
  EXPECT_THAT(result.out, HasSubstr("dry run: nothing written"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.csv"));
}

TEST_F(CompensatePoses, WhatIsNotReachedIsInItsRowAndInTheExitCode) {
  folder.write("part.errors.toml",
               "[[motion]]\nname = \"EXX\"\nbasis = \"legendre\"\norder = 0\nfrom_mm = -50\nto_mm = "
               "300\ncoefficients_um = [-30]\n");
  folder.write("poses.csv", "C_deg,A_deg,Y_mm,X_mm,Z_mm\n0,-30,0,0,-100\n0,-30,0,-200,-100\n0,-30,0,300,-100\n");
  const CommandResult result =
      abbe({"compensate", "poses", "poses.csv", "--machine", mill, "--errors", "part.errors.toml", "-o", "out.csv"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.err, HasSubstr("does not reach 2 of 3 poses"));
  EXPECT_THAT(result.out, HasSubstr("not covered: 1, first in row 2"));
  EXPECT_THAT(result.out, HasSubstr("outside travel: 1, first in row 3"));
  const std::vector<PoseRow> rows = pose_rows(folder.read("out.csv"), machine);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].rest[0], "reached");
  EXPECT_EQ(rows[1].rest[0], "not covered");
  EXPECT_EQ(rows[1].commands[3], -200);
  EXPECT_EQ(rows[1].rest[1], "");
  EXPECT_EQ(rows[2].commands[3], 300);
  EXPECT_NEAR(std::stod(rows[2].rest[2]), 30, 1e-6);
}

TEST_F(CompensatePoses, LimitsAndInputsAreKept) {
  folder.write("poses.csv", "C_deg,A_deg,Y_mm,X_mm,Z_mm\n30,-40,20,100,-200\n");
  const CommandResult above = poses("poses.csv", {"-o", "out.csv", "--limit-um", "2"});
  EXPECT_EQ(above.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(above.err, HasSubstr("above --limit-um 2: row 1, C 30 deg"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.csv"));
  for (const std::string limit : {"0", "-1", "nan", "inf"}) {
    const CommandResult none = poses("poses.csv", {"-o", "out.csv", "--limit-um", limit});
    EXPECT_EQ(none.exit_code, ExitCode::bad_input) << limit;
    EXPECT_THAT(none.err, HasSubstr("--limit-um")) << limit;
  }
  const CommandResult over = poses("poses.csv", {"--force", "-o", "./poses.csv"});
  EXPECT_EQ(over.exit_code, ExitCode::bad_input);
  EXPECT_THAT(over.err, HasSubstr("is an input of the command"));
  EXPECT_THAT(folder.read("poses.csv"), HasSubstr("30,-40,20,100,-200"));
  // What only the errors file names is an input too.
  folder.write("t.errors.toml", "[[motion]]\nname = \"EXX\"\nbasis = \"table-linear\"\ntable = \"exx.csv\"\n");
  folder.write("exx.csv", "X_mm,EXX_um\n-300,4\n300,-4\n");
  const CommandResult beside = abbe(
      {"compensate", "poses", "poses.csv", "--machine", mill, "--errors", "t.errors.toml", "--force", "-o", "exx.csv"});
  EXPECT_EQ(beside.exit_code, ExitCode::bad_input);
  EXPECT_THAT(beside.err, HasSubstr("exx.csv: is an input"));
  EXPECT_THAT(folder.read("exx.csv"), HasSubstr("300,-4"));
  EXPECT_THAT(poses("poses.csv", {}).err, HasSubstr("--dry-run"));
  EXPECT_THAT(poses("poses.csv", {"--dry-run", "--hold", "Q"}).err, HasSubstr("no such axis"));
  // Without the rotary axes the point alone is corrected.
  ASSERT_EQ(poses("poses.csv", {"-o", "held.csv", "--hold", "A", "--hold", "C"}).exit_code, ExitCode::done);
  const std::vector<PoseRow> rows = pose_rows(folder.read("held.csv"), machine);
  EXPECT_NEAR(rows[0].commands[0], 30 * std::numbers::pi / 180, 1e-15);
  EXPECT_LE(missed(pose_rows(folder.read("poses.csv"), machine)[0].commands, rows[0].commands).norm(), 1.1e-9);
}

/// X and Y, which carries the workpiece, both shift the tool by 10 um along X: each known to 20 um, their sum to 28 um
/// or, correlated, to 2.8 um.
std::string two_in_one(double correlation) {
  const std::string both = std::to_string(400 * correlation);
  return "parameter,unit,EXX[P0],EXY[P0],tool_X,tool_Y,tool_Z\nEXX[P0],um,400," + both + ",0,0,0\nEXY[P0],um," + both +
         ",400,0,0,0\ntool_X,um,0,0,0,0,0\ntool_Y,um,0,0,0,0,0\ntool_Z,um,0,0,0,0,0\n";
}

TEST_F(CompensatePoses, WhatIsLeftOutIsSmallTogetherAndInWhatIsLeft) {
  folder.write("two.errors.toml",
               "covariance = \"c.csv\"\n[[motion]]\nname = \"EXX\"\nbasis = \"legendre\"\norder = 0\ncoefficients_um = "
               "[10]\n[[motion]]\nname = \"EXY\"\nbasis = \"legendre\"\norder = 0\ncoefficients_um = [-10]\n");
  folder.write("poses.csv", "C_deg,A_deg,Y_mm,X_mm,Z_mm\n30,-40,20,100,-200\n200,25,0,-150,-80\n");
  const auto run = [&](double correlation) {
    folder.write("c.csv", two_in_one(correlation));
    const CommandResult result =
        abbe({"compensate", "poses", "poses.csv", "--machine", mill, "--errors", "two.errors.toml", "--force", "-o",
              "out.csv", "--leave-out-below-uncertainty", "1", "--json"});
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return nlohmann::json::parse(result.out);
  };
  const nlohmann::json apart = run(0);
  EXPECT_EQ(apart["left_out"].size(), 2U);
  EXPECT_EQ(apart["largest_correction_um"], 0);
  // The machine has all of it, and what the command says of it is that.
  const ErrorSet both = read_errors(folder.path() / "two.errors.toml", machine).errors;
  const std::vector<PoseRow> rows = pose_rows(folder.read("out.csv"), machine),
                             in = pose_rows(folder.read("poses.csv"), machine);
  double most = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double left = (actual_workpiece_from_tool(machine, both, rows[k].commands).translation -
                         nominal_workpiece_from_tool(machine, in[k].commands).translation)
                            .norm();
    EXPECT_GT(left, 1e-4);
    EXPECT_NEAR(std::stod(rows[k].rest[3]), 1e3 * left, 1e-9);
    most = std::max(most, 1e3 * left);
  }
  EXPECT_NEAR(apart["largest_position_left_um"].get<double>(), most, 1e-9);
  EXPECT_GE(apart["left_out_largest_um"].get<double>(), most - 1e-3);
  EXPECT_TRUE(apart["left_out_largest_at"].contains("A_deg"));

  const nlohmann::json correlated = run(0.99);
  EXPECT_TRUE(correlated["left_out"].empty());
  EXPECT_EQ(correlated["left_out_kept"].size(), 2U);
  EXPECT_NEAR(correlated["largest_correction_um"].get<double>(), 20, 1e-6);
  EXPECT_LT(correlated["largest_position_left_um"].get<double>(), 1e-6);
}

class CompensateWarmPart : public CommandTest {
 protected:
  const std::string example = ABBE_SOURCE_DIR "/examples/expansion/";

  CommandResult part(const std::vector<std::string>& more, const std::string& poses = {}) const {
    std::vector<std::string> arguments = {"compensate",
                                          "poses",
                                          poses.empty() ? example + "part.csv" : poses,
                                          "--machine",
                                          example + "mill.machine.toml",
                                          "--errors",
                                          example + "truth.errors.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }
};

TEST_F(CompensateWarmPart, TheScaleTheSpindleAndThePartAreCorrected) {
  const CommandResult result =
      part({"--dry-run", "--json", "--workpiece-expansion-um-per-m-K", "23.4", "--workpiece-state", "part",
            "--u-workpiece-expansion-um-per-m-K", "1", "--workpiece-fixed-mm", "0", "0", "120"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["workpiece"]["state"], "part");
  EXPECT_NEAR(json["workpiece"]["coefficient_um_per_m_K"].get<double>(), 23.4, 1e-9);
  EXPECT_EQ(json["workpiece"]["temperatures_degC"], (nlohmann::json{22.4, 22.4}));
  // Y has no errors: 400 mm of the part grow by 23.4 um/(m K) and 2.4 K.
  EXPECT_NEAR(json["axes"][1]["largest_um"].get<double>(), 0.4 * 23.4 * 2.4, 1e-6);
  // Z: 1.9 um/K and 11.5 K of the spindle; the part does not move in its plane.
  EXPECT_NEAR(json["axes"][2]["largest_um"].get<double>(), 1.9 * 11.5, 1e-6);
  EXPECT_LT(json["largest_position_left_um"].get<double>(), 1e-6);
}

TEST_F(CompensateWarmPart, ItsTemperatureMustBeKnown) {
  const std::vector<std::string> part_of_steel = {"--dry-run", "--workpiece-expansion-um-per-m-K", "11.5",
                                                  "--workpiece-state", "part"};
  folder.write("cold.csv", "X_mm,Y_mm,Z_mm,scale_x_degC,spindle_degC\n100,100,120,24,31\n");
  const CommandResult none = part(part_of_steel, "cold.csv");
  EXPECT_EQ(none.exit_code, ExitCode::bad_input);
  EXPECT_THAT(none.err, HasSubstr("part_degC: the temperature of the workpiece is not given at all poses; expected a "
                                  "column with this name, or --state part_degC=VALUE"));
  EXPECT_THAT(part({"--dry-run", "--workpiece-state", "part"}).err,
              HasSubstr("--workpiece-expansion-um-per-m-K: is missing"));
}

TEST_F(CompensateWarmPart, AnExpansionIsTheErrorMotionThatItStandsFor) {
  folder.write("short.errors.toml",
               "[[expansion]]\naxis = \"X\"\nstate = \"scale_x\"\ncoefficient_um_per_m_K = 8\n"
               "coefficient_standard_uncertainty_um_per_m_K = 0.5\nfixed_point_mm = 100\n");
  folder.write("long.errors.toml",
               "[[motion]]\nname = \"EXX\"\nstate = \"scale_x\"\nbasis = \"monomial\"\norder = 1\nfrom_mm = -900\n"
               "to_mm = 1100\ncoefficients_um = [0, -8]\nstandard_uncertainty_um = [0, 0.5]\n");
  folder.write("line.ngc", "G21 G90\nG0 X0 Y0 Z10\nG1 X600 Y200 Z50 F600\nM2\n");
  const std::string warm = "scale_x_degC=27";
  const std::vector<std::vector<std::string>> commands = {
      {"map", "--keep-datum", "--state", warm},
      {"compensate", "table", "--for", "lattice-csv", "--state", warm},
      {"compensate", "gcode", "line.ngc", "--state", warm},
      {"compensate", "freeze"}};
  for (const std::vector<std::string>& command : commands) {
    std::vector<std::string> written;
    for (const std::string name : {"short", "long"}) {
      std::vector<std::string> arguments = command;
      const std::string output = command.back() == "freeze" ? name + ".abbec" : name + ".csv";
      for (const std::string& more : {std::string("--machine"), example + "mill.machine.toml", std::string("--errors"),
                                      name + ".errors.toml", std::string("-o"), output, std::string("--force")}) {
        arguments.push_back(more);
      }
      const CommandResult result = abbe(arguments);
      ASSERT_EQ(result.exit_code, ExitCode::done) << command[0] << " " << command[1] << ": " << result.err;
      written.push_back(folder.read(output));
    }
    EXPECT_FALSE(written[0].empty());
    EXPECT_EQ(written[0], written[1]) << command[0] << " " << command[1];
  }
}

}  // namespace
}  // namespace abbe
