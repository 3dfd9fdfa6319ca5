#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "cli/evaluate_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// `abbe evaluate` of the examples of thermal tests; the formulas they were made with: examples/evaluate/README.md.
class EvaluateThermal : public EvaluateTest {
 protected:
  static void expect_near(const nlohmann::json& figure, const std::string& unit, double truth, double allowance) {
    EXPECT_NEAR(figure.at("value_" + unit).get<double>(), truth, allowance) << figure;
  }
};

TEST_F(EvaluateThermal, EtveExampleHasItsAmplitudes) {
  const nlohmann::json result = json({"etve", examples + "etve.csv", "--plane-distance-mm", "150", "--u-reading-um",
                                      "0.1", "--u-reading-K", "0.1", "--tolerance", "ETVE_Z_um=20"});
  const auto& figures = result.at("figures");
  // Twice the amplitudes; the noise of 0.1 um widens them.
  expect_near(figures.at("ETVE_X1"), "um", 4, 0.2);
  expect_near(figures.at("ETVE_Z"), "um", 14, 0.2);
  expect_near(figures.at("ETVE_A"), "urad", 2 * 0.6 / 0.15, 2);
  expect_near(figures.at("ETVE_B"), "urad", 2 * 1.2 / 0.15, 2);
  expect_near(figures.at("ETVE1h_Z"), "um", 14 * std::sin(std::numbers::pi / 24), 0.25);
  expect_near(figures.at("T_air"), "K", 3.2, 0.3);
  expect_near(figures.at("rate_air"), "K_per_h", 3.2 * std::sin(std::numbers::pi / 24), 0.3);
  EXPECT_NEAR(figures.at("ETVE_Z").at("expanded_uncertainty_um").get<double>(), 0.2 * std::sqrt(2), 1e-9);
  EXPECT_NEAR(figures.at("rate_air").at("expanded_uncertainty_K_per_h").get<double>(), 0.2 * std::sqrt(2), 1e-9);
  EXPECT_EQ(figures.at("ETVE_Z").at("verdict"), "within");
  EXPECT_EQ(result.at("standard"), "ISO 230-3:2020");
}

TEST_F(EvaluateThermal, TheUncertaintyOfALengthFollowsFromTheTest) {
  const std::vector<std::string> asked = {"etve",
                                          examples + "etve.csv",
                                          "--length-mm",
                                          "500",
                                          "--workpiece-expansion-um-per-m-K",
                                          "23",
                                          "--u-workpiece-expansion-um-per-m-K",
                                          "1",
                                          "--u-workpiece-temperature-K",
                                          "0.2"};
  const auto figures = json(asked).at("figures");
  const nlohmann::json result = json(asked);
  double mean = 0;
  for (const auto& one : result.at("temperatures")) mean += one.at("mean_degC").get<double>() / 2;
  EXPECT_NEAR(figures.at("NDE").at("value_um").get<double>(), 0.5 * 23 * (mean - 20), 1e-6);
  const double etve = figures.at("ETVE_Z").at("value_um");
  const double u = std::hypot(0.5 * std::hypot(mean - 20, 0.2), 0.5 * 23 * 0.2, etve / std::sqrt(12));
  EXPECT_NEAR(figures.at("U_L").at("value_um").get<double>(), 2 * u, 1e-6);
  expect_refused({"etve", examples + "etve.csv", "--scale-expansion-um-per-m-K", "8"},
                 "--scale-expansion-um-per-m-K: has no effect without a length; expected also --length-mm");
}

TEST_F(EvaluateThermal, SpindleExampleHasItsTimeConstants) {
  const nlohmann::json result =
      json({"spindle-distortion", examples + "spindle.csv", "--stop-min", "240", "--plane-distance-mm", "150"});
  const auto& figures = result.at("figures");
  expect_near(figures.at("d60_Z"), "um", 28 * (1 - std::exp(-60.0 / 45)), 0.2);
  expect_near(figures.at("d_Z"), "um", 28 * (1 - std::exp(-240.0 / 45)), 0.2);
  for (const auto& [symbol, constant] :
       {std::pair("tau_Z", 45.0), std::pair("tau_Y2", 55.0), std::pair("tau_X2", 70.0)}) {
    const auto& figure = figures.at(symbol);
    expect_near(figure, "min", constant, figure.at("expanded_uncertainty_min").get<double>() + 0.05);
    EXPECT_LT(figure.at("expanded_uncertainty_min").get<double>(), 3) << symbol;
  }
  EXPECT_NEAR(result.at("sensors").at(4).at("cooling").at("time_constant_min").get<double>(), 1.6 * 45, 1.5);
  const nlohmann::json blind = json({"spindle-distortion", examples + "spindle.csv"});
  EXPECT_EQ(blind.at("figures").at("tau_Z").at("not_evaluated"), "the readings do not follow a first-order response");
  EXPECT_FALSE(blind.at("figures").contains("d60_A"));
}

TEST_F(EvaluateThermal, AxisExampleHasItsExpansion) {
  const nlohmann::json result = json({"axis-distortion", examples + "axis_warming.csv", "--u-reading-um", "0.1"});
  const auto& figures = result.at("figures");
  // All targets have been read from 0.8 min to 180 min.
  const double end = 1 - std::exp(-180.0 / 40), common = std::exp(-0.8 / 40) - std::exp(-180.0 / 40);
  const auto& expansion = figures.at("expansion_L");
  expect_near(expansion, "um_per_m", 45 * common, expansion.at("expanded_uncertainty_um_per_m"));
  expect_near(figures.at("d_L"), "um", 18 * common, 0.3);
  expect_near(figures.at("d_P1"), "um", 3 * end, 0.3);
  expect_near(figures.at("tau_L"), "min", 40, figures.at("tau_L").at("expanded_uncertainty_min"));
}

TEST_F(EvaluateThermal, AToleranceThatIsExceededIsANegativeAnswer) {
  const nlohmann::json result = json({"axis-distortion", examples + "axis_warming.csv", "--tolerance", "d_L_um=5"},
                                     ExitCode::computation_says_no);
  EXPECT_EQ(result.at("figures").at("d_L").at("verdict"), "exceeded");
  EXPECT_EQ(json({"spindle-distortion", examples + "spindle.csv", "--tolerance", "tau_Z_min=50"},
                 ExitCode::computation_says_no)
                .at("figures")
                .at("tau_Z")
                .at("verdict"),
            "cannot be judged");
}

TEST_F(EvaluateThermal, ColumnsMayHaveOtherNames) {
  folder.write("log.csv", "t,probe,remark\n0,1,a\n1,2,b\n");
  const nlohmann::json result =
      json({"etve", "log.csv", "--column", "time_min=t", "--column", "Z_um=probe", "--ignore", "remark"});
  EXPECT_EQ(result.at("figures").at("ETVE_Z").at("value_um"), 1.0);
  folder.write("bare.csv", "time_min,Z\n0,1\n1,2\n");
  const CommandResult bare = abbe({"evaluate", "etve", "bare.csv"});
  EXPECT_EQ(bare.exit_code, ExitCode::bad_input);
  EXPECT_THAT(bare.err, HasSubstr("bare.csv:1: Z: the name of this column does not end in a unit"));
}

TEST_F(EvaluateThermal, ResultsAreAFolderWithPlotsAndAPage) {
  const CommandResult result =
      abbe({"evaluate", "spindle-distortion", examples + "spindle.csv", "--stop-min", "240", "-o", "out"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("time constant of Z while warming"));
  EXPECT_THAT(folder.read("out/plot.svg"), testing::StartsWith("<svg "));
  EXPECT_THAT(folder.read("out/temperatures.svg"), HasSubstr("time since the start in h"));
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("Thermal distortion by the rotating spindle"));
  EXPECT_EQ(nlohmann::json::parse(folder.read("out/evaluation.json")).at("kind"), "spindle-distortion");
}

}  // namespace
}  // namespace abbe
