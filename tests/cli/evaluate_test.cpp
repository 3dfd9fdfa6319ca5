#include <gmock/gmock.h>

#include "cli/evaluate_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// Two targets and two runs; the figures are worked by hand in positioning_test.cpp, there without a unit.
const char* const kByHand =
    "run,direction,target_mm,deviation_um\n1,+,0,1\n1,+,100,4\n1,-,100,5\n1,-,0,-1\n2,+,0,3\n2,+,100,4\n2,-,100,7\n"
    "2,-,0,-1\n";

class Evaluate : public EvaluateTest {};

TEST_F(Evaluate, FiguresInTheirUnit) {
  folder.write("x.csv", kByHand);
  const nlohmann::json result = json({"positioning", "x.csv"});
  EXPECT_EQ(result["kind"], "positioning");
  EXPECT_EQ(result["figures"]["E"]["value_um"], 7.0);
  EXPECT_EQ(result["figures"]["B"]["value_um"], 3.0);
  EXPECT_EQ(result["figures"]["B_mean"]["value_um"], 0.5);
  EXPECT_EQ(result["figures"]["M"]["value_um"], 4.5);
  EXPECT_NEAR(result["figures"]["R"]["value_um"].get<double>(), 5.828427125, 1e-8);
  EXPECT_NEAR(result["figures"]["A"]["value_um"].get<double>(), 9.828427125, 1e-8);
  EXPECT_EQ(result["targets"][1]["reversal_um"], -2.0);
  EXPECT_FALSE(result.contains("within_tolerance"));
}

TEST_F(Evaluate, AToleranceThatIsExceededIsANegativeAnswer) {
  folder.write("x.csv", kByHand);
  EXPECT_EQ(json({"positioning", "x.csv", "--tolerance", "E_um=7"})["within_tolerance"], true);
  const nlohmann::json result = json({"positioning", "x.csv", "--tolerance", "A_mm=0.009", "--tolerance", "R_um=6"},
                                     ExitCode::computation_says_no);
  EXPECT_EQ(result["within_tolerance"], false);
  EXPECT_EQ(result["figures"]["A"]["verdict"], "exceeded");
  EXPECT_EQ(result["figures"]["R"]["verdict"], "within");
  const CommandResult people = abbe({"evaluate", "positioning", "x.csv", "--tolerance", "A_um=9"});
  EXPECT_EQ(people.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(people.out, HasSubstr("EXCEEDS the tolerance 9.00"));
}

TEST_F(Evaluate, AFigureThatCouldNotBeEvaluatedSatisfiesNoTolerance) {
  folder.write("x.csv", "direction,target_mm,deviation_um\n+,0,0\n+,100,1\n");
  const nlohmann::json result = json({"positioning", "x.csv", "--tolerance", "A_um=10"}, ExitCode::computation_says_no);
  EXPECT_FALSE(result["figures"]["A"].contains("value_um"));
  EXPECT_EQ(result["figures"]["A"]["not_evaluated"], "a position was not approached from both sides: no reversal");
  EXPECT_EQ(result["figures"]["A+"]["not_evaluated"],
            "a position was read only once from a side: no standard deviation");
  EXPECT_EQ(result["figures"]["E+"]["value_um"], 1.0);
  EXPECT_EQ(json({"positioning", "x.csv"})["figures"]["E+"]["value_um"], 1.0) << "without a tolerance it is done";
}

TEST_F(Evaluate, TolerancesThatAreNone) {
  folder.write("x.csv", kByHand);
  const auto refused = [&](const std::string& text, const std::string& message) {
    expect_refused({"positioning", "x.csv", "--tolerance", text}, "--tolerance " + text + ": " + message);
  };
  refused("A=10", "the unit is missing; expected A_mm, A_um or A_m");
  refused("A_arcsec=10", "'arcsec' is not a unit of a length; expected A_mm, A_um or A_m");
  refused("A_um=x", "'x' is not a number above zero; expected A_um=10, with a decimal point");
  refused("A_um=0", "'0' is not a number above zero; expected A_um=10, with a decimal point");
  const CommandResult unknown = abbe({"evaluate", "positioning", "x.csv", "--tolerance", "Q_um=1"});
  EXPECT_EQ(unknown.exit_code, ExitCode::bad_input);
  EXPECT_THAT(unknown.err, HasSubstr("there is no such figure; expected one of A_um, A+_um, A-_um, E_um"));
}

TEST_F(Evaluate, BadFilesNameLineAndField) {
  folder.write("x.csv", "direction,target_mm,deviation_um\n+,0,0\n+,1O0,1\n");
  expect_refused({"positioning", "x.csv"}, "x.csv:3:3: target_mm: '1O0' is not a number; expected a length in mm");
  expect_refused({"positioning", "none.csv"}, "none.csv: there is no such file");
  EXPECT_EQ(abbe({"evaluate"}).exit_code, ExitCode::bad_input);
  EXPECT_EQ(abbe({"evaluate", "nonsense", "x.csv"}).exit_code, ExitCode::bad_input);
}

TEST_F(Evaluate, ResultsAreAFolderWithPlotAndPageAndTheSameBytesEachTime) {
  for (const std::string kind : {"positioning", "diagonals"}) {
    const std::string file = examples + (kind == "positioning" ? "linear.csv" : "diagonals.csv");
    ASSERT_EQ(abbe({"evaluate", kind, file, "-o", kind + "1"}).exit_code, ExitCode::done);
    ASSERT_EQ(abbe({"evaluate", kind, file, "-o", kind + "2"}).exit_code, ExitCode::done);
    for (const std::string name : {"/evaluation.json", "/plot.svg", "/report.html"}) {
      EXPECT_EQ(folder.read(kind + "1" + name), folder.read(kind + "2" + name)) << name;
    }
    EXPECT_THAT(folder.read(kind + "1/plot.svg"), testing::StartsWith("<svg "));
    const std::string page = folder.read(kind + "1/report.html"), mark = "id=\"abbe-data\">";
    const std::size_t from = page.find(mark) + mark.size();
    const nlohmann::json data = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
    EXPECT_EQ(data["evaluation"]["drawings"][0]["svg"], folder.read(kind + "1/plot.svg"));
    EXPECT_EQ(nlohmann::json::parse(folder.read(kind + "1/evaluation.json")), json({kind, file}));
  }
}

TEST_F(Evaluate, ARotaryAxisIsInArcsec) {
  const nlohmann::json result =
      json({"positioning", examples + "rotary.csv", "--tolerance", "A_arcsec=25", "--environment-arcsec", "0.5"});
  // 6 sin(t + 0.4) and 2.1 cos(2 t), 1.5 from each side.
  EXPECT_NEAR(result["figures"]["B_mean"]["value_arcsec"].get<double>(), 3, 0.3);
  EXPECT_NEAR(result["figures"]["M"]["value_arcsec"].get<double>(), 13, 2);
  EXPECT_GT(result["figures"]["A"]["expanded_uncertainty_arcsec"].get<double>(), 0.5);
}

TEST_F(Evaluate, UncertaintyOfTheOtherKindOfAxisIsRefused) {
  folder.write("x.csv", kByHand);
  expect_refused({"positioning", "x.csv", "--instrument-arcsec", "1"},
                 "an uncertainty in arcsec was given for a linear axis; expected --instrument-um, --setup-um, "
                 "--environment-um");
  const nlohmann::json result = json({"positioning", "x.csv", "--instrument-um", "0.5", "--tolerance", "E_um=7.2"});
  EXPECT_EQ(result["figures"]["E"]["expanded_uncertainty_um"], 0.5);
  EXPECT_EQ(result["figures"]["E"]["verdict"], "within, not proven");
}

TEST_F(Evaluate, AFigureThatNoStatedContributionAffectsHasNoUncertaintyOfZero) {
  const std::vector<std::string> words{"positioning", examples + "linear.csv", "--instrument-um",
                                       "0.5",         "--tolerance",           "R_um=10"};
  const nlohmann::json result = json(words);
  EXPECT_GT(result["figures"]["E"]["expanded_uncertainty_um"].get<double>(), 0);
  EXPECT_FALSE(result["figures"]["R"].contains("expanded_uncertainty_um"));
  EXPECT_EQ(result["figures"]["R"]["verdict"], "within");
  EXPECT_THAT(result["notes"].dump(), testing::HasSubstr("No stated contribution affects R, R+, R-, B, B_mean"));
}

TEST_F(Evaluate, DiagonalsShowTheSquarenessThatWasPutIn) {
  const nlohmann::json result = json({"diagonals", examples + "diagonals.csv"});
  ASSERT_EQ(result["diagonals"].size(), 4U);
  // Rates of the formula in examples/evaluate/README.md: -3 + 15 dx dy - 8 dx dz + 5 dy dz um/m over 0.78 m.
  const double length_squared = 600 * 600 + 400 * 400 + 300 * 300;
  const double xy = 15 * 600 * 400 / length_squared, xz = -8 * 600 * 300 / length_squared,
               yz = 5 * 400 * 300 / length_squared;
  const double rates[] = {-3 + xy + xz + yz, -3 - xy - xz + yz, -3 - xy + xz - yz, -3 + xy - xz - yz};
  for (std::size_t i = 0; i < 4; ++i) {
    const nlohmann::json& targets = result["diagonals"][i]["targets"];
    const double change =
        targets.back()["mean_bidirectional_um"].get<double>() - targets.front()["mean_bidirectional_um"].get<double>();
    EXPECT_NEAR(change, 0.78 * rates[i], 0.5) << i;
  }
  EXPECT_EQ(result["figures"]["E_d"]["value_um"], result["diagonals"][2]["E_um"]);
  EXPECT_NEAR(result["figures"]["B_d"]["value_um"].get<double>(), 1.2, 0.6);
}

TEST_F(Evaluate, HelpNamesTheColumnsAndShowsAnExample) {
  for (const std::string kind : {"positioning", "diagonals"}) {
    const CommandResult result = abbe({"evaluate", kind, "--help"});
    EXPECT_EQ(result.exit_code, ExitCode::done);
    EXPECT_THAT(result.out, HasSubstr("deviation_um"));
    EXPECT_THAT(result.out, HasSubstr("Example:"));
    EXPECT_THAT(result.out, HasSubstr("--tolerance"));
  }
}

}  // namespace
}  // namespace abbe
