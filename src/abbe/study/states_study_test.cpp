#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/study/customer/customer_study.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/run_study.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// A slide that carries an arm: its scale grows with the temperature, its lower joint gives way under its own weight.
const char* const kSlideWithArm = R"(name = "arm on a slide"
chain = "w b X C B t"
[axis.X]
travel_mm = [-500, 500]
[axis.C]
travel_deg = [-150, 150]
point_mm = [0, 0, 0]
[axis.B]
travel_deg = [-80, 60]
point_mm = [0, 0, 600]
[tool]
reference_mm = [900, 0, 600]

[state.ambient]
kind = "measured"
unit = "degC"
[state.payload]
kind = "measured"
unit = "kg"
[state.torque]
kind = "gravity"
about = "B"
load = [{ carried_by = "B", mass_kg = 12, point_mm = [400, 0, 600] }]
[state.flange]
kind = "gravity"
about = "B"
load = [{ carried_by = "tool", mass_kg = 1, point_mm = [900, 0, 600] }]
[state.loaded]
kind = "product"
of = ["payload", "flange"]
)";

const char* const kTruth = R"([[motion]]
name = "EXX"
basis = "legendre"
order = 3
coefficients_um = [0, 20, -8, 5]
[[motion]]
name = "EZX"
basis = "legendre"
order = 3
coefficients_um = [0, 0, 12, -4]
[[motion]]
name = "EXX"
state = "ambient"
basis = "legendre"
order = 1
coefficients_um = [0.8, 5.75]
[[motion]]
name = "EBB"
state = "torque"
basis = "legendre"
order = 0
coefficients_urad = [1.9]
[[motion]]
name = "EBB"
state = "loaded"
basis = "legendre"
order = 0
coefficients_urad = [2.2]
[[location]]
name = "EB0C"
value_urad = 40
[[location]]
name = "EB0C"
state = "ambient"
value_urad = -3
)";

const char* const kStudyOfArm = R"(name = "arm"
machine = "arm.machine.toml"
seed = 5
{simulate}
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = {{ xyz_um = 3 }}
{data}
[[setup.station]]
name = "station"
pose = "find"
{true_pose}
[[setup.reflector]]
name = "R1"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
offset_mm = [40, 120, -60]
[[setup.reflector]]
name = "R3"
offset_mm = [-50, -80, 90]
{plan}
[identify]
locations = ["EB0C"]
held_out_fraction = 0.05
[[identify.motion]]
errors = ["EXX", "EZX"]
basis = "legendre"
order = 3
[[identify.motion]]
errors = "EXX"
state = "ambient"
basis = "legendre"
order = 1
[[identify.motion]]
errors = "EBB"
state = "torque"
basis = "legendre"
order = 0
[[identify.motion]]
errors = "EBB"
state = "loaded"
basis = "legendre"
order = 0
[[identify.location]]
errors = "EB0C"
state = "ambient"
)";

/// A folder with the machine, its true errors and poses at which the states change from one to the next.
std::filesystem::path arm_folder(const char* name) {
  const std::filesystem::path folder = test::empty_folder(name);
  std::ofstream(folder / "arm.machine.toml") << kSlideWithArm;
  std::ofstream(folder / "truth.errors.toml") << kTruth;
  std::ofstream poses(folder / "poses.csv");
  poses << "X_mm,C_deg,B_deg,ambient_degC,payload_kg\n";
  RandomStream random(3);
  for (int k = 0; k < 240; ++k) {
    poses << fmt::format("{:.3f},{:.3f},{:.3f},{:.3f},{}\n", random.uniform(-500, 500), random.uniform(-150, 150),
                         random.uniform(-80, 60), 18 + 9.0 * k / 239, k % 3 == 0 ? 0 : 4.5);
  }
  return folder;
}

std::string study_of_arm(bool simulated) {
  return fmt::format(
      fmt::runtime(kStudyOfArm), fmt::arg("simulate", simulated ? "[simulate]\nerrors = \"truth.errors.toml\"" : ""),
      fmt::arg("data", simulated ? "" : "[[setup.data]]\nfile = \"readings.csv\""),
      fmt::arg("true_pose",
               simulated ? "true_pose = { position_mm = [1500, -2200, 300], angles_deg = [0.4, -0.8, 70] }" : ""),
      fmt::arg("plan", simulated ? "[[setup.plan]]\nkind = \"poses\"\nfile = \"poses.csv\"" : ""));
}

Study study_in(const std::filesystem::path& folder, bool simulated) {
  const std::filesystem::path file = folder / "arm.study.toml";
  std::ofstream(file) << study_of_arm(simulated);
  return read_study(file);
}

/// Every coefficient that depends on a state, against the truth.
void expect_states_recovered(const Study& study, const StudyResult& result, const ErrorSet& truth) {
  ASSERT_TRUE(result.usable()) << result.identification.message;
  const std::vector<std::string> names = parameter_names(study.machine, truth);
  const std::vector<double> real = truth.parameters();
  std::size_t compared = 0;
  for (std::size_t i = 0; i < result.identification.parameters.size(); ++i) {
    const std::string& name = result.identification.parameters[i].name;
    if (name.find('*') == std::string::npos) continue;
    const auto at = std::find(names.begin(), names.end(), name);
    ASSERT_NE(at, names.end()) << name;
    const auto index = static_cast<Eigen::Index>(i);
    const double u = result.identification.standard_uncertainties[index];
    const double expected = real[static_cast<std::size_t>(at - names.begin())];
    EXPECT_GT(u, 0) << name;
    EXPECT_LT(u, 0.25 * std::abs(expected)) << name << " is hardly determined";
    EXPECT_NEAR(result.identification.estimates[index], expected, 3.5 * u) << name;
    ++compared;
  }
  EXPECT_EQ(compared, 5U);
}

TEST(StatesStudy, RecoversThermalGrowthAndComplianceFromSimulatedReadings) {
  const std::filesystem::path folder = arm_folder("states_simulated");
  const Study study = study_in(folder, true);
  const StudyResult result = run_study(study);
  expect_states_recovered(study, result, *result.campaign.truth);
  EXPECT_NEAR(result.identification.statistics.variance_factor, 1, 0.2);
  EXPECT_THAT(result.warnings, testing::Contains(HasSubstr("ambient 20 degC, payload 0 kg")));
  ASSERT_TRUE(result.map && result.volumetric);
  EXPECT_GT(result.map->predicted.statistics.count, 0U);
  ASSERT_TRUE(result.map->after);
  EXPECT_LT(result.map->after->statistics.rms, 0.2 * result.map->before.statistics.rms);
}

TEST(StatesStudy, IdentifiesTheSameFromAFileWithTheStateColumns) {
  const std::filesystem::path folder = arm_folder("states_file");
  const Study simulated = study_in(folder, true);
  const Campaign campaign = gather_readings(simulated);
  const std::string text = campaign.setups[0].readings_text(simulated.machine);
  EXPECT_THAT(text.substr(0, text.find('\n')), HasSubstr("ambient_degC,payload_kg"));
  std::ofstream(folder / "readings.csv") << text;
  const Study study = study_in(folder, false);
  const StudyResult result = run_study(study);
  const ErrorSet truth = read_errors(folder / "truth.errors.toml", study.machine, StatesOfErrors::allowed).errors;
  expect_states_recovered(study, result, truth);

  const std::filesystem::path errors = folder / "found.errors.toml";
  write_errors(errors, study.machine, identified_errors_file(study, result));
  const ErrorsFile again = read_errors(errors, study.machine, StatesOfErrors::allowed);
  EXPECT_EQ(again.errors.motions, result.identification.errors.motions);
  EXPECT_EQ(again.errors.locations, result.identification.errors.locations);
  EXPECT_THAT(message_of([&] { read_errors(errors, study.machine); }),
              HasSubstr("which is not taken into account here"));

  // The column taken away: no result, and what is missing is named.
  std::string without = text;
  without.replace(without.find("ambient_degC"), std::string("ambient_degC").size(), "point");
  std::ofstream(folder / "readings.csv") << without;
  EXPECT_EQ(message_of([&] { run_study(study_in(folder, false)); }),
            "tracker: errors to be identified depend on ambient, which is not given at all readings; expected a column "
            "ambient_degC in the readings");
}

TEST(StatesStudy, LeavesTheStatesOutOnlyAtThePriceOfTheFit) {
  const std::filesystem::path folder = arm_folder("states_left_out");
  Study study = study_in(folder, true);
  std::erase_if(study.identification->motions, [](const IdentifiedMotion& one) { return one.state != kNoState; });
  std::erase_if(study.identification->locations, [](const IdentifiedLocation& one) { return one.state != kNoState; });
  const StudyResult result = run_study(study);
  EXPECT_GT(result.identification.statistics.variance_factor, 20) << "a test that the states are in the readings";
}

TEST(StatesStudy, PosesWithoutTheStatesOfTheTruthAreRefused) {
  const std::filesystem::path folder = arm_folder("states_missing");
  std::ofstream(folder / "poses.csv") << "X_mm,C_deg,B_deg\n0,0,0\n";
  EXPECT_EQ(message_of([&] { gather_readings(study_in(folder, true)); }),
            "tracker: the true errors depend on ambient, which is not given at all poses; expected poses from a file "
            "with a column ambient_degC, or with time_s and channels that have ambient_degC");
}

TEST(StatesStudy, ACustomerReportHoldsAtTheReferences) {
  const std::filesystem::path folder = arm_folder("states_customer");
  Study study = study_in(folder, true);
  study.report.facts.emplace();
  StudyResult result = run_study(study, {.map = false});
  EarlierResult& before = result.before.emplace();
  before.errors = identified_errors_file(study, result);
  result.campaign.truth.reset();  // as if it had been measured
  const CustomerReport report = study_customer_report(study, result);
  // By another route: the error motion at ambient 20 degC and no payload.
  const std::size_t x = study.machine.find_axis("X");
  const std::vector<double> factors =
      state_factors(study.machine, std::vector<double>(3, 0.0), std::vector<double>{20, 0, 0, 0, 0});
  double low = 1, high = -1;
  for (int i = 0; i <= 120; ++i) {
    const double value = result.identification.errors.evaluate(x, -500 + 1000.0 * i / 120, factors)[0];
    low = std::min(low, value), high = std::max(high, value);
  }
  std::size_t exx = 0;
  for (const CustomerFigure& figure : report.figures) {
    EXPECT_EQ(figure.symbol.find('*'), std::string::npos);
    if (figure.symbol == "V_max") EXPECT_GT(*figure.states[1].expanded_uncertainty, 0);
    if (figure.symbol != "EXX") continue;
    ++exx;
    EXPECT_NEAR(*figure.states[1].value, 1e3 * (high - low), 1e-9);
    EXPECT_NEAR(*figure.states[0].value, *figure.states[1].value, 1e-9);
  }
  EXPECT_EQ(exx, 1U);
  EXPECT_THAT(report.notes, testing::Contains("The figures hold at the state ambient_degC = 20, payload_kg = 0."));
  EXPECT_EQ(report.states[1].no_verdict, "");
  before.errors.covered[0].from = 21;
  EXPECT_THAT(study_customer_report(study, result).states[0].no_verdict,
              HasSubstr("Outside the states that the readings cover: ambient_degC = 20"));
}

}  // namespace
}  // namespace abbe
