#include <nlohmann/json.hpp>
#include <string>

#include "cli/command_test.h"
#include "cli/reproduction_layout.h"

namespace abbe {
namespace {

class ReproduceYin : public CommandTest {};

TEST_F(ReproduceYin, LinkagePositionAndContourErrorStandBesideThePaper) {
  const CommandResult result = abbe({"reproduce", "yin", "--json", "-o", "results"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_TRUE(json["agrees_with_reference"]);
  expect_common_layout(folder.path() / "results", json);
  EXPECT_NEAR(json["details"]["linkage"]["U"]["corrected"]["L_tA_mm"].get<double>(), -0.265, 1e-9);
  EXPECT_NEAR(json["details"]["linkage"]["U"]["printed"]["L_tA_mm"].get<double>(), 0.53, 1e-9);
  EXPECT_NEAR(json["details"]["positioning"]["table_to_workpiece"]["x_mm"].get<double>(), -73.896, 1e-9);
  const nlohmann::json& contour = json["details"]["contour"];
  // An independent program predicted 14.0, 24.2, 5.2 um; the causes are put together in another way there.
  EXPECT_NEAR(contour["across_the_curve"]["mean_um"].get<double>(), 14.0, 1.5);
  EXPECT_NEAR(contour["across_the_curve"]["max_um"].get<double>(), 24.2, 2.5);
  EXPECT_NEAR(contour["across_the_curve"]["standard_deviation_um"].get<double>(), 5.2, 1.0);
  EXPECT_NEAR(contour["rms_by_monte_carlo_um"].get<double>() / contour["rms_by_sensitivity_um"].get<double>(), 1, 0.05);
  EXPECT_EQ(contour["budget"][0]["cause"], "placement of the workpiece");
  EXPECT_NEAR(contour["L_tA_as_printed_um"].get<double>(), 217, 15);
}

}  // namespace
}  // namespace abbe
