#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "cli/command_test.h"
#include "cli/machine_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kTableAndColumn = R"(name = "table and column"
chain = "w C' X' b Z t"
[axis.C]
point_mm = [700, 0, -100]
travel_deg = [0, 360]
[axis.X]
travel_mm = [0, 1400]
[axis.Z]
point_mm = [0, 0, 300]
travel_mm = [0, 600]
[workpiece]
origin_mm = [700, 0, -100]
[tool]
reference_mm = [0, 0, 300]
)";

const std::string kSmallStudy = std::string(R"(name = "small"
machine = "m.machine.toml"
seed = 3
output = "out"
[simulate.generator]
seed = 5
mean_volumetric_um = 300
linear_order = 3
rotary_order = 2
location_errors = false
[[setup]]
name = "tracker"
instrument = "tracker"
noise = { xyz_um = 10, xyz_um_per_m = 5 }
[[setup.station]]
name = "S"
true_pose = { position_mm = [300, -200, 150], angles_deg = [5, -3, 130] }
)") + kThreeReflectors + R"([[setup.plan]]
kind = "random"
points = 150
axis.C = {}
axis.X = {}
axis.Z = {}
[identify]
[[identify.motion]]
errors = ["E?X", "E?Z"]
basis = "legendre"
order = 3
[[identify.motion]]
errors = "E?C"
basis = "fourier"
order = 2
[map]
axis.C = { count = 4 }
axis.X = { count = 3 }
axis.Z = { count = 3 }
)";

class Studies : public CommandTest {
 protected:
  Studies() { folder.write("m.machine.toml", kTableAndColumn); }

  /// The study with passages replaced, pairwise: from, to.
  void write_study(const std::vector<std::pair<std::string, std::string>>& changes = {}) const {
    std::string text = kSmallStudy;
    for (const auto& [from, to] : changes) {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    }
    folder.write("s.study.toml", text);
  }

  /// The study with measured instead of simulated readings.
  void write_measured_study(const std::string& csv, const std::string& options = "") const {
    folder.write("readings.csv", csv);
    std::string text = kSmallStudy;
    const std::size_t plan = text.find("[[setup.plan]]"), identify = text.find("[identify]");
    text.replace(plan, identify - plan, "[[setup.data]]\nfile = \"readings.csv\"\n" + options);
    const std::size_t simulate = text.find("[simulate.generator]"), setup = text.find("[[setup]]");
    text.erase(simulate, setup - simulate);
    const std::size_t pose = text.find("true_pose");
    text.erase(pose, text.find('\n', pose) + 1 - pose);
    folder.write("s.study.toml", text);
  }

  /// The data inside the page of the last run.
  nlohmann::json report_data() const {
    const std::string page = folder.read("out/report.html"), mark = "id=\"abbe-data\">";
    const std::size_t start = page.find(mark) + mark.size();
    return nlohmann::json::parse(page.substr(start, page.find("</script>", start) - start));
  }

  nlohmann::json run_json(int expected_exit = ExitCode::done) const {
    const CommandResult result = abbe({"run", "s.study.toml", "--json"});
    EXPECT_EQ(result.exit_code, expected_exit) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
};

TEST_F(Studies, FindReversalValuesWhereTheSidesOfApproachAreKnown) {
  write_study({{"mean_volumetric_um = 300", "mean_volumetric_um = 300\nreversal_um = 20\nreversal_urad = 60"},
               {"[identify]", "[identify]\nreversals = [\"*\"]"},
               {"points = 150", "points = 400"}});
  ASSERT_EQ(abbe({"simulate", "s.study.toml", "-o", "data"}).exit_code, ExitCode::done);
  const std::string csv = folder.read("data/tracker.csv");
  EXPECT_THAT(csv.substr(0, csv.find('\n')), HasSubstr(",C_approach,X_approach,Z_approach"));
  ASSERT_EQ(run_json()["status"], "converged");
  const auto values = [](const std::string& text) {
    std::map<std::string, double> found;
    const std::regex entry(R"re(\[\[reversal\]\]\naxis = "(\w+)"\nvalue_\w+ = ([-\d.e]+))re");
    for (std::sregex_iterator at(text.begin(), text.end(), entry), end; at != end; ++at) {
      found[(*at)[1]] = std::stod((*at)[2]);
    }
    return found;
  };
  const std::map<std::string, double> truth = values(folder.read("data/truth.errors.toml"));
  const std::map<std::string, double> found = values(folder.read("out/errors.toml"));
  ASSERT_EQ(truth.size(), 3U);
  ASSERT_EQ(found.size(), 3U);
  for (const auto& [axis, value] : truth) {
    EXPECT_LT(value, -9) << axis;
    EXPECT_NEAR(found.at(axis), value, axis == "C" ? 15 : 6) << axis;
  }

  // Measured readings say the same as simulated ones; without the columns nothing shows the reversal values.
  write_measured_study(csv);
  std::string study = folder.read("s.study.toml");
  study.replace(study.find("[identify]"), 10, "[identify]\nreversals = [\"X\", \"Z\"]");
  folder.write("s.study.toml", study);
  ASSERT_EQ(run_json()["status"], "converged");
  EXPECT_EQ(values(folder.read("out/errors.toml")).size(), 2U);
}

TEST_F(Studies, FindTheErrorsFromNothingButReadings) {
  write_study();
  const nlohmann::json summary = run_json();
  EXPECT_EQ(summary["status"], "converged");
  EXPECT_EQ(summary["parameters"], 6 * 4 + 6 * 4 + 6 * 5 + 6);
  EXPECT_EQ(summary["null_space"],
            18);  // the 24 of the published model without C0 and Z0, which are no parameters here
  EXPECT_GT(summary["held_out"]["position_before_um"]["mean"], 100);
  EXPECT_LT(summary["held_out"]["position_after_um"]["mean"], 12);
  EXPECT_NEAR(summary["held_out"]["coverage_percent"].get<double>(), 95, 5);
  EXPECT_NEAR(summary["normalised_residual_rms"].get<double>(), 1, 0.06);
  EXPECT_EQ(nlohmann::json::parse(folder.read("out/summary.json")), summary);
  // The report shows the same figures.
  EXPECT_EQ(report_data()["summary"], summary);
  EXPECT_LT(folder.read("out/report.html").size(), 3'000'000U);
}

TEST_F(Studies, MonteCarloConfirmsTheUncertaintiesOfTheCovariance) {
  write_study({{"[identify]", "[identify]\nmonte_carlo = 400"}});
  const nlohmann::json figures = run_json()["monte_carlo"];
  EXPECT_EQ(figures["samples"], 400);
  EXPECT_EQ(figures["agrees"], true) << figures;
  EXPECT_GT(figures["compared"], 60);
  // Four standard deviations of the ratio by chance: 1 / sqrt(2 * 399).
  EXPECT_NEAR(figures["chance_ratio_high"].get<double>(), 1 + 4 / std::sqrt(798), 0.03);
  // The columns of the page tell the same, parameter by parameter, in the parameter's unit.
  const nlohmann::json parameters = report_data()["parameters"];
  std::size_t compared = 0;
  double smallest = 10, largest = 0;
  for (std::size_t p = 0; p < parameters["name"].size(); ++p) {
    const nlohmann::json u = parameters["standard_uncertainty"][p], ratio = parameters["monte_carlo_ratio"][p];
    EXPECT_EQ(u.is_null(), ratio.is_null()) << parameters["name"][p];
    if (ratio.is_null()) continue;
    ++compared;
    smallest = std::min(smallest, ratio.get<double>());
    largest = std::max(largest, ratio.get<double>());
    EXPECT_NEAR(parameters["monte_carlo_uncertainty"][p].get<double>(), ratio.get<double>() * u.get<double>(),
                1e-9 * u.get<double>());
    const double width =
        parameters["monte_carlo_high"][p].get<double>() - parameters["monte_carlo_low"][p].get<double>();
    EXPECT_NEAR(width, 3.92 * u.get<double>(), 0.9 * u.get<double>());
  }
  EXPECT_EQ(figures["compared"], compared);
  EXPECT_DOUBLE_EQ(figures["smallest_uncertainty_ratio"].get<double>(), smallest);
  EXPECT_DOUBLE_EQ(figures["largest_uncertainty_ratio"].get<double>(), largest);
}

TEST_F(Studies, AMapKeepsToTheMeasuredRangeAndItsStatisticsToTheSamePoses) {
  write_study({{"axis.X = {}", "axis.X = { range_mm = [100, 1300] }"}});
  const nlohmann::json summary = run_json(), map = report_data()["map"];
  // Asked for over the whole travel, measured at random positions over a part of it.
  const std::vector<double> x = map["positions"]["X_mm"].get<std::vector<double>>();
  EXPECT_GT(*std::min_element(x.begin(), x.end()), 100);
  EXPECT_LT(*std::max_element(x.begin(), x.end()), 1300);
  EXPECT_THAT(summary["map"]["description"].get<std::string>(), HasSubstr("in which the errors are known"));
  ASSERT_EQ(summary["map"]["moved"].size(), 1U);
  EXPECT_THAT(summary["map"]["moved"][0].get<std::string>(), HasSubstr("asked for X from 0 to 1400 mm"));
  const nlohmann::json& range = summary["map"]["ranges"][1];
  EXPECT_EQ(range["axis"], "X");
  EXPECT_NEAR(range["range_mm"][0].get<double>(), *std::min_element(x.begin(), x.end()), 0.1);
  EXPECT_NEAR(range["range_mm"][1].get<double>(), *std::max_element(x.begin(), x.end()), 0.1);
  EXPECT_EQ(range["positions"], std::set<double>(x.begin(), x.end()).size());
  ASSERT_EQ(summary["map"]["poses"], x.size());
  const auto mean_length = [&](const char* key) {
    double sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const nlohmann::json& v = map[key];
      sum += std::hypot(v["x"][k].get<double>(), v["y"][k].get<double>(), v["z"][k].get<double>());
    }
    return sum / static_cast<double>(x.size());
  };
  for (const char* key : {"before_um", "after_um"}) {
    const double stated = summary["map"]["position_" + std::string(key)]["mean"];
    EXPECT_NEAR(mean_length(key), stated, 1e-3 * stated) << key;
  }
  const std::vector<double> uncertainty = map["expanded_uncertainty_um"].get<std::vector<double>>();
  const double largest = summary["map"]["predicted_expanded_uncertainty_um"]["max"];
  EXPECT_NEAR(*std::max_element(uncertainty.begin(), uncertainty.end()), largest, 1e-3 * largest);
}

TEST_F(Studies, AMapWithoutAnyMeasuredPoseStatesNoFigure) {
  write_study({{"axis.X = {}", "axis.X = { range_mm = [100, 1300] }"},
               {"axis.X = { count = 3 }", "axis.X = { range_mm = [1350, 1400], count = 2 }"}});
  const CommandResult left_out = abbe({"run", "s.study.toml", "--json"});
  EXPECT_EQ(left_out.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(left_out.err, HasSubstr("24 of 24 poses of the map lie outside the range in which the errors are known"));
  const nlohmann::json map = nlohmann::json::parse(left_out.out)["map"];
  EXPECT_EQ(map["poses"], 0);
  EXPECT_GT(map["outside_range"], 0);
  EXPECT_FALSE(map.contains("position_before_um"));
  EXPECT_FALSE(report_data().contains("map"));
}

TEST_F(Studies, SameInputAndSeedGiveTheSameBytes) {
  write_study();
  ASSERT_EQ(abbe({"run", "s.study.toml"}).exit_code, ExitCode::done);
  write_study({{"seed = 3", "seed = 3\nthreads = 1"}});
  ASSERT_EQ(abbe({"run", "s.study.toml", "-o", "again"}).exit_code, ExitCode::done);
  for (const char* file : {"errors.toml", "errors.covariance.csv", "summary.json", "residuals.csv", "report.html",
                           "readings/tracker.csv", "maps/volumetric_error.csv", "maps/volumetric_error.vts"}) {
    EXPECT_EQ(folder.read(std::string("out/") + file), folder.read(std::string("again/") + file)) << file;
  }
}

TEST_F(Studies, ReadingsWrittenByASimulationGiveTheSameResultAsData) {
  write_study();
  ASSERT_EQ(abbe({"simulate", "s.study.toml", "-o", "readings"}).exit_code, ExitCode::done);
  const nlohmann::json simulated = run_json();
  write_measured_study(folder.read("readings/tracker.csv"));
  const nlohmann::json read = run_json();
  EXPECT_NEAR(read["chi_square"].get<double>(), simulated["chi_square"].get<double>(), 1e-3);
  EXPECT_EQ(read["held_out"]["reference"], "readings");
  EXPECT_FALSE(read["held_out"].contains("coverage_percent"));
}

TEST_F(Studies, CovariancesOfRangeAndAnglesAreWrittenReadBackAndWeighTheFit) {
  write_study({{"noise = {", "measure = \"range-angles\"\nstate_uncertainty = \"covariance\"\nnoise = {"}});
  ASSERT_EQ(abbe({"simulate", "s.study.toml", "-o", "readings"}).exit_code, ExitCode::done);
  const nlohmann::json simulated = run_json();
  const std::string csv = folder.read("readings/tracker.csv");
  EXPECT_THAT(csv, HasSubstr(",cov_range_range_um2,cov_azimuth_azimuth_arcsec2,"));
  write_measured_study(csv);
  const std::string study = folder.read("s.study.toml");
  const std::size_t noise = study.find("noise = {"), end = study.find("[[setup.station]]");
  folder.write("s.study.toml", study.substr(0, noise) + "noise_from_data = true\n" + study.substr(end));
  const nlohmann::json read = run_json();
  EXPECT_NEAR(read["chi_square"].get<double>(), simulated["chi_square"].get<double>(), 1e-3);

  // Variances a hundred times as large, correlations kept: a hundredth of the chi-square.
  std::string wider;
  for (std::size_t at = 0; at < csv.size();) {
    std::size_t line_end = csv.find('\n', at);
    std::string line = csv.substr(at, line_end - at);
    at = line_end + 1;
    if (!wider.empty()) {
      std::size_t field = line.rfind(',');
      const std::string time = line.substr(field);
      line.resize(field);
      for (int k = 0; k < 6; ++k) field = line.rfind(',', field - 1);
      std::string scaled;
      for (std::size_t from = field; from != std::string::npos; from = line.find(',', from + 1)) {
        scaled += "," + std::to_string(100 * std::stod(line.substr(from + 1)));
      }
      line = line.substr(0, field) + scaled + time;
    }
    wider += line + "\n";
  }
  folder.write("readings.csv", wider);
  EXPECT_NEAR(run_json()["chi_square"].get<double>(), 0.01 * simulated["chi_square"].get<double>(),
              1e-4 * simulated["chi_square"].get<double>());
  EXPECT_LT(simulated["chi_square"].get<double>(), 1.3 * simulated["degrees_of_freedom"].get<double>());
}

TEST_F(Studies, ThirtyPercentGrossOutliersCostNoMoreThanTwiceTheCleanError) {
  write_study();
  const double clean = run_json()["held_out"]["position_after_um"]["mean"];
  for (const char* loss : {"tukey", "cauchy"}) {
    write_study({{"[[setup]]", "[simulate.outliers]\nfraction = 0.3\nsize_um = 3000\n[[setup]]"},
                 {"[identify]", "[identify]\nloss = \"" + std::string(loss) + "\""}});
    const nlohmann::json summary = run_json();
    EXPECT_EQ(summary["status"], "converged");
    EXPECT_LT(summary["held_out"]["position_after_um"]["mean"], 2 * clean) << loss;
    EXPECT_GT(summary["outliers"], 90) << loss;
  }
  // Least squares must fail here, else the test shows nothing; its result is not to be trusted.
  write_study({{"[[setup]]", "[simulate.outliers]\nfraction = 0.3\nsize_um = 3000\n[[setup]]"}});
  EXPECT_GT(run_json(ExitCode::computation_says_no)["held_out"]["position_after_um"]["mean"], 5 * clean);
}

TEST_F(Studies, FewerReadingsThanParametersAreSaid) {
  write_study({{"points = 150", "points = 7"}});
  const CommandResult result = abbe({"run", "s.study.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("No result"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out" / "errors.toml"));
}

TEST_F(Studies, AllReadingsAtOnePoseAreSaid) {
  write_study();
  ASSERT_EQ(abbe({"simulate", "s.study.toml", "-o", "readings"}).exit_code, ExitCode::done);
  const std::string csv = folder.read("readings/tracker.csv");
  const std::size_t header = csv.find("measured_x_mm"), first = csv.find('\n', header) + 1;
  const std::string row = csv.substr(first, csv.find('\n', first) + 1 - first);
  std::string one_pose = csv.substr(0, first);
  for (int i = 0; i < 300; ++i) one_pose += row;
  write_measured_study(one_pose);
  const CommandResult result = abbe({"run", "s.study.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no) << result.err;
  EXPECT_THAT(result.out, HasSubstr("does not move in any reading"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out" / "errors.toml"));
}

TEST_F(Studies, ASwappedReflectorIsNamed) {
  write_study();
  ASSERT_EQ(abbe({"simulate", "s.study.toml", "-o", "readings"}).exit_code, ExitCode::done);
  // Readings 12 to 20 of reflector R1 are entered as R2 and the other way round.
  std::string csv = folder.read("readings/tracker.csv"), swapped;
  std::size_t line = 0, start = 0;
  while (start < csv.size()) {
    const std::size_t end = csv.find('\n', start);
    std::string row = csv.substr(start, end - start);
    if (row.empty() || row[0] == '#') {
    } else if (line++ >= 13 && line <= 22) {
      if (row.find("R1") != std::string::npos) {
        row = std::regex_replace(row, std::regex("R1"), "R2");
      } else {
        row = std::regex_replace(row, std::regex("R2"), "R1");
      }
    }
    swapped += row + "\n";
    start = end + 1;
  }
  write_measured_study(swapped, "ignore = [\"offset_x_mm\", \"offset_y_mm\", \"offset_z_mm\"]\n");
  const CommandResult result = abbe({"run", "s.study.toml"});
  EXPECT_THAT(result.out, HasSubstr("fits better than")) << result.err;
}

TEST_F(Studies, MapOfAnErrorsFileSaysWhatLiesOutsideItsRange) {
  write_study();
  ASSERT_EQ(abbe({"run", "s.study.toml"}).exit_code, ExitCode::done);
  const CommandResult inside = abbe({"map", "--machine", "m.machine.toml", "--errors", "out/errors.toml", "--grid",
                                     "X_mm=100:1300:5", "-o", "map.csv", "-o", "map.vts"});
  EXPECT_EQ(inside.exit_code, ExitCode::done) << inside.err;
  EXPECT_THAT(inside.out, HasSubstr("standard uncertainty"));
  const CommandResult outside =
      abbe({"map", "--machine", "m.machine.toml", "--errors", "out/errors.toml", "--grid", "X_mm=0:2000:5"});
  EXPECT_EQ(outside.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(outside.err, HasSubstr("outside the range"));
  const CommandResult wrong =
      abbe({"map", "--machine", "m.machine.toml", "--errors", "out/errors.toml", "--grid", "X_deg=0:2000:5"});
  EXPECT_EQ(wrong.exit_code, ExitCode::bad_input);
  EXPECT_THAT(wrong.err, HasSubstr("unit 'deg' for a linear axis"));
}

TEST_F(Studies, AMapWithoutKnownPosesStatesNoFigures) {
  write_study();
  ASSERT_EQ(abbe({"run", "s.study.toml", "--accept-uncovered"}).exit_code, ExitCode::done);
  const std::string machine = std::regex_replace(folder.read("m.machine.toml"), std::regex("1400"), "5000");
  folder.write("m.machine.toml", machine);
  const CommandResult text =
      abbe({"map", "--machine", "m.machine.toml", "--errors", "out/errors.toml", "--grid", "X_mm=3000:4000:5"});
  EXPECT_EQ(text.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(text.out, HasSubstr("0 poses"));
  EXPECT_THAT(text.out, Not(HasSubstr("mean")));
  const CommandResult program =
      abbe({"map", "--machine", "m.machine.toml", "--errors", "out/errors.toml", "--grid", "X_mm=3000", "--json"});
  const nlohmann::json json = nlohmann::json::parse(program.out);
  EXPECT_EQ(json["poses"], 0);
  EXPECT_GT(json["outside_range"], 0);
  EXPECT_FALSE(json.contains("predicted_volumetric_error"));
}

TEST_F(Studies, AMapAfterCorrectionKeepsToWhereTheCorrectionIsKnown) {
  write_study({{"axis.X = {}", "axis.X = { range_mm = [100, 1300] }"}});
  ASSERT_EQ(abbe({"run", "s.study.toml"}).exit_code, ExitCode::done);
  const std::vector<std::string> arguments = {
      "map", "--machine", "m.machine.toml", "--errors", "out/truth.errors.toml", "--minus", "out/errors.toml"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), arguments.begin(), arguments.end());
    return abbe(more);
  };
  // The truth is known over the whole travel, the correction only where it was measured: 0 and 1400 mm are outside.
  const CommandResult text = with({"--grid", "X_mm=0:1400:5", "--grid", "Z_mm=100:500:3", "-o", "map.csv"});
  EXPECT_EQ(text.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(text.out, HasSubstr("orientation error, after"));
  const nlohmann::json json =
      nlohmann::json::parse(with({"--grid", "X_mm=0:1400:5", "--grid", "Z_mm=100:500:3", "--json"}).out);
  EXPECT_EQ(2 * json["poses"].get<int>(), 3 * json["outside_range"].get<int>());
  const nlohmann::json& truth = json["true_volumetric_error"];
  EXPECT_LT(truth["after_um"]["mean"], 0.1 * truth["before_um"]["mean"].get<double>());
  EXPECT_LT(json["orientation_after_urad"]["p99"], json["orientation_before_urad"]["p99"]);
  const std::string csv = folder.read("map.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + json["poses"].get<int>());
}

TEST_F(Studies, AnAxisOfAMapIsGivenOnce) {
  write_study();
  ASSERT_EQ(abbe({"run", "s.study.toml"}).exit_code, ExitCode::done);
  const CommandResult twice = abbe({"map", "--machine", "m.machine.toml", "--errors", "out/errors.toml", "--grid",
                                    "X_mm=100:200:3", "--grid", "X_mm=300"});
  EXPECT_EQ(twice.exit_code, ExitCode::bad_input);
  EXPECT_THAT(twice.err, HasSubstr("axis X was given before"));
  folder.write("poses.csv", "X_mm,Z_mm,C_deg\n100,100,10\n");
  const CommandResult both = abbe({"map", "--machine", "m.machine.toml", "--errors", "out/errors.toml", "--grid",
                                   "X_mm=300", "--poses", "poses.csv"});
  EXPECT_EQ(both.exit_code, ExitCode::bad_input);
}

TEST_F(Studies, NewMachinesAreValidAndExistingFilesAreKept) {
  ASSERT_EQ(abbe({"new", "w C' A' Y' b X Z t", "-o", "mill.machine.toml"}).exit_code, ExitCode::done);
  const CommandResult check = abbe({"check", "--machine", "mill.machine.toml"});
  EXPECT_EQ(check.exit_code, ExitCode::done) << check.err;
  EXPECT_THAT(check.out, HasSubstr("EXC"));
  const CommandResult again = abbe({"new", "w X' b t", "-o", "mill.machine.toml"});
  EXPECT_EQ(again.exit_code, ExitCode::bad_input);
  EXPECT_THAT(again.err, HasSubstr("exists"));
}

}  // namespace
}  // namespace abbe
