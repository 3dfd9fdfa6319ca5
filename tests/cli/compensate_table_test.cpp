#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
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
    std::vector<std::string> arguments = {"compensate", "table", mill, errors, "--for", format};
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

TEST_F(CompensateTable, EveryFormatReducesTheErrorWhenTheControlIsSimulatedWithTheFileReadBack) {
  struct Expected {
    const char* format;
    double left;  ///< largest share of the mean error that may stay
  };
  // What is left is what the format cannot carry; volumes and models carry all shifts of the point.
  for (const Expected& one : {Expected{"linuxcnc", 0.7}, Expected{"siemens-cec", 0.2}, Expected{"siemens-eec", 0.7},
                              Expected{"beckhoff-isg", 0.01}, Expected{"etalon", 0.01}, Expected{"lattice-csv", 0.01},
                              Expected{"lattice-vtk", 0.01}, Expected{"heidenhain", 0.2}, Expected{"fanuc-pitch", 0.9},
                              Expected{"klipper", 1.0}, Expected{"marlin", 1.0}}) {
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

TEST_F(CompensateTable, PrintersGetAnglesOnly) {
  const nlohmann::json json = json_of(table("marlin", {"-o", "skew.gcode", "--json"}));
  for (const char* name : {"EC0Y", "EB0Z"}) EXPECT_EQ(error_named(json, name)["carried"], "carried") << name;
  for (const char* name : {"EXX", "EYY", "EZX"}) EXPECT_EQ(error_named(json, name)["carried"], "not carried") << name;
  EXPECT_THAT(folder.read("skew.gcode"), testing::StartsWith("M852 I"));
}

TEST_F(CompensateTable, TablesThatWouldMakeTheErrorLargerAreRefused) {
  // Two tables that turn: corrections of X, Y, Z alone hold only near the pose in which the others stand.
  const CommandResult result =
      abbe({"compensate", "table", (source / "examples/machines/yin-engraver-u.machine.toml").string(),
            (source / "examples/laser_engraver/linkage.errors.toml").string(), "--for", "lattice-vtk", "-o", "l.vtk"});
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

TEST_F(CompensateTable, MapHasTheErrorBeforeAfterAndIdeal) {
  ASSERT_EQ(table("siemens-cec", {"--dry-run", "--map", "map.csv", "--positions", "3"}).exit_code, ExitCode::done);
  EXPECT_THAT(folder.read("map.csv"), HasSubstr("before_um"));
  EXPECT_THAT(folder.read("map.csv"), HasSubstr("ideal_um"));
  EXPECT_EQ(table("siemens-cec", {"--dry-run", "--map", "map.vts"}).exit_code, ExitCode::done);
}

TEST_F(CompensateTable, InputsAreNeverWrittenOverAndWrongOptionsAreNamed) {
  std::filesystem::copy(errors, folder.path() / "mine.errors.toml");
  const std::string before = folder.read("mine.errors.toml");
  const CommandResult over =
      abbe({"compensate", "table", mill, "mine.errors.toml", "--for", "siemens-cec", "-o", "mine.errors.toml"});
  EXPECT_EQ(over.exit_code, ExitCode::bad_input);
  EXPECT_THAT(over.err, HasSubstr("this is an input"));
  EXPECT_EQ(folder.read("mine.errors.toml"), before);
  EXPECT_THAT(table("linuxcnc", {"-o", "x.comp"}).err, HasSubstr("3 files are to be written"));
  EXPECT_EQ(table("linuxcnc", {"-o", "x.comp", "--axis", "X"}).exit_code, ExitCode::done);
  EXPECT_THAT(table("heidenhain-9", {"-o", "x"}).err, HasSubstr("unknown format"));
  EXPECT_THAT(table("linuxcnc", {}).err, HasSubstr("--dry-run"));
  EXPECT_THAT(table("linuxcnc", {"-o", "c", "--at", "X_deg=3"}).err, HasSubstr("unit 'deg' for a linear axis"));
  EXPECT_THAT(table("siemens-cec", {"-o", "c.ini", "--name", "X=AX2"}).err, HasSubstr("two axes are called AX2"));
  EXPECT_THAT(table("linuxcnc", {"-o", "c", "--axis", "Q"}).err, HasSubstr("no such axis"));
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
    std::vector<std::string> arguments = {"compensate", "table", mill, "r.errors.toml", "--for", format, "--json"};
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
              HasSubstr("MD32450 $MA_BACKLASH of X1 takes it: 0.012000 mm more"));
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
