#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/time_blocks.h"
#include "abbe/study/compensation/errors_map.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kWarmTable = R"(name = "cross table"
chain = "w X' Y' b Z t"
[axis.X]
travel_mm = [0, 600]
[axis.Y]
travel_mm = [0, 400]
[axis.Z]
travel_mm = [0, 300]
[state.ambient]
kind = "measured"
unit = "degC"
[state.column]
kind = "measured"
unit = "degC"
[state.coolant]
kind = "measured"
unit = "degC"
)";

const char* const kWarmErrors = R"([[motion]]
name = "EXX"
basis = "legendre"
order = 2
coefficients_um = [0, 9, -4]
[[motion]]
name = "EXX"
state = "ambient"
basis = "legendre"
order = 1
coefficients_um = [0, 3]
[[location]]
name = "EC0Y"
value_urad = 30
[[location]]
name = "EC0Y"
state = "column"
value_urad = 7
)";

/// Temperatures over eight hours: two that drive errors, one that drives none; slowly varying, as temperatures are.
std::filesystem::path warm_folder(const char* name) {
  const std::filesystem::path folder = test::empty_folder(name);
  std::ofstream(folder / "warm.machine.toml") << kWarmTable;
  std::ofstream(folder / "truth.errors.toml") << kWarmErrors;
  std::ofstream poses(folder / "poses.csv");
  poses << "time_s,X_mm,Y_mm,Z_mm,ambient_degC,column_degC,coolant_degC\n";
  RandomStream random(12);
  for (int k = 0; k < 160; ++k) {
    const double t = k / 20.0, x = k % 53 == 0 ? 0 : k % 53 == 1 ? 600 : random.uniform(0, 600);
    const double z = random.uniform(0, 300), y = random.uniform(0, 400);
    poses << fmt::format("{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", 180 * k, x, y, z, 22 + 3 * std::sin(0.8 * t),
                         21 + 4 * (1 - std::exp(-t / 2)), 20 + 2 * std::sin(1.7 * t + 1));
  }
  return folder;
}

std::string warm_study(const std::string& identify,
                       const std::string& plan = "kind = \"poses\"\nfile = \"poses.csv\"\n") {
  return fmt::format(R"(machine = "warm.machine.toml"
[simulate]
errors = "truth.errors.toml"
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = {{ xyz_um = 2 }}
[[setup.station]]
name = "S1"
true_pose = {{ position_mm = [-700, 300, 200], angles_deg = [2, -3, 40] }}
[[setup.reflector]]
name = "R1"
mounted_on = "workpiece"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
mounted_on = "workpiece"
offset_mm = [250, 60, -40]
[[setup.reflector]]
name = "R3"
mounted_on = "tool"
offset_mm = [-80, 220, 90]
[[setup.plan]]
{}
[identify]
locations = ["EC0Y"]
{}
[[identify.motion]]
errors = "EXX"
basis = "legendre"
order = 2
)",
                     plan, identify);
}

const char* const kCandidates = R"([[identify.motion]]
errors = ["EXX", "EYX", "EYY", "EXY", "EZZ", "EBZ"]
state = "ambient"
optional = true
basis = "legendre"
orders = [1, 3]
[[identify.motion]]
errors = ["EXX", "EYX", "EYY", "EXY", "EZZ", "EBZ"]
state = "column"
optional = true
basis = "legendre"
orders = [1, 3]
[[identify.motion]]
errors = ["EXX", "EYX", "EYY", "EXY", "EZZ", "EBZ"]
state = "coolant"
optional = true
basis = "legendre"
orders = [1, 3]
[[identify.location]]
errors = ["EC0Y"]
state = "ambient"
optional = true
[[identify.location]]
errors = ["EC0Y"]
state = "column"
optional = true
[[identify.location]]
errors = ["EC0Y"]
state = "coolant"
optional = true
)";

Study warm(const std::filesystem::path& folder, const std::string& text, std::uint64_t seed = 1) {
  const std::filesystem::path file = folder / "warm.study.toml";
  std::ofstream(file) << text;
  Study study = read_study(file);
  study.seed = seed;
  return study;
}

TEST(StateTerms, TheOnesThatDriveErrorsAreTaken) {
  const std::filesystem::path folder = warm_folder("state_terms");
  Study study = warm(folder, warm_study(kCandidates));
  std::size_t false_terms = 0;
  for (std::uint64_t draw = 0; draw < 20; ++draw) {
    study.seed = 40 + draw;
    StudyResult result;
    result.campaign = gather_readings(study);
    prepare_study(study, result);
    ASSERT_TRUE(result.terms && result.terms->selection.done);
    ASSERT_EQ(result.terms->candidates.size(), 21U);
    std::multiset<std::string> taken;
    for (const TakenTerm& one : result.terms->selection.taken) taken.insert(result.terms->candidates[one.candidate]);
    // A slope of the straightness EXY with the temperature is the same as a squareness with it.
    const std::size_t squareness = taken.count("EC0Y*column") + taken.count("EXY*column");
    EXPECT_TRUE(taken.contains("EXX*ambient")) << draw << ": " << testing::PrintToString(taken);
    EXPECT_GE(squareness, 1U) << draw << ": " << testing::PrintToString(taken);
    false_terms += taken.size() - taken.count("EXX*ambient") - squareness;
    EXPECT_LT(result.terms->selection.last_rms, 0.8 * result.terms->selection.first_rms);
    EXPECT_LT(result.terms->selection.levels.front(), 3U);  // EXX*ambient is of order 1
  }
  RecordProperty("terms_without_effect_taken_in_20_draws", static_cast<int>(false_terms));
  // 19 candidates without effect in each of 20 studies, at 5 % in all of one study.
  EXPECT_LE(false_terms, 4U);
}

/// Effects of a few standard uncertainties: docs/identification.md has the counts for other sizes.
TEST(StateTerms, AnEffectOfSevenStandardUncertaintiesIsFound) {
  const std::filesystem::path folder = warm_folder("state_terms_weak");
  std::string truth = kWarmErrors;
  truth.replace(truth.find("value_urad = 7"), 14, "value_urad = 4");
  std::ofstream(folder / "truth.errors.toml") << truth;
  const std::string right =
      "[[identify.motion]]\nerrors = \"EXX\"\nstate = \"ambient\"\nbasis = \"legendre\"\norder = 1\n"
      "[[identify.location]]\nerrors = [\"EC0Y\"]\nstate = \"column\"\n";
  StudyResult known;
  const Study with_right_terms = warm(folder, warm_study("held_out_fraction = 0\n" + right));
  known.campaign = gather_readings(with_right_terms);
  prepare_study(with_right_terms, known);
  const Identification found = identify(known.model.problem, identify_options(with_right_terms));
  double uncertainty = 0;
  for (std::size_t p = 0; p < found.parameters.size(); ++p) {
    if (found.parameters[p].name == "EC0Y*column")
      uncertainty = found.standard_uncertainties[static_cast<Eigen::Index>(p)];
  }
  EXPECT_NEAR(4e-6 / uncertainty, 6.9, 0.1);
  Study study = warm(folder, warm_study(std::string("held_out_fraction = 0\n") + kCandidates));
  int taken = 0;
  for (std::uint64_t draw = 0; draw < 10; ++draw) {
    study.seed = 40 + draw;
    StudyResult result;
    result.campaign = gather_readings(study);
    prepare_study(study, result);
    for (const TakenTerm& one : result.terms->selection.taken) {
      const std::string& name = result.terms->candidates[one.candidate];
      taken += name == "EC0Y*column" || name == "EXY*column" ? 1 : 0;
    }
  }
  EXPECT_GE(taken, 9);
}

TEST(StateTerms, AreReportedAndTheOthersAreNoErrorsOfTheMachine) {
  const std::filesystem::path folder = warm_folder("state_terms_report");
  const Study study = warm(folder, warm_study(std::string("time_blocks = 16\ntime_gap_min = 6\n") + kCandidates), 41);
  const StudyResult result = run_study(study);
  ASSERT_TRUE(result.usable()) << result.identification.message;
  const std::string text = study_text(study, result, nullptr);
  EXPECT_THAT(text, HasSubstr("terms with states chosen by 16 held-out blocks of time"));
  EXPECT_THAT(text, HasSubstr("with EXX*ambient"));
  EXPECT_THAT(errors_text(study.machine, identified_errors_file(study, result)), Not(HasSubstr("name = \"EZZ\"")));
  const nlohmann::ordered_json json = study_summary(study, result);
  EXPECT_EQ(json["terms_with_states"]["blocks_of_time"], 16);
  EXPECT_LT(json["terms_with_states"]["held_out_rms"].get<double>(), 1.2);
  EXPECT_GT(json["terms_with_states"]["held_out_rms_without"].get<double>(), 1.3);
}

/// The held-out error of the chosen model, every block predicted by an identification of its own.
TEST(StateTerms, HeldOutErrorsAreThoseOfIdentificationsWithoutTheirBlocks) {
  const std::filesystem::path folder = warm_folder("state_terms_refitted");
  const Study study =
      warm(folder, warm_study(std::string("held_out_fraction = 0\ntime_gap_min = 10\n") + kCandidates), 44);
  StudyResult result;
  result.campaign = gather_readings(study);
  prepare_study(study, result);
  const std::vector<TimeBlocks> blocks = divide_by_time({result.campaign.setups[0].readings.time_s}, 20, 600);
  Problem& problem = result.model.problem;
  double mean = 0;
  for (std::size_t b = 0; b < 20; ++b) {
    Problem training = problem;
    std::vector<std::uint8_t>& use = training.observations[0].use;
    use.clear();
    for (std::size_t k = 0; k < blocks[0].block.size(); ++k) {
      use.push_back(blocks[0].block[k] != b && blocks[0].near[k * 20 + b] == 0 ? 1 : 0);
    }
    EXPECT_GE(std::count(use.begin(), use.end(), 0), 24 + 9);
    const Identification found = identify(training);
    ASSERT_EQ(found.status, IdentifyStatus::converged);
    const std::vector<double> residuals = residuals_by_reading(*training.observations[0].observations);
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < use.size(); ++k) {
      if (blocks[0].block[k] != b) continue;
      for (std::size_t row = 0; row < 3; ++row) sum += residuals[3 * k + row] * residuals[3 * k + row], count += 1;
    }
    mean += sum / count / 20;
  }
  EXPECT_NEAR(result.terms->selection.last_rms / std::sqrt(mean), 1, 1e-4);
}

/// A term that the model lacks makes neighbours in time alike: held-out readings are whole blocks.
TEST(StateTerms, HeldOutReadingsAreBlocksOfTime) {
  const std::filesystem::path folder = warm_folder("state_held_out");
  const std::string term =
      "[[identify.motion]]\nerrors = \"EXX\"\nstate = \"ambient\"\nbasis = \"legendre\"\norder = 1\n";
  Study study = warm(folder, warm_study("held_out_fraction = 0.15\n" + term));
  StudyResult result;
  result.campaign = gather_readings(study);
  prepare_study(study, result);
  const std::vector<std::uint8_t>& use = result.model.problem.observations[0].use;
  std::size_t out = 0, edges = 0;
  for (std::size_t k = 0; k < use.size(); ++k) {
    out += use[k] == 0 ? 1U : 0U;
    edges += k > 0 && use[k] != use[k - 1] ? 1U : 0U;
  }
  EXPECT_EQ(out, 72U);  // 3 of 20 blocks of 24 readings
  EXPECT_LE(edges, 6U);
  EXPECT_NE(use.front(), 0);
  EXPECT_NE(use.back(), 0);
}

/// Two campaigns, each at one temperature. @param which  "", or the one that is left out
std::string two_campaigns(const std::string& left_out) {
  const char* const setup = R"([[setup]]
name = "{0}"
instrument = "tracker"
mounted_on = "bed"
noise = {{ xyz_um = 2 }}
channels = ["{0}.csv"]
[[setup.station]]
name = "{0} station"
true_pose = {{ position_mm = [{1}, 300, 200], angles_deg = [2, -3, 40] }}
[[setup.reflector]]
name = "R1"
mounted_on = "workpiece"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
mounted_on = "workpiece"
offset_mm = [250, 60, -40]
[[setup.reflector]]
name = "R3"
mounted_on = "tool"
offset_mm = [-80, 220, 90]
[[setup.plan]]
kind = "poses"
file = "{0}_poses.csv"
)";
  std::string text = "machine = \"warm.machine.toml\"\n[simulate]\nerrors = \"truth.errors.toml\"\n";
  if (left_out != "cold") text += fmt::format(fmt::runtime(setup), "cold", -700);
  if (left_out != "warm") text += fmt::format(fmt::runtime(setup), "warm", -650);
  return text + R"([identify]
locations = ["EC0Y"]
held_out_fraction = 0
[[identify.motion]]
errors = "EXX"
basis = "legendre"
order = 2
[[identify.motion]]
errors = "EXX"
state = "ambient"
basis = "legendre"
order = 1
[[identify.location]]
errors = ["EC0Y"]
state = "column"
)";
}

TEST(StateTerms, CampaignsAtDifferentTemperaturesTogetherFindGrowthThatNeitherFindsAlone) {
  const std::filesystem::path folder = warm_folder("two_temperatures");
  for (const auto& [name, temperature] : {std::pair("cold", 18.0), std::pair("warm", 27.5)}) {
    std::ofstream(folder / (std::string(name) + ".csv"))
        << fmt::format("time_s,ambient_degC,column_degC\n0,{0},{1}\n9000,{0},{1}\n", temperature, temperature - 0.5);
    std::ofstream poses(folder / (std::string(name) + "_poses.csv"));
    poses << "time_s,X_mm,Y_mm,Z_mm\n";
    RandomStream random(4);
    for (int k = 0; k < 60; ++k) {
      const double z = random.uniform(0, 300), y = random.uniform(0, 400);
      const double x = k == 0 ? 0 : k == 1 ? 600 : random.uniform(0, 600);
      poses << fmt::format("{},{:.3f},{:.3f},{:.3f}\n", 120 * k, x, y, z);
    }
  }
  const auto number = [](const Identification& found, const std::string& name, bool uncertainty) {
    for (std::size_t p = 0; p < found.parameters.size(); ++p) {
      const auto at = static_cast<Eigen::Index>(p);
      if (found.parameters[p].name == name) return uncertainty ? found.standard_uncertainties[at] : found.estimates[at];
    }
    ADD_FAILURE() << name;
    return 0.0;
  };
  for (const char* left_out : {"cold", "warm"}) {
    const Study alone = warm(folder, two_campaigns(left_out), 5);
    const StudyResult result = run_study(alone);
    EXPECT_THAT(result.warnings,
                testing::Contains(HasSubstr("at all readings: errors with this state cannot be told")));
    EXPECT_THAT(study_text(alone, result, nullptr), HasSubstr("EC0Y, EC0Y*column"));
    EXPECT_GT(result.identification.gauge.constraints.size(), 0U);
  }
  const Study joint = warm(folder, two_campaigns(""), 5);
  const StudyResult result = run_study(joint);
  ASSERT_TRUE(result.usable()) << result.identification.message;
  const Identification& found = result.identification;
  const double u = number(found, "EXX*ambient[P1]", true);
  EXPECT_GT(u, 0);
  EXPECT_LT(u, 0.2e-3);
  EXPECT_NEAR(number(found, "EXX*ambient[P1]", false), 3e-3, 4 * u);
  EXPECT_NEAR(number(found, "EC0Y*column", false), 7e-6, 4 * number(found, "EC0Y*column", true));
  EXPECT_NEAR(number(found, "EXX[P1]", false), 9e-3, 4 * number(found, "EXX[P1]", true));
}

TEST(StateTerms, ErrorsSayWhichStatesTheyWereMeasuredAtAndUsersSayWhereTheyExtrapolate) {
  const std::filesystem::path folder = warm_folder("covered_states");
  const std::string terms = R"([[identify.motion]]
errors = "EXX"
state = "ambient"
basis = "legendre"
order = 1
[identify.ageing]
um_per_sqrt_day = 2
urad_per_sqrt_day = 1
)";
  Study study = warm(folder, warm_study(terms));
  study.output = folder / "results";
  const StudyResult result = run_study(study);
  write_results(study, result);
  const Machine& machine = study.machine;
  const ErrorsFile written = read_errors(study.output / "errors.toml", machine, StatesOfErrors::allowed);
  ASSERT_EQ(written.covered.size(), 1U);
  EXPECT_EQ(written.covered[0].column, "ambient_degC");
  EXPECT_NEAR(written.covered[0].from, 19, 0.05);
  EXPECT_NEAR(written.covered[0].to, 25, 0.05);
  EXPECT_NEAR(written.covered_time_s, 159 * 180, 1e-6);
  const auto map_at = [&](const std::vector<std::string>& states) {
    ErrorsMapRequest request;
    request.machine = machine;
    request.errors = read_errors_at(study.output / "errors.toml", machine, states);
    return map_errors(request);
  };
  const ErrorsMap near = map_at({"ambient_degC=24"}), far = map_at({"ambient_degC=35"});
  EXPECT_TRUE(near.left_out().extrapolated.empty());
  ASSERT_EQ(far.left_out().extrapolated.size(), 1U);
  EXPECT_THAT(errors_map_text(far), HasSubstr("warning: ambient_degC = 35 lies outside the 19"));
  EXPECT_EQ(errors_map_json(far)["states_outside_measured"].size(), 1U);
  EXPECT_FALSE(errors_map_json(near).contains("states_outside_measured"));
  const auto largest = [](const ErrorsMap& map) {
    return *std::max_element(map.before.norm_uncertainty.begin(), map.before.norm_uncertainty.end());
  };
  EXPECT_GT(largest(far), 2 * largest(near));
  // Ageing: 2 um after a day for every coefficient, 6 um after nine days.
  const ErrorsMap aged = map_at({"ambient_degC=24", "days_since_measurement=9"});
  EXPECT_GT(largest(aged), 3e-3);
  EXPECT_THAT(errors_map_text(aged), HasSubstr("days_since_measurement = 9"));
  EXPECT_THAT(message_of([&] {
                map_at({"ambient_degC=24", "days_since_measurement=-1"});
              }),
              HasSubstr("number of days"));
  EXPECT_THAT(message_of([&] {
                read_errors_at(folder / "truth.errors.toml", machine,
                               {"ambient_degC=24", "column_degC=22", "days_since_measurement=1"});
              }),
              HasSubstr("[ageing]"));
}

TEST(StateTerms, RefusesChoicesThatCannotBeMade) {
  const std::filesystem::path folder = warm_folder("state_terms_refused");
  const auto said = [&](const std::string& identify) {
    return message_of([&] { warm(folder, warm_study(identify)); });
  };
  EXPECT_THAT(said("time_blocks = 10\n"), HasSubstr("no term with a state is chosen"));
  EXPECT_THAT(said("loss = \"huber\"\n" + std::string(kCandidates)), HasSubstr("least squares"));
  EXPECT_THAT(said("[[identify.motion]]\nerrors = \"EYX\"\noptional = true\nbasis = \"legendre\"\norder = 1\n"),
              HasSubstr("without a state"));
}

}  // namespace
}  // namespace abbe
