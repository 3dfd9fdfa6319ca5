#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

class CompensateTable : public CommandTest {
 protected:
  const std::filesystem::path source = ABBE_SOURCE_DIR;
  const std::string mill = (source / "examples/machines/three-axis-mill.machine.toml").string();
  const std::string errors = (source / "examples/compensate/mill.errors.toml").string();

  CommandResult table(const std::string& format, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"compensate", "table", "--machine", mill,
                                          "--errors",   errors,  "--for",     format};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }
  nlohmann::json json_of(const CommandResult& result) const {
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return nlohmann::json::parse(result.out);
  }
};

const nlohmann::json& error_named(const nlohmann::json& json, const std::string& name) {
  for (const nlohmann::json& error : json["errors"]) {
    if (error["name"] == name) return error;
  }
  ADD_FAILURE() << name;
  return json;
}

TEST_F(CompensateTable, LinuxCncGetsOneFilePerJointAndTheReportSaysWhatItCannotCarry) {
  const nlohmann::json json = json_of(table("linuxcnc", {"-o", "comp", "--json"}));
  ASSERT_EQ(json["files"].size(), 3U);
  for (const char* axis : {"X", "Y", "Z"}) {
    std::istringstream text(folder.read(std::string("comp/") + axis + ".comp"));
    double nominal = 0, forward = 0, reverse = 0, last = -1e9;
    int points = 0;
    while (text >> nominal >> forward >> reverse) {
      EXPECT_GT(nominal, last);
      EXPECT_EQ(forward, reverse);
      EXPECT_LT(std::abs(forward), 0.05);
      last = nominal;
      ++points;
    }
    EXPECT_TRUE(text.eof()) << "something beside numbers";
    EXPECT_GE(points, 2);
    EXPECT_LE(points, 256);
  }
  for (const char* name : {"EXX", "EYY", "EZZ"}) EXPECT_EQ(error_named(json, name)["carried"], "carried") << name;
  for (const char* name : {"EYX", "EZX", "EC0Y"}) EXPECT_EQ(error_named(json, name)["carried"], "not carried") << name;
  EXPECT_EQ(error_named(json, "EBX")["carried"], "in part");
  EXPECT_LT(json["after"]["mean_um"].get<double>(), 0.7 * json["before"]["mean_um"].get<double>());
  EXPECT_LT(json["ideal"]["max_um"].get<double>(), 1e-6);
  EXPECT_GT(json["tables"][0]["standard_uncertainty_um"].get<double>(), 0.5);
  // Type 0 says the same in other columns.
  const nlohmann::json other = json_of(table("linuxcnc", {"-o", "comp0", "--type", "0", "--json"}));
  EXPECT_NEAR(other["after"]["mean_um"].get<double>(), json["after"]["mean_um"].get<double>(), 1e-3);
  EXPECT_NE(folder.read("comp0/X.comp"), folder.read("comp/X.comp"));
}

TEST_F(CompensateTable, SagTablesCarryStraightnessAndSquarenessAndEncoderTablesDoNot) {
  const nlohmann::json sag = json_of(table("siemens-cec", {"-o", "CEC.INI", "--json"}));
  const nlohmann::json encoder = json_of(table("siemens-eec", {"-o", "EEC.INI", "--json"}));
  for (const char* name : {"EXX", "EYX", "EZX", "EXY", "EC0Y", "EB0Z"}) {
    EXPECT_EQ(error_named(sag, name)["carried"], "carried") << name;
  }
  EXPECT_EQ(error_named(encoder, "EYX")["carried"], "not carried");
  EXPECT_LT(sag["after"]["mean_um"].get<double>(), 0.2 * sag["before"]["mean_um"].get<double>());
  EXPECT_LT(encoder["after"]["mean_um"].get<double>(), 0.7 * encoder["before"]["mean_um"].get<double>());
  EXPECT_THAT(sag["unverified"].get<std::string>(), HasSubstr("sign"));
  EXPECT_THAT(folder.read("CEC.INI"), testing::StartsWith("%_N_NC_CEC_INI\nCHANDATA(1)\n$AN_CEC[0,0]="));
  EXPECT_THAT(folder.read("EEC.INI"), HasSubstr("$AA_ENC_COMP_STEP[0,X1]=23.75\n"));
}

TEST_F(CompensateTable, TablesThatCorrectNextToNothingAreRefusedWithTheWayThatWorks) {
  folder.write("square.errors.toml",
               "[[location]]\nname = \"EC0Y\"\nvalue_urad = 80\n[[location]]\nname = \"EB0Z\"\nvalue_urad = -60\n");
  const auto of = [&](const std::string& format, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"compensate",         "table", "--machine", mill, "--errors",
                                          "square.errors.toml", "--for", format,      "-o", "out-" + format};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  };
  for (const char* format : {"linuxcnc", "siemens-eec", "fanuc-pitch"}) {
    const CommandResult refused = of(format);
    EXPECT_EQ(refused.exit_code, ExitCode::computation_says_no) << format;
    EXPECT_THAT(refused.err, HasSubstr("EC0Y")) << format;
    EXPECT_THAT(refused.err, HasSubstr("tables that do: siemens-cec, beckhoff-isg")) << format;
    EXPECT_THAT(refused.err, HasSubstr("`abbe compensate gcode`")) << format;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / (std::string("out-") + format))) << format;
  }
  for (const char* format : {"siemens-cec", "marlin", "lattice-csv"}) {
    EXPECT_EQ(of(format).exit_code, ExitCode::done) << format;
  }
  EXPECT_EQ(of("linuxcnc", {"--least-reduction-percent", "0"}).exit_code, ExitCode::done);
  // A scale that is corrected well is of use, however much larger the squareness is.
  folder.write("scale.errors.toml",
               "[[motion]]\nname = \"EXX\"\nbasis = \"legendre\"\norder = 1\ncoefficients_um = [0, 3]\n"
               "[[location]]\nname = \"EC0Y\"\nvalue_urad = 300\n");
  EXPECT_EQ(abbe({"compensate", "table", "--machine", mill, "--errors", "scale.errors.toml", "--for", "linuxcnc", "-o",
                  "scale"})
                .exit_code,
            ExitCode::done);
}

TEST_F(CompensateTable, EveryFormatReducesTheErrorWhenTheControlIsSimulatedWithTheFileReadBack) {
  struct Expected {
    const char* format;
    double left;  ///< largest share of the mean error that may stay
  };
  // What is left is what the format cannot carry; volumes and models carry all shifts of the point.
  for (const Expected& one :
       {Expected{"linuxcnc", 0.7}, Expected{"siemens-cec", 0.2}, Expected{"siemens-eec", 0.7},
        Expected{"beckhoff-isg", 0.01}, Expected{"etalon", 0.01}, Expected{"lattice-csv", 0.01},
        Expected{"lattice-vtk", 0.01}, Expected{"heidenhain", 0.2}, Expected{"heidenhain-kinematics-comp", 0.01},
        Expected{"fanuc-pitch", 0.9}, Expected{"fanuc-3d", 0.05}, Expected{"klipper", 1.0}, Expected{"marlin", 1.0},
        Expected{"aerotech-1d", 0.2}, Expected{"aerotech-2d", 0.01}}) {
    const std::string folder_name = std::string("out-") + one.format;
    const nlohmann::json json = json_of(table(one.format, {"-o", folder_name, "--json"}));
    EXPECT_LT(json["after"]["mean_um"].get<double>(), one.left * json["before"]["mean_um"].get<double>()) << one.format;
    EXPECT_GT(json["after"]["max_um"].get<double>(), 0) << one.format << ": the grid should not lie on the nodes";
    ASSERT_FALSE(json["files"].empty()) << one.format;
    for (const nlohmann::json& file : json["files"]) {
      EXPECT_GT(std::filesystem::file_size(folder.path() / file.get<std::string>()), 0U);
    }
  }
}

/// "N10803P21" as 10803 and 21, or of "N03620A1P65A2P80" the number behind the words "A1P".
std::map<int, double> fanuc_parameters(const std::string& text, const std::string& words = "P") {
  std::map<int, double> parameters;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    int number = 0, used = 0;
    if (std::sscanf(line.c_str(), "N%d%n", &number, &used) != 1) continue;
    const auto begin = static_cast<std::size_t>(used);
    if (line.compare(begin, words.size(), words) == 0)
      parameters[number] = std::stod(line.substr(begin + words.size()));
  }
  return parameters;
}

/// Values of the points, three per block.
std::vector<std::array<int, 3>> grid_points(const std::string& text) {
  std::vector<std::array<int, 3>> points;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    int number = 0;
    std::array<int, 3> values{};
    if (std::sscanf(line.c_str(), "N%dA1P%dA2P%dA3P%d", &number, values.data(), &values[1], &values[2]) != 4) continue;
    points.push_back(values);
    EXPECT_EQ(number, static_cast<int>(points.size()));
  }
  return points;
}

TEST_F(CompensateTable, FanucsGridCarriesEveryShiftOfThePointWithinTheLimitAndSaysWhatIsNotVerified) {
  const nlohmann::json json = json_of(table("fanuc-3d", {"-o", "grid", "--json"}));
  for (const nlohmann::json& error : json["errors"]) {
    EXPECT_EQ(error["carried"], "carried") << error["name"];
  }
  ASSERT_EQ(json["tables"].size(), 3U);
  for (const nlohmann::json& one : json["tables"]) {
    EXPECT_LE(one["interpolation_um"].get<double>(), 1);
    EXPECT_GE(one["interpolation_um"].get<double>(), 0.4) << "rounding to whole units of 1 um is a part of it";
  }
  // Interpolation with rounded data 1 um and whole units added 0.5 um, in three axes.
  EXPECT_LT(json["after"]["max_um"].get<double>(), 1.5 * std::sqrt(3.0));
  for (const char* word : {"punch", "record form", "order of the points", "sign", "10800"}) {
    EXPECT_THAT(json["unverified"].get<std::string>(), HasSubstr(word));
  }
  const std::map<int, double> grid = fanuc_parameters(folder.read("grid/3D-GRID.PRM"));
  ASSERT_EQ(grid.size(), 15U);
  double points = 1;
  const double travel[3] = {760, 440, 460};
  for (int a = 0; a < 3; ++a) {
    EXPECT_EQ(grid.at(10800 + a), a + 1);
    EXPECT_LE(grid.at(10803 + a), 25);
    // Zero is the lower end of the travel of X and Y and the upper one of Z.
    EXPECT_EQ(grid.at(10806 + a), a < 2 ? 1 : grid.at(10803 + a));
    EXPECT_GE((grid.at(10803 + a) - 1) * grid.at(10812 + a), travel[a]);
    EXPECT_LT((grid.at(10803 + a) - 2) * grid.at(10812 + a), travel[a]);
    points *= grid.at(10803 + a);
  }
  EXPECT_EQ(static_cast<double>(grid_points(folder.read("grid/3D-POINTS.PRM")).size()), points);
}

TEST_F(CompensateTable, FanucsGridIsTiedToTheReferencePositionAndCanBeNegated) {
  ASSERT_EQ(table("fanuc-3d", {"-o", "plain"}).exit_code, ExitCode::done);
  ASSERT_EQ(table("fanuc-3d", {"-o", "turned", "--negate"}).exit_code, ExitCode::done);
  const auto plain = grid_points(folder.read("plain/3D-POINTS.PRM"));
  const auto turned = grid_points(folder.read("turned/3D-POINTS.PRM"));
  ASSERT_EQ(plain.size(), turned.size());
  ASSERT_FALSE(plain.empty());
  for (std::size_t k = 0; k < plain.size(); ++k) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(plain[k][a], -turned[k][a]);
  }
  const nlohmann::json tied = json_of(table("fanuc-3d", {"-o", "tied", "--json", "--reference-position", "X_mm=200"}));
  EXPECT_THAT(tied["settings"].dump(), HasSubstr("at 200 mm"));
  const std::map<int, double> grid = fanuc_parameters(folder.read("tied/3D-GRID.PRM"));
  EXPECT_GT(grid.at(10806), 1);
  EXPECT_GE((grid.at(10806) - 1) * grid.at(10812), 200);
  EXPECT_GE((grid.at(10803) - grid.at(10806)) * grid.at(10812), 560);
  EXPECT_LT(tied["after"]["max_um"].get<double>(), 1.5 * std::sqrt(3.0));
  EXPECT_THAT(table("fanuc-3d", {"-o", "x", "--reference-position", "X_mm=900"}).err,
              HasSubstr("--reference-position X_mm=900"));
}

TEST_F(CompensateTable, FanucsPitchPointsAreTiedToTheReferencePosition) {
  const nlohmann::json tied =
      json_of(table("fanuc-pitch", {"-o", "tied", "--json", "--reference-position", "X_mm=200"}));
  EXPECT_THAT(tied["settings"].dump(), HasSubstr("machine coordinate 200 mm"));
  const std::string text = folder.read("tied/PITCH.PRM");
  EXPECT_THAT(text, testing::Not(HasSubstr("N01240")));
  const std::map<int, double> first_axis = fanuc_parameters(text, "A1P");
  EXPECT_GE((first_axis.at(3620) - first_axis.at(3621)) * first_axis.at(3624), 200);
  EXPECT_GE((first_axis.at(3622) - first_axis.at(3620)) * first_axis.at(3624), 560);
  const nlohmann::json zero = json_of(table("fanuc-pitch", {"-o", "zero", "--json"}));
  EXPECT_NEAR(tied["after"]["mean_um"].get<double>(), zero["after"]["mean_um"].get<double>(), 1);
}

TEST_F(CompensateTable, WhatFanucsGridCannotHoldIsSaidAndNothingIsWritten) {
  const auto refused = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"-o", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = table("fanuc-3d", arguments);
    EXPECT_EQ(result.exit_code, ExitCode::computation_says_no) << result.out;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "none"));
    return result.err;
  };
  EXPECT_THAT(refused({"--detection-unit-um", "2"}), HasSubstr("rounded by up to 1 um"));
  // 127 units of 0.1 um need a magnification, and its rounding is what the limit leaves room for.
  EXPECT_THAT(refused({"--detection-unit-um", "0.1", "--interpolation-um", "0.1"}), HasSubstr("magnification"));
  EXPECT_EQ(table("fanuc-3d", {"-o", "fine", "--detection-unit-um", "0.1"}).exit_code, ExitCode::done);
  EXPECT_GT(fanuc_parameters(folder.read("fine/3D-GRID.PRM")).at(10809), 1);
  EXPECT_THAT(refused({"--detection-unit-um", "0.001"}), HasSubstr("magnification of at most 100"));
  EXPECT_THAT(refused({"--max-points", "40"}), HasSubstr("between the nodes that fanuc-3d has room for"));
  EXPECT_THAT(refused({"--max-points", "7"}), HasSubstr("--max-points"));
  EXPECT_THAT(refused({"--limit-um", "20"}), HasSubstr("above --limit-um 20"));
  const CommandResult two = table("fanuc-3d", {"-o", "none", "--axis", "X", "--axis", "Y"});
  EXPECT_EQ(two.exit_code, ExitCode::bad_input);
  EXPECT_THAT(two.err, HasSubstr("three linear axes"));
  const CommandResult one_file = table("fanuc-3d", {"-o", "grid.prm"});
  EXPECT_EQ(one_file.exit_code, ExitCode::bad_input);
  EXPECT_THAT(one_file.err, testing::AllOf(HasSubstr("2 files"), Not(HasSubstr("--axis"))));
}

TEST_F(CompensateTable, PrintersGetAnglesOnly) {
  const nlohmann::json json = json_of(table("marlin", {"-o", "skew.gcode", "--json"}));
  for (const char* name : {"EC0Y", "EB0Z"}) EXPECT_EQ(error_named(json, name)["carried"], "carried") << name;
  for (const char* name : {"EXX", "EYY", "EZX"}) EXPECT_EQ(error_named(json, name)["carried"], "not carried") << name;
  EXPECT_THAT(folder.read("skew.gcode"), testing::StartsWith("M852 I"));
}

TEST_F(CompensateTable, TablesThatWouldMakeTheErrorLargerAreRefused) {
  // Two tables that turn: corrections of X, Y, Z alone hold only near the pose in which the others stand.
  const CommandResult result =
      abbe({"compensate", "table", "--machine", (source / "examples/machines/yin-engraver-u.machine.toml").string(),
            "--errors", (source / "examples/laser_engraver/linkage.errors.toml").string(), "--for", "lattice-vtk", "-o",
            "l.vtk"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.err, HasSubstr("would grow"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "l.vtk"));
}

TEST_F(CompensateTable, ALatticeThatHasNoRoomSaysWhatItReachesAndIsNotWritten) {
  const CommandResult result = table("lattice-csv", {"-o", "l.csv", "--max-points", "200"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("ABOVE the limit"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "l.csv"));
}

TEST_F(CompensateTable, CorrectionsAboveALimitAreRefusedAndNothingIsWritten) {
  const CommandResult result = table("linuxcnc", {"-o", "comp", "--limit-um", "20", "--map", "map.csv"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.err, HasSubstr("above --limit-um 20: table X"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "comp"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "map.csv"));
  EXPECT_EQ(table("linuxcnc", {"-o", "comp", "--limit-um", "100"}).exit_code, ExitCode::done);
}

TEST_F(CompensateTable, TooFewPointsForTheInterpolationAreSaidAndNothingIsWritten) {
  const CommandResult result = table("linuxcnc", {"-o", "comp", "--max-points", "5"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("ABOVE the limit"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "comp"));
}

TEST_F(CompensateTable, TablesBelowTheirUncertaintyAreLeftOutAndNamed) {
  const nlohmann::json json =
      json_of(table("siemens-cec", {"-o", "CEC.INI", "--json", "--leave-out-below-uncertainty", "5"}));
  ASSERT_FALSE(json["left_out"].empty());
  EXPECT_THAT(json["left_out"].dump(), HasSubstr("Z for Y"));
  EXPECT_THAT(folder.read("CEC.INI"), Not(HasSubstr("$AN_CEC_INPUT_AXIS[8]")));
}

TEST_F(CompensateTable, TablesThatAreWellKnownTogetherStay) {
  // Both move X alike over their travels: each is known to 20 um at an end, their sum to 2.8 um or 28 um.
  folder.write("two.errors.toml",
               "covariance = \"c.csv\"\n[[motion]]\nname = \"EXX\"\nbasis = \"legendre\"\norder = 0\ncoefficients_um = "
               "[10]\n[[motion]]\nname = \"EXY\"\nbasis = \"legendre\"\norder = 0\ncoefficients_um = [10]\n");
  const auto run = [&](double correlation) {
    const std::string both = std::to_string(400 * correlation);
    folder.write("c.csv", "parameter,unit,EXX[P0],EXY[P0],tool_X,tool_Y,tool_Z\nEXX[P0],um,400," + both +
                              ",0,0,0\nEXY[P0],um," + both +
                              ",400,0,0,0\ntool_X,um,0,0,0,0,0\ntool_Y,um,0,0,0,0,0\ntool_Z,um,0,0,0,0,0\n");
    return json_of(abbe({"compensate", "table", "--machine", mill, "--errors", "two.errors.toml", "--for",
                         "beckhoff-isg", "--dry-run", "--json", "--leave-out-below-uncertainty", "1"}));
  };
  const nlohmann::json apart = run(0), correlated = run(-0.99);
  EXPECT_EQ(apart["left_out"].size(), 2U);
  EXPECT_TRUE(apart["left_out_kept"].empty());
  EXPECT_NEAR(apart["after"]["max_um"].get<double>(), 20, 1e-3);
  EXPECT_TRUE(correlated["left_out"].empty());
  EXPECT_EQ(correlated["left_out_kept"].size(), 2U);
  EXPECT_LT(correlated["after"]["max_um"].get<double>(), 0.1);
}

TEST_F(CompensateTable, MapHasTheErrorBeforeAfterAndIdeal) {
  ASSERT_EQ(table("siemens-cec", {"--dry-run", "--map", "map.csv", "--positions", "3"}).exit_code, ExitCode::done);
  EXPECT_THAT(folder.read("map.csv"), HasSubstr("before_um"));
  EXPECT_THAT(folder.read("map.csv"), HasSubstr("ideal_um"));
  EXPECT_EQ(table("siemens-cec", {"--dry-run", "--map", "map.vts"}).exit_code, ExitCode::done);
}

TEST_F(CompensateTable, InputsAreNeverWrittenOverAndWrongOptionsAreNamed) {
  std::filesystem::copy(errors, folder.path() / "mine.errors.toml");
  const std::string before = folder.read("mine.errors.toml");
  const CommandResult over = abbe({"compensate", "table", "--machine", mill, "--errors", "mine.errors.toml", "--for",
                                   "siemens-cec", "--force", "-o", "mine.errors.toml"});
  EXPECT_EQ(over.exit_code, ExitCode::bad_input);
  EXPECT_THAT(over.err, HasSubstr("is an input of the command"));
  EXPECT_EQ(folder.read("mine.errors.toml"), before);
  EXPECT_THAT(table("siemens-eec", {"-o", "both.csv", "--map", "./both.csv"}).err,
              HasSubstr("is the name of two outputs"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "both.csv"));
  // A map of the wrong kind is found before anything is written.
  EXPECT_EQ(table("siemens-eec", {"-o", "eec.ini", "--map", "map.vtu"}).exit_code, ExitCode::bad_input);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "eec.ini"));
  for (const std::string limit : {"0", "-1", "nan", "inf"}) {
    EXPECT_EQ(table("siemens-eec", {"--dry-run", "--limit-um", limit}).exit_code, ExitCode::bad_input) << limit;
    EXPECT_EQ(table("siemens-eec", {"--dry-run", "--limit-urad", limit}).exit_code, ExitCode::bad_input) << limit;
  }
  EXPECT_THAT(table("linuxcnc", {"-o", "x.comp"}).err, HasSubstr("3 files are to be written"));
  EXPECT_EQ(table("linuxcnc", {"-o", "x.comp", "--axis", "X"}).exit_code, ExitCode::done);
  EXPECT_THAT(table("heidenhain-9", {"-o", "x"}).err, HasSubstr("unknown format"));
  EXPECT_THAT(table("linuxcnc", {}).err, HasSubstr("--dry-run"));
  EXPECT_THAT(table("linuxcnc", {"--dry-run"}).out, HasSubstr("dry run: no table is written"));
  EXPECT_THAT(table("linuxcnc", {"-o", "c", "--at", "X_deg=3"}).err, HasSubstr("unit 'deg' for a linear axis"));
  EXPECT_THAT(table("siemens-cec", {"-o", "c.ini", "--name", "X=AX2"}).err, HasSubstr("two axes are called AX2"));
  EXPECT_THAT(table("linuxcnc", {"-o", "c", "--axis", "Q"}).err, HasSubstr("no such axis"));
}

TEST_F(CompensateTable, OptionsThatWouldChangeNothingAreRefused) {
  const auto refused = [&](const std::string& format, const std::vector<std::string>& more) {
    const CommandResult result = table(format, more);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << format << ' ' << more[0];
    EXPECT_THAT(result.err, HasSubstr(more[0])) << format;
    return result.err;
  };
  EXPECT_THAT(refused("linuxcnc", {"--negate", "-o", "c"}), HasSubstr("would change nothing in tables for linuxcnc"));
  EXPECT_THAT(refused("linuxcnc", {"--detection-unit-um", "2", "-o", "c"}), HasSubstr("--for fanuc-pitch, fanuc-3d"));
  refused("siemens-cec", {"--type", "0", "-o", "c"});
  refused("linuxcnc", {"--encoder", "1", "-o", "c"});
  refused("siemens-eec", {"--first-table", "3", "-o", "c"});
  refused("klipper", {"--axis", "X", "-o", "c"});
  refused("marlin", {"--interpolation-um", "1", "-o", "c"});
  refused("etalon", {"--at", "X_mm=1", "-o", "c"});
  refused("lattice-csv", {"--max-points", "0", "-o", "c"});
  refused("linuxcnc", {"--positions", "0", "-o", "c"});
  EXPECT_THAT(refused("linuxcnc", {"--name", "X=X1", "-o", "c"}), HasSubstr("'X1' is not a number"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "c"));
}

TEST_F(CompensateTable, ATableOfAnAxisGetsNodesWhereItsKinksAre) {
  const auto mill5 = (source / "examples/machines/trunnion-mill.machine.toml").string();
  const auto errors5 = (source / "examples/compensate/trunnion.errors.toml").string();
  const nlohmann::json json = json_of(abbe(
      {"compensate", "table", "--machine", mill5, "--errors", errors5, "--for", "linuxcnc", "-o", "comp", "--json"}));
  ASSERT_EQ(json["files"].size(), 5U);
  // EAA is a table every 15 degrees.
  EXPECT_EQ(json["tables"][1]["name"], "A");
  EXPECT_EQ(json["tables"][1]["nodes"], 11);
  EXPECT_NEAR(json["tables"][1]["step_deg"].get<double>(), 15, 1e-9);
  EXPECT_LT(error_named(json, "EAA")["rms_after_um"], 0.01);
}

TEST_F(CompensateTable, TheUnitThatTheControlHasToBeSetToIsSaid) {
  EXPECT_THAT(json_of(table("linuxcnc", {"--dry-run", "--json"}))["settings"].dump(), HasSubstr("LINEAR_UNITS = mm"));
  EXPECT_THAT(json_of(table("siemens-cec", {"--dry-run", "--json"}))["settings"].dump(), HasSubstr("MD32711"));
  EXPECT_THAT(json_of(table("siemens-eec", {"--dry-run", "--json"}))["settings"].dump(), HasSubstr("MD10240"));
}

TEST_F(CompensateTable, AFolderOfResultsWithAnInputInItIsNotReplaced) {
  const std::filesystem::path results = folder.path() / "results";
  std::filesystem::create_directory(results);
  std::filesystem::copy(errors, results / "errors.toml");
  std::ofstream(results / ".abbe-results")
      << "Results of abbe: the next ones written here replace the files below and leave "
         "others alone.\nerrors.toml\n";
  const CommandResult over = abbe({"compensate", "table", "--machine", mill, "--errors", "results/errors.toml", "--for",
                                   "linuxcnc", "-o", "results"});
  EXPECT_EQ(over.exit_code, ExitCode::bad_input);
  EXPECT_THAT(over.err, HasSubstr("results/errors.toml lies in it"));
  EXPECT_TRUE(std::filesystem::exists(results / "errors.toml"));
  const CommandResult beside = abbe({"compensate", "table", "--machine", mill, "--errors", "results/errors.toml",
                                     "--for", "linuxcnc", "-o", "results/comp"});
  EXPECT_EQ(beside.exit_code, ExitCode::done) << beside.err;
}

TEST_F(CompensateTable, ReversalValuesAreInTablesOfBothDirectionsOrNamedWithWhatTakesThem) {
  std::ifstream file(errors);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::ofstream(folder.path() / "r.errors.toml") << text << R"(
[[reversal]]
axis = "X"
value_um = -12
standard_uncertainty_um = 0.5
[[reversal]]
axis = "Z"
value_um = -1
standard_uncertainty_um = 0.8
)";
  const auto with_play = [&](const std::string& format, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"compensate",    "table", "--machine", mill,    "--errors",
                                          "r.errors.toml", "--for", format,      "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.err, "");
    return json_of(result);
  };
  for (const std::string type : {"0", "1"}) {
    const nlohmann::json json = with_play("linuxcnc", {"-o", "comp" + type, "--type", type});
    EXPECT_EQ(error_named(json, "reversal_X")["carried"], "carried");
    EXPECT_THAT(error_named(json, "reversal_X")["control"].get<std::string>(), HasSubstr("0.012000 mm more"));
    EXPECT_NEAR(error_named(json, "reversal_X")["rms_before_um"].get<double>(), 6, 1e-6);
    EXPECT_NEAR(error_named(json, "reversal_X")["rms_after_um"].get<double>(), 0, 2e-3);
    std::istringstream rows(folder.read("comp" + type + "/X.comp"));
    double nominal = 0, forward = 0, reverse = 0;
    int points = 0;
    for (; rows >> nominal >> forward >> reverse; ++points) {
      // Lost motion: forward the command is further by half of it. Type 0 has actual positions.
      EXPECT_NEAR(forward - reverse, type == "1" ? 0.012 : -0.012, 2e-7);
    }
    EXPECT_GE(points, 2);
  }
  const nlohmann::json sag = with_play("siemens-cec", {"-o", "CEC.INI"});
  EXPECT_EQ(error_named(sag, "reversal_X")["carried"], "carried");
  const std::string cec = folder.read("CEC.INI");
  EXPECT_THAT(cec, HasSubstr("$AN_CEC_DIRECTION[0]=1"));
  EXPECT_THAT(cec, HasSubstr("$AN_CEC_DIRECTION[1]=-1"));
  const nlohmann::json encoder = with_play("siemens-eec", {"-o", "EEC.INI"});
  EXPECT_EQ(error_named(encoder, "reversal_X")["carried"], "not carried");
  EXPECT_THAT(error_named(encoder, "reversal_X")["control"].get<std::string>(),
              HasSubstr("MD32450 $MA_BACKLASH of X1 compensates it: 0.012000 mm more"));
  EXPECT_GT(encoder["after"]["mean_um"].get<double>(), sag["after"]["mean_um"].get<double>() + 3);
  // One table for both directions is the mean.
  const CommandResult without = table("siemens-eec", {"-o", "MEAN.INI"});
  EXPECT_EQ(without.exit_code, ExitCode::done);
  EXPECT_EQ(folder.read("EEC.INI"), folder.read("MEAN.INI"));
  const nlohmann::json left = with_play("linuxcnc", {"-o", "left", "--leave-out-below-uncertainty", "2"});
  EXPECT_THAT(left["left_out"].dump(), HasSubstr("reversal_Z: 1.2 times"));
  EXPECT_THAT(left["left_out"].dump(), Not(HasSubstr("reversal_X")));
  // The machine has what is left out, and tables without it leave it.
  const nlohmann::json all = with_play("linuxcnc", {"-o", "all"});
  EXPECT_EQ(left["before"], all["before"]);
  EXPECT_GT(left["after"]["mean_um"], all["after"]["mean_um"]);
  EXPECT_EQ(left["ideal"], all["ideal"]);
  EXPECT_EQ(error_named(left, "reversal_Z")["carried"], "not carried");
  EXPECT_NEAR(error_named(left, "reversal_Z")["rms_after_um"].get<double>(), 0.5, 1e-6);
  EXPECT_FALSE(error_named(left, "reversal_Z").contains("control"));
}

}  // namespace
}  // namespace abbe
