#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using Plans = CommandTest;

std::string trunnion_study() {
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/examples/trunnion/trunnion.study.toml"));
  std::stringstream text;
  text << file.rdbuf();
  std::string study = text.str();
  const std::string relative = "\"../machines";
  study.replace(study.find(relative), relative.size(), "\"" + std::string(ABBE_SOURCE_DIR "/examples/machines"));
  // Fewer candidates than in the example: the sanitizers are slow.
  study.replace(study.find("poses = 1500"), 12, "poses = 400");
  study.replace(study.find("readings = 240"), 14, "readings = 100");
  return study;
}

TEST_F(Plans, ListReadingsAndCompareThemWithGrids) {
  // An instrument that is not planned changes nothing but for the note.
  folder.write("trunnion.study.toml", trunnion_study() +
                                          "\n[[setup]]\nname = \"bar\"\ninstrument = \"ball-bar\"\n"
                                          "spindle_ball_mm = [0, 0, -150]\nnoise = { length_um = 0.2 }\n"
                                          "[[setup.ball]]\nname = \"middle\"\ncentre_mm = [10, 5, 60]\n");
  const CommandResult planned = abbe({"plan", "trunnion.study.toml", "-o", "poses.csv", "--json"});
  ASSERT_EQ(planned.exit_code, done) << planned.err;
  EXPECT_THAT(planned.err, HasSubstr("only trackers are planned, not bar (ball-bar)"));
  const nlohmann::json json = nlohmann::json::parse(planned.out);
  const std::string csv = folder.read("poses.csv");
  EXPECT_EQ(csv.substr(csv.find("\nC_deg") + 1, 45), "C_deg,A_deg,Y_mm,X_mm,Z_mm,station,reflector\n");
  // A comment and a header stand above the readings.
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), 100U + 2U);
  // The best of some hundred grids with no fewer readings, and the smallest one that is as good.
  EXPECT_GT(json.at("grids_tried"), 100);
  EXPECT_GE(json.at("best_determined_grid_of_the_same_number").at("readings"), 100);
  EXPECT_GE(json.at("gain"), 1.5);
  EXPECT_GE(json.at("best_grid_of_the_same_number_with_prior").at("readings"), 100);
  EXPECT_GE(json.at("gain_with_prior"), 1.5);
  EXPECT_GE(json.at("gain_over_random_choice"), 1.3);
  EXPECT_GE(json.at("grid_readings_per_reading"), 2);
  EXPECT_LE(json.at("grid_of_the_same_uncertainty").at("uncertainty_um"),
            json.at("predicted_volumetric_uncertainty_um"));
  double before = 1e9;
  for (const nlohmann::json& point : json.at("curve")) {
    if (!point.at("determined").get<bool>()) continue;
    EXPECT_LT(point.at("uncertainty_um"), before);
    before = point.at("uncertainty_um");
    // Prior knowledge makes nothing worse.
    EXPECT_LE(point.at("uncertainty_with_prior_um").get<double>(), before * (1 + 1e-9));
  }
}

TEST_F(Plans, SayInWordsHowManyReadingsAreEnoughAndWhatGridsReach) {
  std::string study = trunnion_study();
  study.replace(study.find("poses = 400"), 11, "poses = 200");
  folder.write("small.study.toml", study.replace(study.find("readings = 100"), 14, "readings = 60"));
  const CommandResult planned = abbe({"plan", "small.study.toml"});
  ASSERT_EQ(planned.exit_code, done) << planned.err;
  EXPECT_THAT(planned.out, HasSubstr("how many are enough"));
  EXPECT_THAT(planned.out, HasSubstr("against grids"));
}

TEST_F(Plans, AreReadAgainAsPosesOfASimulation) {
  const std::string loop = std::string(ABBE_SOURCE_DIR "/examples/closed_loop/");
  const CommandResult simulated = abbe({"simulate", loop + "closed_loop.study.toml", "-o", "readings"});
  ASSERT_EQ(simulated.exit_code, done) << simulated.err;
  // Pose and reflector of every reading are those of the plan, in its order.
  std::ifstream plan(loop + "poses.csv");
  std::istringstream readings(folder.read("readings/tracker.csv"));
  std::string planned_row, read_row, skipped;
  std::getline(plan, skipped);
  std::getline(plan, skipped);
  while (std::getline(readings, read_row) && read_row.starts_with('#')) {
  }
  const auto fields = [](const std::string& row) {
    std::vector<std::string> result;
    std::istringstream stream(row);
    for (std::string field; std::getline(stream, field, ',');) result.push_back(field);
    return result;
  };
  const std::vector<std::string> header = fields(read_row);
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  const std::size_t c = column("C_deg"), z = column("Z_mm"), reflector = column("reflector");
  ASSERT_LT(std::max({c, z, reflector}), header.size());
  std::size_t rows = 0;
  while (std::getline(plan, planned_row)) {
    ASSERT_TRUE(std::getline(readings, read_row));
    const std::vector<std::string> want = fields(planned_row), have = fields(read_row);
    EXPECT_NEAR(std::stod(have.at(c)), std::stod(want.at(0)), 1e-9);
    EXPECT_NEAR(std::stod(have.at(z)), std::stod(want.at(4)), 1e-9);
    EXPECT_EQ(have.at(reflector), want.at(6));
    ++rows;
  }
  EXPECT_EQ(rows, 400U);
}

TEST_F(Plans, WithoutATableSayWhatIsMissing) {
  std::string study = trunnion_study();
  const std::size_t begin = study.find("[plan]"), end = study.find("[simulate");
  ASSERT_LT(begin, end);
  study.erase(begin, end - begin);
  folder.write("trunnion.study.toml", study);
  const CommandResult result = abbe({"plan", "trunnion.study.toml"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("[plan]"));
}

TEST_F(Plans, WhatOneReflectorCannotSeeAnotherWouldShow) {
  std::string study = trunnion_study();
  const std::size_t second = study.find("[[setup.reflector]]\nname = \"S2\""), plan = study.find("[[setup.plan]]");
  ASSERT_LT(second, plan);
  study.erase(second, plan - second);
  folder.write("one.study.toml", study);
  const CommandResult result = abbe({"run", "one.study.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("what would show more"));
  EXPECT_THAT(result.out, HasSubstr("another reflector at a known place"));
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("\"advice\":[{"));
}

TEST_F(Plans, WhatABallBarDoesNotSeeIsSaidInTheTerminalTheSummaryAndTheReport) {
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/examples/trunnion/ball-bar.study.toml"));
  std::stringstream text;
  text << file.rdbuf();
  std::string study = text.str();
  const std::string relative = "\"../machines";
  study.replace(study.find(relative), relative.size(), "\"" + std::string(ABBE_SOURCE_DIR "/examples/machines"));
  // With priors as wide as nobody would state them, what they alone determine is larger than errors of a usual machine.
  study.erase(study.find("[[identify.prior]]"));
  study +=
      "[[identify.prior]]\nparameters = [\"EX*\", \"EY*\", \"EZ*\"]\nstandard_uncertainty_um = 20\n"
      "[[identify.prior]]\nparameters = [\"EA*\", \"EB*\", \"EC*\"]\nstandard_uncertainty_urad = 60\n";
  folder.write("bar.study.toml", study);
  const CommandResult result = abbe({"run", "bar.study.toml", "-o", "out"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("rests on prior knowledge alone"));
  EXPECT_THAT(result.out, HasSubstr("straightness error motion of Z in Y"));
  EXPECT_THAT(result.out, HasSubstr("at another place, 100 mm off in"));
  EXPECT_THAT(result.out, HasSubstr("are conventions: no measurement would show them"));
  const nlohmann::json summary = nlohmann::json::parse(folder.read("out/summary.json"));
  std::size_t verified = 0, conventions = 0;
  for (const nlohmann::json& one : summary.at("not_seen")) {
    verified += one.at("verified").get<bool>() && one.at("kind") == "not measured" ? 1U : 0U;
    conventions += one.at("kind") == "convention" ? 1U : 0U;
  }
  EXPECT_GT(verified, 5U);
  EXPECT_GT(conventions, 5U);
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("straightness error motion of Z in Y"));
}

}  // namespace
}  // namespace abbe
