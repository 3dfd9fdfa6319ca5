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
  folder.write("trunnion.study.toml", trunnion_study());
  const CommandResult planned = abbe({"plan", "trunnion.study.toml", "-o", "poses.csv", "--json"});
  ASSERT_EQ(planned.exit_code, done) << planned.err;
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
  const CommandResult planned = abbe({"plan", "small.study.toml", "-o", "poses.csv", "--report", "plan.html"});
  ASSERT_EQ(planned.exit_code, done) << planned.err;
  EXPECT_THAT(planned.out, HasSubstr("how many are enough"));
  EXPECT_THAT(planned.out, HasSubstr("against grids"));

  const std::string page = folder.read("plan.html"), mark = "id=\"abbe-data\">";
  const std::size_t from = page.find(mark) + mark.size();
  const nlohmann::json data = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  const nlohmann::json& plan = data.at("plan");
  EXPECT_EQ(plan.at("readings").at("rows").size(), 60U);
  EXPECT_EQ(plan.at("readings").at("columns").size(), plan.at("readings").at("rows")[0].size());
  EXPECT_EQ(plan.at("curve").at("readings").size(), plan.at("curve").at("uncertainty_um").size());
  EXPECT_FALSE(plan.at("open").empty());
  EXPECT_EQ(data.at("path").at("moves"), 60);
  EXPECT_EQ(data.at("path").at("stops"), true);
  const std::vector<double> times = data.at("path").at("time_s").get<std::vector<double>>();
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  // Minutes of the whole measurement are when the last reading is finished.
  for (const nlohmann::json& figure : data.at("evaluation").at("figures")) {
    if (figure.at("symbol") != "time") continue;
    EXPECT_NEAR(figure.at("value_min").get<double>(), times.back() / 60, 1e-3);
  }
}

/// A study of examples/, with other lines.
std::string example(const std::string& name) {
  std::ifstream file(ABBE_SOURCE_DIR "/examples/" + name);
  std::stringstream text;
  text << file.rdbuf();
  std::string study = text.str();
  const std::string relative = "\"../machines";
  return study.replace(study.find(relative), relative.size(), "\"" ABBE_SOURCE_DIR "/examples/machines");
}

/// The study with all its plans replaced by the poses of a file, and no reading held out.
std::string with_poses_of(const std::string& study, const std::string& file) {
  std::istringstream lines(study);
  std::string result, line;
  bool in_plan = false, has_file = false;
  while (std::getline(lines, line)) {
    if (line.starts_with('[')) in_plan = line.starts_with("[[setup.plan]]") || line.starts_with("[setup.plan");
    if (line.starts_with("[[setup]]")) has_file = false;
    if (in_plan && !has_file) result += "[[setup.plan]]\nkind = \"poses\"\nfile = \"" + file + "\"\n";
    has_file = has_file || in_plan;
    if (in_plan || line.starts_with("held_out_fraction")) continue;
    result += line + "\n";
    if (line == "[identify]") result += "held_out_fraction = 0\n";
  }
  return result;
}

TEST_F(Plans, OfEveryInstrumentPredictTheUncertaintyThatTheIdentificationFinds) {
  for (const char* const name :
       {"trunnion/ball-bar", "three_axis/interferometer", "three_axis/tracking-interferometer"}) {
    SCOPED_TRACE(name);
    const std::string study = example(std::string(name) + ".study.toml");
    folder.write("planned.study.toml", study + "\n[plan]\nreadings = 150\nposes = 600\n");
    const CommandResult planned = abbe({"plan", "planned.study.toml", "-o", "poses.csv", "--force", "--json"});
    ASSERT_EQ(planned.exit_code, done) << planned.err;
    const nlohmann::json json = nlohmann::json::parse(planned.out);
    EXPECT_EQ(json.at("readings"), 150);
    EXPECT_EQ(json.at("grids_tried"), 0);
    folder.write("measured.study.toml", with_poses_of(study, "poses.csv"));
    const CommandResult identified = abbe({"run", "measured.study.toml", "-o", std::string(name).substr(9)});
    ASSERT_EQ(identified.exit_code, done) << identified.err << identified.out;
    const nlohmann::json summary = nlohmann::json::parse(folder.read(std::string(name).substr(9) + "/summary.json"));
    const double expanded = summary.at("held_out").at("predicted_expanded_uncertainty_um").at("rms");
    EXPECT_NEAR(json.at("predicted_volumetric_uncertainty_um").get<double>() / (expanded / 2), 1, 0.06);
  }
}

TEST_F(Plans, SayWhichInstrumentsAreWorthSettingUp) {
  const std::string study = example("three_axis/interferometer.study.toml") +
                            "\n[plan]\ntime_s = 5400\n[plan.setup.positioning]\nset_up_s = 900\n"
                            "[plan.setup.straightness]\nset_up_s = 1200\n[plan.setup.diagonals]\nset_up_s = 1500\n"
                            "[plan.setup.step-diagonal]\nset_up_s = 1200\nreading_s = 2\n";
  folder.write("s.study.toml", study);
  const CommandResult planned = abbe({"plan", "s.study.toml", "--json"});
  ASSERT_EQ(planned.exit_code, done) << planned.err;
  const nlohmann::json json = nlohmann::json::parse(planned.out);
  ASSERT_EQ(json.at("combinations").size(), 15U);
  double best = 1e9;
  for (const nlohmann::json& choice : json.at("combinations")) {
    if (!choice.at("possible").get<bool>()) continue;
    EXPECT_LE(choice.at("time_s"), 5400);
    best = std::min(best, choice.at("uncertainty_with_prior_um").get<double>());
  }
  EXPECT_LE(json.at("predicted_volumetric_uncertainty_with_prior_um").get<double>(), 1.02 * best);
  EXPECT_LE(json.at("time_s"), 5400);
  // Less time than setting one up takes leaves nothing.
  std::string hasty = study;
  folder.write("hasty.study.toml", hasty.replace(hasty.find("time_s = 5400"), 13, "time_s = 1000"));
  const CommandResult less = abbe({"plan", "hasty.study.toml"});
  EXPECT_EQ(less.exit_code, done) << less.err;
  EXPECT_THAT(less.out, HasSubstr("open     in the time allowed"));

  std::string wrong = study;
  folder.write("wrong.study.toml", wrong.replace(wrong.find("setup.diagonals]"), 16, "setup.diagonal]"));
  const CommandResult refused = abbe({"plan", "wrong.study.toml"});
  EXPECT_EQ(refused.exit_code, bad_input);
  EXPECT_THAT(refused.err, HasSubstr("plan.setup.diagonal: there is no set-up of that name; expected one of "
                                     "positioning, straightness, diagonals, step-diagonal"));
}

TEST_F(Plans, ABarNeedsItsCircles) {
  const std::string bar =
      "\n[[setup]]\nname = \"bar\"\ninstrument = \"ball-bar\"\nspindle_ball_mm = [0, 0, -150]\n"
      "noise = { length_um = 0.2 }\n[[setup.ball]]\nname = \"middle\"\ncentre_mm = [10, 5, 60]\n";
  folder.write("trunnion.study.toml", trunnion_study() + bar);
  const CommandResult refused = abbe({"plan", "trunnion.study.toml"});
  EXPECT_EQ(refused.exit_code, bad_input);
  EXPECT_THAT(refused.err, HasSubstr("setup bar: the study does not say where instrument \"ball-bar\" can be read"));

  folder.write("both.study.toml", trunnion_study() + bar +
                                      "[[setup.plan]]\nkind = \"circle\"\nplane = [\"X\", \"Y\"]\n"
                                      "radius_mm = 60\npoints = 90\n");
  const CommandResult both = abbe({"plan", "both.study.toml", "-o", "poses.csv", "--json"});
  ASSERT_EQ(both.exit_code, done) << both.err;
  const nlohmann::json json = nlohmann::json::parse(both.out);
  EXPECT_EQ(json.at("readings_of_setups").at("bar").get<int>() + json.at("readings_of_setups").at("tracker").get<int>(),
            100);
  // Thirty readings have more rows than there are errors and still leave some open: that is said, and no number.
  double before = 1e9;
  for (const nlohmann::json& point : json.at("curve")) {
    if (!point.at("determined").get<bool>()) continue;
    EXPECT_GT(point.at("uncertainty_um"), 0);
    EXPECT_LT(point.at("uncertainty_um"), before);
    before = point.at("uncertainty_um");
  }
  // Readings of the two are told apart by a column that both understand.
  const std::string csv = folder.read("poses.csv");
  EXPECT_THAT(csv, HasSubstr("C_deg,A_deg,Y_mm,X_mm,Z_mm,setup,station,target\n"));
  EXPECT_THAT(csv, HasSubstr(",bar,-,middle\n"));
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

TEST_F(Plans, ForTheTrunnionMillNeedLessThanHalfTheReadingsOfAGrid) {
  const std::string study = std::string(ABBE_SOURCE_DIR "/examples/trunnion/trunnion.study.toml");
  const CommandResult planned = abbe({"plan", study, "--json"});
  ASSERT_EQ(planned.exit_code, ExitCode::done) << planned.err;
  const nlohmann::json json = nlohmann::json::parse(planned.out);
  EXPECT_EQ(json.at("readings"), 240);
  EXPECT_GE(json.at("grid_readings_per_reading"), 2);
  EXPECT_GE(json.at("gain"), 1.5);
  EXPECT_GE(json.at("gain_with_prior"), 1.4);
  EXPECT_LT(json.at("predicted_volumetric_uncertainty_um"), 1.0);
}

}  // namespace
}  // namespace abbe
