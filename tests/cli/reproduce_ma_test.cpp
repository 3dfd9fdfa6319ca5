#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command_test.h"
#include "cli/reproduction_layout.h"

namespace abbe {
namespace {

class ReproduceMa : public CommandTest {};

TEST_F(ReproduceMa, JsonHasReadingsInversionsRanksAndTheGauge) {
  const CommandResult result = abbe({"reproduce", "ma", "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_TRUE(json["agrees_with_reference"]);
  for (const char* order : {"paperorder", "faceorder"}) {
    EXPECT_LT(json["details"]["reference_difference"][order]["angle_arcsec"].get<double>(), 1e-9);
    EXPECT_LT(json["details"]["reference_difference"][order]["length_mm"].get<double>(), 1e-9);
    const nlohmann::json& section = json["details"]["section_3_3"][order];
    for (const auto& [name, value] : section["exact_stepwise"].items()) {
      EXPECT_LT(value.get<double>(), name.ends_with("arcsec") ? 1e-11 : 1e-10) << name;
    }
  }
  EXPECT_NEAR(json["details"]["section_3_3"]["paperorder"]["corrected"]["eps_z_arcsec"].get<double>(), 0.0351, 6e-5);
  EXPECT_EQ(json["details"]["rank"][0]["rank"], 72);
  EXPECT_EQ(json["details"]["rank"][1]["rank"], 107);
  EXPECT_EQ(json["details"]["rank"][1]["unknowns"], 128);
  EXPECT_EQ(json["details"]["two_mounts"]["gauge"].size(), 21U);
  EXPECT_EQ(json["details"]["table_3"]["paper_after"]["eps_z_arcsec"], 27.38);
}

TEST_F(ReproduceMa, TextStatesTheGaugeAndWhatIsWrongInPrint) {
  const CommandResult result = abbe({"reproduce", "ma"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  for (const char* words : {"Wrong in print", "mean of EXC over the turn is zero", "axis average line",
                            "two mounts, turned by one face", "agrees with the reference"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words;
  }
}

TEST_F(ReproduceMa, TheFolderHoldsTablesFiguresAndThePage) {
  const CommandResult result = abbe({"reproduce", "ma", "--json", "-o", "results"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  expect_common_layout(folder.path() / "results", nlohmann::json::parse(result.out));
  for (const char* name :
       {"summary.json", "report.html", "tables/published.csv", "tables/table-1.csv", "tables/errors-46.csv",
        "tables/table-3.csv", "tables/figure-3.csv", "tables/figure-5.csv", "figures/figure-3a.svg",
        "figures/figure-3b.svg", "figures/figure-5-eps_x.svg", "study/section-3-3-readings-face-order.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "results" / name)) << name;
  }
}

}  // namespace
}  // namespace abbe
