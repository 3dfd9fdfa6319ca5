#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class CompareCommand : public CommandTest {
 protected:
  static std::string example(const std::string& name) {
    return (std::filesystem::path(ABBE_SOURCE_DIR) / "examples" / name).string();
  }
  const std::string machine = example("machines/three-axis-mill.machine.toml");
  const std::string march = example("compare/march.errors.toml");
  const std::string june = example("compare/june.errors.toml");
  const std::string october = example("compare/october.errors.toml");

  CommandResult compare(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "compare");
    arguments.insert(arguments.end(), {"--machine", machine});
    return abbe(arguments);
  }
};

TEST_F(CompareCommand, SaysWhatChangedAndWhatDidNot) {
  const CommandResult result = compare({march, october, "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["kind"], "compare");
  EXPECT_TRUE(json["judged"].get<bool>());
  std::vector<std::string> changed;
  for (const nlohmann::json& error : json["pairs"][0]["errors"]) {
    if (error["verdict"] == "changed") changed.push_back(error["name"]);
  }
  // As the readings were simulated: examples/compare/README.md.
  EXPECT_EQ(changed, (std::vector<std::string>{"EXX", "EC0Y"}));
  EXPECT_EQ(json["figures"]["changed"]["value"], 2);
  EXPECT_GT(json["figures"]["V_share"]["value"].get<double>(), 0.5);
  const CommandResult text = compare({march, october});
  EXPECT_THAT(text.out, HasSubstr("2 of 10 errors changed: EXX, EC0Y"));
}

TEST_F(CompareCommand, WritesThePageAndTheMapsOfThreeCampaigns) {
  const CommandResult result = compare({march, june, october, "-o", "out"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("Changes against march (A)"));
  EXPECT_THAT(folder.read("out/change-C-A.csv"), HasSubstr("change_x_um"));
  EXPECT_THAT(folder.read("out/change-C-B.vts"), HasSubstr("StructuredGrid"));
  EXPECT_THAT(folder.read("out/EXX-change.svg"), HasSubstr("<svg"));
  EXPECT_THAT(folder.read("out/evaluation.json"), HasSubstr("\"V_max_C_A\""));
}

TEST_F(CompareCommand, ResultsFoldersBringTheirMachine) {
  const std::string study = folder
                                .write("x.study.toml", "machine = \"" + machine +
                                                           "\"\nseed = 3\n[simulate]\n[simulate.generator]\nseed = "
                                                           "4\nmean_volumetric_um = 20\n"
                                                           R"(
[[setup]]
name = "laser"
instrument = "interferometer"
noise = { length_um = 0.2 }
[[setup.run]]
name = "X"
direction = [1, 0, 0]
optic_mm = [0, 0, -150]
[[setup.plan]]
kind = "line"
items = ["X"]
points = 20
axis.X = {}
axis.Y = { at_mm = 220 }
axis.Z = { at_mm = -230 }
[identify]
[[identify.motion]]
errors = ["EXX"]
basis = "legendre"
order = 3
)")
                                .string();
  for (const char* const name : {"march", "october"}) {
    const CommandResult run = abbe({"run", study, "--output", name, "--accept-misfit"});
    ASSERT_LE(run.exit_code, 1) << run.err;
  }
  const CommandResult result = abbe({"compare", "march", "october/", "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["campaigns"][1]["name"], "october");
  // The same seed gives the same readings.
  EXPECT_EQ(json["pairs"][0]["errors"][0]["name"], "EXX");
  EXPECT_EQ(json["pairs"][0]["errors"][0]["change_um"], 0);
  EXPECT_EQ(json["pairs"][0]["errors"][0]["verdict"], "not_significant");
}

TEST_F(CompareCommand, WhatCannotBeJudgedOrIsOutOfToleranceIsExitCodeOne) {
  const std::string bare =
      folder.write("bare.errors.toml", "[[location]]\nname = \"EC0Y\"\nvalue_urad = 20\n").string();
  const CommandResult not_known = compare({march, bare});
  EXPECT_EQ(not_known.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(not_known.out, HasSubstr("significance of 1 not known"));
  EXPECT_THAT(not_known.err, HasSubstr("not all changes could be judged"));
  const std::string other =
      folder
          .write("other.errors.toml", "[[location]]\nname = \"EA0Z\"\nvalue_urad = 20\nstandard_uncertainty_urad = 1\n")
          .string();
  const CommandResult nothing = compare({bare, other});
  EXPECT_EQ(nothing.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(nothing.out, HasSubstr("there is no error to compare"));
  EXPECT_EQ(compare({march, october, "--tolerance", "V_max_um=1"}).exit_code, ExitCode::computation_says_no);
  EXPECT_EQ(compare({march, october, "--tolerance", "V_max_um=1000"}).exit_code, ExitCode::done);
}

TEST_F(CompareCommand, WhatIsWrongIsNamed) {
  const CommandResult single = compare({march});
  EXPECT_EQ(single.exit_code, ExitCode::bad_input);
  EXPECT_THAT(single.err, HasSubstr("campaigns: 1 to compare; expected two to 26"));
  const CommandResult no_machine = abbe({"compare", march, october});
  EXPECT_EQ(no_machine.exit_code, ExitCode::bad_input);
  EXPECT_THAT(no_machine.err, HasSubstr("--machine: is missing"));
  EXPECT_THAT(compare({march, "nowhere.errors.toml"}).err, HasSubstr("nowhere.errors.toml"));
  EXPECT_THAT(compare({march, folder.path().string()}).err, HasSubstr("errors.toml: these results have no such file"));
  EXPECT_EQ(compare({march, october, "--level-percent", "0"}).exit_code, ExitCode::bad_input);
  EXPECT_THAT(compare({march, october, "--tolerance", "V=1"}).err, HasSubstr("there is no such figure"));
}

}  // namespace
}  // namespace abbe
