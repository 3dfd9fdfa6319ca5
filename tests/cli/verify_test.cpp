#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class VerifyCommand : public CommandTest {
 protected:
  static std::string example(const std::string& name) {
    return (std::filesystem::path(ABBE_SOURCE_DIR) / "examples" / name).string();
  }
  const std::vector<std::string> files = {"verify",
                                          "--machine",
                                          example("machines/trunnion-mill.machine.toml"),
                                          "--errors",
                                          example("compensate/trunnion.errors.toml"),
                                          "--truth",
                                          example("verify/truth.errors.toml")};

  CommandResult verify(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = files;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }
  std::vector<std::string> cone(const std::string& before, const std::string& after) const {
    return {"--poses", "50", "cone-frustum", "--before", before, "--after", after};
  }
  /// The cone's trace with one line changed or the file cut off behind it.
  std::string changed(std::size_t line, const std::string& text, bool cut_off = false) const {
    std::ifstream file(example("verify/cone-before.csv"));
    std::string all, one;
    for (std::size_t n = 1; std::getline(file, one); ++n) {
      all += (n == line && !text.empty() ? text : one) + "\n";
      if (n == line && cut_off) break;
    }
    return folder.write("trace.csv", all).string();
  }
};

TEST_F(VerifyCommand, BothTestPiecesAndUnseenPosesGetBetter) {
  const CommandResult result =
      verify({"--json", "--largest-ratio", "1.5", "--least-reduction", "15", "cone-frustum", "--before",
              example("verify/cone-before.csv"), "--after", example("verify/cone-after.csv"), "s-shape", "--before",
              example("verify/s-before.csv"), "--after", example("verify/s-after.csv")});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  const nlohmann::json& unseen = json["unseen_poses"];
  EXPECT_EQ(unseen["poses"].get<int>() + unseen["outside_travel"].get<int>() + unseen["outside_range"].get<int>(),
            1000);
  EXPECT_GT(unseen["reduction"].get<double>(), 15);
  EXPECT_LT(unseen["uncertainty_ratio"].get<double>(), 1.5);
  EXPECT_GT(unseen["coverage_percent"].get<double>(), 80);
  EXPECT_NEAR(unseen["remaining_percent"].get<double>() * unseen["reduction"].get<double>(), 100, 1e-6);
  EXPECT_NEAR(unseen["uncertainty_ratio"].get<double>(),
              2 * unseen["position_after_um"]["rms"].get<double>() /
                  unseen["predicted_expanded_uncertainty_um"]["rms"].get<double>(),
              1e-6);
  EXPECT_GT(unseen["orientation_before_urad"]["mean"].get<double>(),
            unseen["orientation_after_urad"]["mean"].get<double>());
  ASSERT_EQ(json["wanted"].size(), 2u);
  for (const nlohmann::json& wanted : json["wanted"]) EXPECT_TRUE(wanted["met"].get<bool>());
  ASSERT_EQ(json["test_pieces"].size(), 2u);
  for (const nlohmann::json& piece : json["test_pieces"]) {
    for (const char* const edge : {"foot", "head"}) {
      EXPECT_LT(2 * piece["after"]["best_fit"][edge]["range_um"].get<double>(),
                piece["before"]["best_fit"][edge]["range_um"].get<double>());
    }
  }
  EXPECT_LT(2 * json["test_pieces"][0]["after"]["foot_circle"]["roundness_um"].get<double>(),
            json["test_pieces"][0]["before"]["foot_circle"]["roundness_um"].get<double>());
}

TEST_F(VerifyCommand, WhatIsWantedAndNotReachedIsExitCodeOne) {
  const CommandResult result = verify({"--poses", "100", "--least-reduction", "1000"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("LESS than the required 1000 times"));
  EXPECT_EQ(verify({"--poses", "100", "--largest-ratio", "0.01"}).exit_code, ExitCode::computation_says_no);
}

TEST_F(VerifyCommand, PosesThatAreLeftOutAreExitCodeOne) {
  // At the end of the travel half of the corrected commands leave it.
  std::vector<std::string> asked = {"--poses", "60", "--range", "X_mm=-300:-299.999"};
  const CommandResult result = verify(asked);
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  const std::string words = "12 of 60 random poses need corrected commands outside the travel; they are left out";
  EXPECT_EQ(result.err, "abbe: " + words + " (--accept-uncovered: exit code 0)\n");
  EXPECT_THAT(result.out, HasSubstr("  " + words + "\n"));
  asked.emplace_back("--accept-uncovered");
  const CommandResult accepted = verify(asked);
  EXPECT_EQ(accepted.exit_code, ExitCode::done);
  EXPECT_EQ(accepted.err, "abbe: " + words + "\n");
  // What is wanted and not met is not accepted with it.
  asked.insert(asked.end(), {"--least-reduction", "1000"});
  EXPECT_EQ(verify(asked).exit_code, ExitCode::computation_says_no);
}

TEST_F(VerifyCommand, AMachineThatCannotCorrectThePositionIsToldSo) {
  const CommandResult result =
      abbe({"verify", "--machine", example("machines/rotary-table.machine.toml"), "--errors",
            example("rotary_table/table.errors.toml"), "--truth", example("rotary_table/table.errors.toml")});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("1000 of 1000 random poses cannot be reached with the axes that are corrected"));
  EXPECT_THAT(result.err, HasSubstr("a machine whose axes can correct the position of the tool"));
}

TEST_F(VerifyCommand, ThePageHoldsPosesAndPiecesAndReplacesNothingUnasked) {
  const std::string page = (folder.path() / "page.html").string(), trace = example("verify/cone-before.csv");
  const std::vector<std::string> asked = {
      "--poses", "50", "-o", page, "cone-frustum", "--before", trace, "--after", example("verify/cone-after.csv")};
  ASSERT_EQ(verify(asked).exit_code, ExitCode::done);
  const std::string text = folder.read("page.html");
  EXPECT_THAT(text, HasSubstr("\"verification\""));
  EXPECT_THAT(text, HasSubstr("Roundness at the foot"));
  EXPECT_THAT(text, HasSubstr("\"predicted_um\""));
  // The shares that the caption states are there as they are, not beside others.
  const std::size_t begin = text.find("\"percent\":") + std::string("\"percent\":").size();
  const auto percent = nlohmann::json::parse(text.substr(begin, text.find(']', begin) + 1 - begin));
  for (const double stated : {50.0, 95.0}) EXPECT_EQ(std::count(percent.begin(), percent.end(), stated), 1) << stated;
  EXPECT_THAT(verify(asked).err, HasSubstr("the file exists"));
  EXPECT_THAT(verify({"-o", "page.pdf"}).err, HasSubstr("a name ending in .html"));
}

TEST_F(VerifyCommand, TheSameSeedGivesTheSameFigures) {
  EXPECT_EQ(verify({"--poses", "60", "--json"}).out, verify({"--poses", "60", "--json", "--seed", "1"}).out);
  EXPECT_NE(verify({"--poses", "60", "--json"}).out, verify({"--poses", "60", "--json", "--seed", "2"}).out);
}

TEST_F(VerifyCommand, TracesThatAreWrongAreNamedWithLineAndField) {
  const std::string good = example("verify/cone-before.csv");
  const auto refused = [&](const std::string& trace) {
    const CommandResult result = verify(cone(good, trace));
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    return result.err;
  };
  EXPECT_THAT(refused(changed(2, "C_deg,A_deg,Y_mm,X_mm,W_mm")), HasSubstr("trace.csv:2"));
  EXPECT_THAT(refused(changed(2, "C_deg,B_deg,Y_mm,X_mm,Z_mm")), HasSubstr("B_deg: unknown column"));
  EXPECT_THAT(refused(changed(2, "C_deg,A_deg,Y_mm,X_mm,Z_deg")), HasSubstr("Z_deg"));
  EXPECT_THAT(refused(changed(7, "1,2,3,four,5")), HasSubstr("trace.csv:7"));
  EXPECT_THAT(refused(changed(7, "1,2,3,4")), HasSubstr("trace.csv:7"));
  EXPECT_THAT(refused(changed(3, "", true)), HasSubstr("1 sample"));
  EXPECT_THAT(refused(changed(100, "", true)), HasSubstr("the trace ends after"));
  EXPECT_THAT(refused(changed(100, "0,0,0,0,0")), HasSubstr("trace.csv:100"));
  EXPECT_THAT(refused(example("verify/s-before.csv")), HasSubstr("the tool never begins to cut the cone frustum"));
  EXPECT_THAT(refused("nowhere.csv"), HasSubstr("nowhere.csv"));
  const CommandResult elsewhere =
      verify({"--poses", "50", "cone-frustum", "--before", good, "--after", good, "--centre-mm", "0", "0", "40"});
  EXPECT_EQ(elsewhere.exit_code, ExitCode::bad_input);
  EXPECT_THAT(elsewhere.err, HasSubstr("with its sizes and centre as in abbe test-piece"));
}

TEST_F(VerifyCommand, ACovarianceThatIsNoneIsSaidToBeIt) {
  const std::string errors =
      folder
          .write("e.toml",
                 "covariance = \"c.csv\"\n[[location]]\nname = \"EC0Y\"\nvalue_urad = 20\n[[location]]\nname = "
                 "\"EB0Z\"\nvalue_urad = 20\n")
          .string();
  std::vector<std::string> arguments = files;
  arguments[4] = errors;
  // A correlation of 2.
  folder.write("c.csv",
               "parameter,unit,EC0Y,EB0Z,tool_X,tool_Y,tool_Z\nEC0Y,urad,1,2,0,0,0\nEB0Z,urad,2,1,0,0,0\n"
               "tool_X,um,0,0,0,0,0\ntool_Y,um,0,0,0,0,0\ntool_Z,um,0,0,0,0,0\n");
  const CommandResult result = abbe(arguments);
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("covariance: covariance is not positive semi-definite"));
}

TEST_F(VerifyCommand, ErrorsWithoutUncertaintiesAreComparedWithoutAPrediction) {
  std::vector<std::string> arguments = files;
  arguments[4] = folder.write("e.toml", "[[location]]\nname = \"EC0Y\"\nvalue_urad = 20\n").string();
  arguments.insert(arguments.end(), {"--poses", "50"});
  const CommandResult result = abbe(arguments);
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("True volumetric error at 50 random poses"));
  EXPECT_THAT(result.out, HasSubstr("predicted volumetric error, before"));
  EXPECT_THAT(result.out, testing::Not(HasSubstr("predicted volumetric error, after")));
  arguments.insert(arguments.end(), {"--largest-ratio", "1.5"});
  EXPECT_EQ(abbe(arguments).exit_code, ExitCode::bad_input);
}

TEST_F(VerifyCommand, WhatIsMissingOrOutOfRangeIsSaid) {
  EXPECT_THAT(abbe({"verify"}).err, HasSubstr("--machine"));
  EXPECT_THAT(abbe({"verify", "nowhere"}).err, HasSubstr("nowhere: is not a folder"));
  EXPECT_THAT(abbe({"verify", folder.path().string()}).err, HasSubstr("machine.toml: these results have no such file"));
  EXPECT_THAT(verify({"--range", "X_mm=-9000:9000"}).err, HasSubstr("within the travel"));
  for (const char* const none : {"0", "-1", "nan", "inf"}) {
    for (const char* const option : {"--least-reduction", "--largest-ratio"}) {
      const CommandResult result = verify({option, none});
      EXPECT_EQ(result.exit_code, ExitCode::bad_input) << option << none;
      EXPECT_THAT(result.err, HasSubstr(std::string(option) + ": " + none + " is not a condition"));
    }
  }
  EXPECT_THAT(verify({"no-such-results"}).err, HasSubstr("no-such-results: is not a folder"));
  EXPECT_THAT(verify({"--range", "X_deg=0:1"}).err, HasSubstr("unit 'deg' for a linear axis"));
  EXPECT_THAT(verify({"--range", "B_deg=0:1"}).err, HasSubstr("the machine has no axis 'B'"));
  EXPECT_THAT(verify({"--range", "X_mm=5:1"}).err, HasSubstr("or two with the smaller one first"));
  const std::vector<std::string> line = {"--range", "A_deg=-20", "--range", "C_deg=0",
                                         "--range", "Y_mm=0",    "--range", "Z_mm=-100"};
  const CommandResult on_a_line = verify(line);
  EXPECT_EQ(on_a_line.exit_code, ExitCode::bad_input);
  EXPECT_THAT(on_a_line.err, HasSubstr("--range: the tool is on one line at all poses"));
  EXPECT_THAT(verify({"--range", "X_mm=nan"}).err, HasSubstr("--range X_mm=nan"));
  EXPECT_EQ(verify({"cone-frustum", "--before", "a.csv"}).exit_code, ExitCode::bad_input);
}

}  // namespace
}  // namespace abbe
