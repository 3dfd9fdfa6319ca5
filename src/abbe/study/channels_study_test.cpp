// Growth with temperatures that were recorded beside the readings, at times of their own.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_check.h"

namespace abbe {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const char* const kWarmSlide = R"(name = "column on a slide"
chain = "w b X Z t"
[axis.X]
travel_mm = [0, 1000]
[axis.Z]
travel_mm = [0, 600]
[tool]
reference_mm = [0, 250, 200]
[state.hall]
kind = "measured"
unit = "degC"
[state.motor]
kind = "measured"
unit = "degC"
[state.column]
kind = "lag"
of = "motor"
time_constant_min = 50
)";

/// 11.5 um/m per K of the hall; the column grows and leans with its lagged temperature.
const char* const kGrowth = R"([[motion]]
name = "EXX"
basis = "legendre"
order = 2
coefficients_um = [0, 6, -4]
[[motion]]
name = "EXX"
state = "hall"
basis = "legendre"
order = 1
coefficients_um = [0.6, 5.75]
[[motion]]
name = "EZZ"
state = "column"
basis = "legendre"
order = 1
coefficients_um = [2.1, 3.4]
[[motion]]
name = "EBZ"
state = "column"
basis = "legendre"
order = 0
coefficients_urad = [4.5]
)";

const char* const kStudyOfDay = R"(name = "day"
machine = "slide.machine.toml"
seed = 11
{top}
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = {{ xyz_um = 2 }}
{in_setup}
[[setup.station]]
name = "station"
pose = "find"
{true_pose}
[[setup.reflector]]
name = "R1"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
offset_mm = [120, 40, -60]
[[setup.reflector]]
name = "R3"
offset_mm = [-80, -50, 90]
{readings}
[identify]
held_out_fraction = 0.05
[[identify.motion]]
errors = "EXX"
basis = "legendre"
order = 2
[[identify.motion]]
errors = "EXX"
state = "hall"
basis = "legendre"
order = 1
[[identify.motion]]
errors = "EZZ"
state = "column"
basis = "legendre"
order = 1
[[identify.motion]]
errors = "EBZ"
state = "column"
basis = "legendre"
order = 0
)";

constexpr double kHour = 3600, kTau = 50 * 60;

double hall_at(double time) { return 21 + 2.5 * std::sin(2 * std::numbers::pi * (time / kHour - 3) / 24); }

/// Three hours of work and one of rest, in turn, as a sum of two waves, and what a lag in its steady state makes of it:
/// each wave with its amplitude times cos(phase), late by the phase atan(omega tau).
struct Wave {
  double size, period_h, at_h;
};
constexpr Wave kWork[] = {{6, 4, 0.5}, {2.5, 24, 7}};

double motor_at(double time, bool lagged_value) {
  double value = 28;
  for (const Wave& wave : kWork) {
    const double omega = 2 * std::numbers::pi / (wave.period_h * kHour);
    const double phase = lagged_value ? std::atan(omega * kTau) : 0;
    value += wave.size * std::cos(phase) * std::sin(omega * (time - wave.at_h * kHour) - phase);
  }
  return value;
}

/// Readings of a day: poses every three minutes, at each of which one reflector is seen.
std::filesystem::path day_folder(const char* name) {
  const std::filesystem::path folder = test::empty_folder(name);
  std::ofstream(folder / "slide.machine.toml") << kWarmSlide;
  std::ofstream(folder / "truth.errors.toml") << kGrowth;
  RandomStream random(8);
  std::ofstream poses(folder / "poses.csv"), bare(folder / "bare.csv");
  poses << "time_s,X_mm,Z_mm,reflector,hall_degC,motor_degC,column_degC\n";
  bare << "time_h,X_mm,Z_mm,reflector\n";
  for (int k = 0; k < 480; ++k) {
    const double time = 180.0 * k;
    const std::string pose =
        fmt::format("{:.3f},{:.3f},R{}", random.uniform(0, 1000), random.uniform(0, 600), k % 3 + 1);
    poses << fmt::format("{},{},{},{},{}\n", time, pose, hall_at(time), motor_at(time, false), motor_at(time, true));
    bare << fmt::format("{},{}\n", time / kHour, pose);
  }
  // The hall every ten minutes from the first reading on, the motor every 40 s from four hours before.
  std::ofstream hall(folder / "hall.csv"), motor(folder / "motor.csv");
  hall << "time_min,hall_degC\n";
  for (int k = 0; k <= 144; ++k) hall << fmt::format("{},{}\n", 10 * k, hall_at(600.0 * k));
  motor << "# logger 3\ntime_s,T 1,T 2\n";
  for (int k = -360; k <= 2170; ++k) motor << fmt::format("{},{},\n", 40 * k, motor_at(40.0 * k, false));
  return folder;
}

const char* const kMotorFile =
    "[[setup.channel]]\nfile = \"motor.csv\"\nignore = [\"T 2\"]\ncolumns = { motor_degC = \"T 1\" }\n";

/// @param poses  of a simulation; empty: the readings are read
Study day_study(const std::filesystem::path& folder, const std::string& poses, const std::string& top,
                const std::string& in_setup) {
  const bool simulated = !poses.empty();
  const std::string simulate = simulated ? "\n[simulate]\nerrors = \"truth.errors.toml\"" : "";
  const std::filesystem::path file = folder / "day.study.toml";
  std::ofstream(file) << fmt::format(
      fmt::runtime(kStudyOfDay), fmt::arg("top", top + simulate), fmt::arg("in_setup", in_setup),
      fmt::arg("true_pose",
               simulated ? "true_pose = { position_mm = [1500, -2200, 300], angles_deg = [0.4, -0.8, 70] }" : ""),
      fmt::arg("readings", simulated ? "[[setup.plan]]\nkind = \"poses\"\nfile = \"" + poses + "\""
                                     : "[[setup.data]]\nfile = \"readings.csv\""));
  return read_study(file);
}

/// The text without the columns of states, which stand last.
std::string without_states(const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    std::string line = text.substr(at, end - at);
    for (int k = 0; k < 3; ++k) line.erase(line.rfind(','));
    result += line + "\n";
    at = end + 1;
  }
  return result;
}

void expect_growth(const Study& study, const StudyResult& result, const ErrorSet& truth) {
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
    EXPECT_LT(u, 0.2 * std::abs(expected)) << name;
    EXPECT_NEAR(result.identification.estimates[index], expected, 3.5 * u) << name;
    ++compared;
  }
  EXPECT_EQ(compared, 5U);
  EXPECT_NEAR(result.identification.statistics.variance_factor, 1, 0.2);
}

TEST(ChannelsStudy, IdentifiesGrowthFromReadingsWithTimesAndRecordedTemperatures) {
  const std::filesystem::path folder = day_folder("channels_day");
  // The readings come from temperatures in closed form, without any filter.
  const Study simulated = day_study(folder, "poses.csv", "", "");
  const Campaign campaign = gather_readings(simulated);
  EXPECT_EQ(campaign.setups[0].readings.time_s[10], 1800) << "times of poses are those of their readings";
  std::ofstream(folder / "readings.csv") << without_states(campaign.setups[0].readings_text(simulated.machine));

  const Study study = day_study(folder, "", "channels = [\"hall.csv\"]", kMotorFile);
  const StudyResult result = run_study(study);
  expect_growth(study, result, *campaign.truth);
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("equilibrium"))));
  const PoseList& truth = campaign.setups[0].poses();
  const PoseList& found = result.campaign.setups[0].poses();
  for (std::size_t k = 0; k < truth.count(); ++k) {
    EXPECT_NEAR(found.state[0][k], truth.state[0][k], 1e-3) << k;
    EXPECT_NEAR(found.state[1][k], truth.state[1][k], 1e-3) << k;
    // 8 K wide at most, four hours before the first reading: exp(-4.8) of a wrong start.
    EXPECT_NEAR(found.state[2][k], truth.state[2][k],
                8 * std::exp(-(4 * kHour + 180.0 * static_cast<double>(k)) / kTau) + 1e-3)
        << k;
  }
}

TEST(ChannelsStudy, SimulatesWithTheSameChannels) {
  const std::filesystem::path folder = day_folder("channels_simulated");
  const Study study = day_study(folder, "bare.csv", "channels = \"hall.csv\"", kMotorFile);
  const StudyResult result = run_study(study);
  expect_growth(study, result, *result.campaign.truth);
  // With its columns of states the file of readings needs no channels any more.
  std::ofstream(folder / "readings.csv") << result.campaign.setups[0].readings_text(study.machine);
  EXPECT_EQ(message_of([&] { gather_readings(day_study(folder, "", "channels = \"hall.csv\"", "")); }),
            (folder / "readings.csv").string() + ": hall_degC: is given here and in " + (folder / "hall.csv").string() +
                "; expected only one of them");
  const Campaign again = gather_readings(day_study(folder, "", "", ""));
  EXPECT_EQ(again.setups[0].readings.poses.state, result.campaign.setups[0].readings.poses.state);
}

TEST(ChannelsStudy, AStartThatMattersIsAWarningOrIsGiven) {
  const std::filesystem::path folder = day_folder("channels_start");
  std::ofstream motor(folder / "motor.csv");
  motor << "time_s,motor_degC\n";
  for (int k = 0; k <= 2170; ++k) motor << fmt::format("{},{}\n", 40 * k, motor_at(40.0 * k, false));
  motor.close();
  const std::string channels = "channels = [\"hall.csv\", \"motor.csv\"]";
  const Study simulated = day_study(folder, "poses.csv", "", "");
  std::ofstream(folder / "readings.csv") << without_states(
      gather_readings(simulated).setups[0].readings_text(simulated.machine));

  const StudyResult guessed = run_study(day_study(folder, "", "", channels));
  EXPECT_THAT(guessed.warnings, Contains(HasSubstr("tracker: column is taken to be in equilibrium with motor at 0 s")));
  EXPECT_THAT(guessed.warnings, Contains(HasSubstr("at which 100 % of a wrong start remain")));
  const Study told =
      day_study(folder, "", "", channels + fmt::format("\nlag_start.column_degC = {}", motor_at(0, true)));
  const StudyResult known = run_study(told);
  EXPECT_THAT(known.warnings, Not(Contains(HasSubstr("equilibrium"))));
  expect_growth(told, known, read_errors(folder / "truth.errors.toml", told.machine, StatesOfErrors::allowed).errors);
  const PoseList& as_guessed = guessed.campaign.setups[0].poses();
  const PoseList& as_known = known.campaign.setups[0].poses();
  for (std::size_t k = 0; k < as_known.count(); ++k) {
    const double time = 180.0 * static_cast<double>(k), truth = motor_at(time, true);
    EXPECT_NEAR(as_known.state[2][k], truth, 1e-3) << k;
    EXPECT_NEAR(as_guessed.state[2][k] - truth, (motor_at(0, false) - motor_at(0, true)) * std::exp(-time / kTau),
                1e-3);
  }
  EXPECT_GT(std::abs(as_guessed.state[2][0] - motor_at(0, true)), 0.5) << "a test that the start matters";
}

TEST(ChannelsStudy, WhatIsMissingIsSaid) {
  const std::filesystem::path folder = day_folder("channels_missing");
  const auto message = [&](const std::string& poses, const std::string& top, const std::string& in_setup) {
    return message_of([&] { gather_readings(day_study(folder, poses, top, in_setup)); });
  };
  EXPECT_THAT(message("bare.csv", "channels = \"hall.csv\"", ""),
              HasSubstr("the true errors depend on column, which is not given at all poses; expected poses from a file "
                        "with a column column_degC, or with time_s and channels that have column_degC"));
  EXPECT_THAT(message("bare.csv", "channels = \"no.csv\"", ""), HasSubstr("there is no file"));
  EXPECT_THAT(message("bare.csv", "", "[[setup.channel]]\nfile = \"motor.csv\"\nlargest_gap_s = 0\n"),
              HasSubstr("largest_gap_s: is not above zero"));
  EXPECT_THAT(message("bare.csv", "lag_start.hall_degC = 3", ""),
              HasSubstr("lag_start.hall_degC: is not a state of kind \"lag\" with its unit; expected column_degC"));
  EXPECT_THAT(message("bare.csv", "lag_start.column_degC = 3", ""), HasSubstr("is not computed from a channel"));
  EXPECT_THAT(message("poses.csv", "channels = \"hall.csv\"", ""), HasSubstr("hall_degC: is given here and in"));
  std::ofstream(folder / "hall.csv") << "time_h,hall_degC\n0,20\n23,21\n";
  EXPECT_THAT(message("bare.csv", "channels = \"hall.csv\"", kMotorFile),
              HasSubstr("bare.csv:463: time_h: hall is not known at 82980 s: " + (folder / "hall.csv").string() +
                        " covers 0 s to 82800 s"));
  // Times belong to one pass over the poses.
  std::ofstream(folder / "bare.csv") << "time_h,X_mm,Z_mm\n0,0,0\n0.1,500,0\n";
  EXPECT_THAT(message("bare.csv\"\nrepeats = 2\n#", "", ""),
              HasSubstr("bare.csv: time: the poses are gone through 2 times; expected repeats = 1"));
}

}  // namespace
}  // namespace abbe
