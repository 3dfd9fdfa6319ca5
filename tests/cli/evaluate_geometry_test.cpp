#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/evaluate_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

/// `abbe evaluate` of the examples of circular tests, axes of rotation, straightness and squareness.
class EvaluateGeometry : public EvaluateTest {
 protected:
  nlohmann::json figures(std::vector<std::string> arguments, int exit_code = ExitCode::done) const {
    return json(std::move(arguments), exit_code).at("figures");
  }
  /// The true value lies within the stated expanded uncertainty and a little more, for what the simulation has besides.
  static void expect_covers(const nlohmann::json& figure, const std::string& unit, double truth, double allowance) {
    const double value = figure.at("value_" + unit), uncertainty = figure.at("expanded_uncertainty_" + unit);
    EXPECT_NEAR(value, truth, uncertainty + allowance) << figure;
  }
};

TEST_F(EvaluateGeometry, CausesOfTheCircularExampleAreThoseItWasMadeWith) {
  const auto figures = this->figures({"circular", examples + "circular.csv", "--radius-mm", "150", "--u-reading-um",
                                      "0.2", "--feed-mm-min", "1000", "--skip-reversal-deg", "10"});
  expect_covers(figures.at("scale_X"), "um_per_m", 20, 0.3);
  expect_covers(figures.at("scale_Y"), "um_per_m", -8, 0.3);
  expect_covers(figures.at("squareness"), "urad", 35, 0.3);
  expect_covers(figures.at("reversal_X"), "um", -4, 0.05);
  expect_covers(figures.at("reversal_Y"), "um", -2.5, 0.05);
  expect_covers(figures.at("servo_mismatch"), "um", 3, 0.05);
  expect_covers(figures.at("centre_X"), "um", 18, 0.05);
  const double servo = figures.at("servo_mismatch").at("value_um");
  EXPECT_NEAR(figures.at("lag_mismatch").at("value_ms"), servo * 1e-3 / (1000.0 / 60) * 1e3, 1e-6);
  const double cw = figures.at("G_cw").at("value_um"), ccw = figures.at("G_ccw").at("value_um"),
               both = figures.at("G_b").at("value_um");
  // About its own centre each path alone is narrower, but for what one centre has over another.
  EXPECT_GT(both, 0.95 * std::max(cw, ccw));
  EXPECT_GT(cw, 3);
  const auto zone =
      this->figures({"circular", examples + "circular.csv", "--radius-mm", "150", "--centre", "minimum-zone"});
  EXPECT_LT(zone.at("G_b").at("value_um"), both);
  EXPECT_FALSE(zone.at("G_b").contains("expanded_uncertainty_um"));
}

TEST_F(EvaluateGeometry, ShortArcsSayWhatIsMissingAndTheExitCodeIsNegative) {
  std::string text = "angle_deg,direction,deviation_um\n";
  for (int i = 0; i <= 100; ++i) text += std::to_string(i) + ",ccw,1.5\n";
  folder.write("arc.csv", text);
  const auto figures = this->figures({"circular", "arc.csv", "--radius-mm", "100"}, ExitCode::computation_says_no);
  EXPECT_THAT(figures.at("G_ccw").at("not_evaluated"), HasSubstr("shorter than 200"));
  EXPECT_THAT(figures.at("squareness").at("not_evaluated"),
              HasSubstr("these readings do not separate it from the other causes"));
  EXPECT_FALSE(figures.contains("G_cw"));
  const auto instrument = this->figures({"circular", "arc.csv", "--radius-mm", "100", "--centre", "instrument"});
  EXPECT_NEAR(instrument.at("Fmax_ccw").at("value_um"), 1.5, 1e-6);
}

TEST_F(EvaluateGeometry, RotationExampleHasItsLobesAndItsAsynchronousPart) {
  const auto figures =
      this->figures({"rotation", examples + "rotation.csv", "--plane-distance-mm", "80", "--u-reading-um", "0.02"});
  // 0.35 cos 2t + 0.12 cos(3t + 1), and 0.15 cos 2.4 t that comes back after five turns; noise 0.02.
  EXPECT_NEAR(figures.at("radial_x1_synchronous").at("value_um"), 0.8, 0.15);
  EXPECT_NEAR(figures.at("radial_x1_asynchronous").at("value_um"), 0.3, 0.1);
  EXPECT_GT(figures.at("radial_x1_total").at("value_um"), figures.at("radial_x1_synchronous").at("value_um"));
  expect_covers(figures.at("axial_fundamental"), "um", 0.8, 0);
  EXPECT_NEAR(figures.at("axial_residual").at("value_um"), 0.3, 0.05);
  EXPECT_NEAR(figures.at("tilt_x_synchronous").at("value_urad"), 2 * 0.4 / 0.08, 2);
  EXPECT_TRUE(figures.contains("tilt_rotating_total") && figures.contains("radial_rotating_2_total"));
  EXPECT_FALSE(figures.contains("face_total") || figures.contains("radial_x1_fundamental"));
}

TEST_F(EvaluateGeometry, TooFewTurnsGiveNoErrorMotion) {
  std::string text = "angle_deg,axial_um\n";
  for (int i = 0; i < 108; ++i) text += std::to_string(10 * i) + ",0.5\n";
  folder.write("three.csv", text);
  const auto figures = this->figures({"rotation", "three.csv"}, ExitCode::computation_says_no);
  EXPECT_EQ(figures.at("axial_total").at("not_evaluated"), "fewer than 4 whole turns");
}

TEST_F(EvaluateGeometry, StraightnessAndSquarenessOfTheExamples) {
  const auto straight = figures({"straightness", examples + "straightness.csv", "--u-reading-um", "0.3"});
  const double least = straight.at("straightness_ls").at("value_um"),
               zone = straight.at("straightness_mz").at("value_um");
  EXPECT_LE(zone, least);
  EXPECT_NEAR(zone, 3, 1.2);
  EXPECT_GT(straight.at("straightness_mz").at("expanded_uncertainty_um"), 0.6);
  for (const std::string reference : {"least-squares", "minimum-zone"}) {
    const auto square = figures({"squareness", examples + "squareness.csv", "--u-reading-um", "0.3", "--u-square-urad",
                                 "1", "--reference", reference});
    expect_covers(square.at("squareness"), "urad", -12, 1);
  }
  const auto shifted = figures({"squareness", examples + "squareness.csv", "--square-urad=-5"});
  const auto plain = figures({"squareness", examples + "squareness.csv"});
  EXPECT_NEAR(shifted.at("squareness").at("value_urad"), plain.at("squareness").at("value_urad").get<double>() - 5,
              1e-6);
}

TEST_F(EvaluateGeometry, TolerancesCompareMagnitudesAndDecideTheExitCode) {
  const std::string file = examples + "squareness.csv";
  EXPECT_EQ(abbe({"evaluate", "squareness", file, "--tolerance", "squareness_urad=20"}).exit_code, ExitCode::done);
  // -12 urad is below 5, but not within it.
  EXPECT_EQ(abbe({"evaluate", "squareness", file, "--tolerance", "squareness_urad=5"}).exit_code,
            ExitCode::computation_says_no);
}

TEST_F(EvaluateGeometry, ResultsFoldersHoldPlotsAndAPage) {
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> cases = {
      {{"circular", examples + "circular.csv", "--radius-mm", "150"}, {"plot.svg", "causes.svg"}},
      {{"rotation", examples + "rotation.csv"}, {"radial_x1.svg", "radial_rotating_2.svg", "axial.svg"}},
      {{"straightness", examples + "straightness.csv"}, {"plot.svg"}},
      {{"squareness", examples + "squareness.csv"}, {"line-1.svg", "line-2.svg"}}};
  for (const auto& [arguments, plots] : cases) {
    std::vector<std::string> command = {"evaluate"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(), {"--output", arguments[0]});
    EXPECT_EQ(abbe(command).exit_code, ExitCode::done);
    EXPECT_TRUE(nlohmann::json::accept(folder.read(arguments[0] + "/evaluation.json")));
    EXPECT_THAT(folder.read(arguments[0] + "/report.html"), HasSubstr("</html>"));
    for (const std::string& plot : plots) {
      EXPECT_THAT(folder.read(arguments[0] + "/" + plot), testing::AllOf(HasSubstr("</svg>"), Not(HasSubstr("nan"))));
    }
  }
}

TEST_F(EvaluateGeometry, BadOptionsAndFilesAreSaid) {
  expect_refused({"circular", examples + "circular.csv", "--radius-mm", "nan"},
                 "--radius-mm: 'nan' is not a valid number; expected a length in mm from 0.001 to 1e+06");
  expect_refused({"circular", examples + "circular.csv", "--radius-mm", "150", "--u-reading-um=-1"},
                 "--u-reading-um: '-1' is not a valid number; expected a length in um from 0 to 1e+06");
  folder.write("p.csv", "X_mm,Z_mm,direction\n100,0,cw\n");
  expect_refused(
      {"circular", "p.csv", "--radius-mm", "100", "--plane", "XY"},
      "p.csv: --plane XY: the coordinates of the file are those of ZX; expected --plane only for files of a ball "
      "bar");
  folder.write("s.csv", "position_mm,deviation_um\n0,1\n1e-317,2\n5,1\n");
  expect_refused(
      {"straightness", "s.csv"},
      "s.csv:3: position_mm: this position is nearly the same as that of line 2: 1e-317 mm from it; expected "
      "the same position, or at least 1e-6 mm between positions");
}

}  // namespace
}  // namespace abbe
