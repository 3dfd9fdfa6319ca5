#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/evaluations/evaluation.h"
#include "abbe/study/evaluations/location_cycles.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::size_t> starts_of(const std::vector<double>& times, const CycleChoice& choice,
                                   const std::vector<std::uint8_t>& at_first) {
  double pause = 0;
  return cycle_starts(times, at_first, choice, pause);
}

TEST(CycleStarts, ClearPausesAndStatedLengthsDivideTheTimes) {
  // Four readings, a longer move in the middle of a cycle, a pause of 290 s and a long one.
  const std::vector<double> times = {0, 10, 40, 50, 340, 350, 380, 390, 9000, 9010};
  const std::vector<std::uint8_t> first = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  EXPECT_THAT(starts_of(times, {}, first), ElementsAre(0, 4, 8));
  // Without a pose that comes back there are no cycles, but those that are stated.
  const std::vector<std::uint8_t> once = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_THAT(starts_of(times, {}, once), ElementsAre(0));
  EXPECT_THAT(starts_of(times, {.pause = 20}, once), ElementsAre(0, 2, 4, 6, 8));
  EXPECT_THAT(starts_of(times, {.length = 340}, once), ElementsAre(0, 4, 8));
  EXPECT_THAT(starts_of({0, 10, 20, 31, 40}, {}, {1, 1, 1, 1, 1}), ElementsAre(0));
  EXPECT_THAT(starts_of({0, 0, 0}, {}, {1, 1, 1}), ElementsAre(0));
  EXPECT_THAT(starts_of({0, 0.1, 0.2, 0.30000000000000004}, {.length = 0.1}, {1, 0, 1, 0}), ElementsAre(0, 1, 2, 3));
}

constexpr const char* kMachine = R"(name = "table"
chain = "w C' b X Y Z t"
[axis.C]
endless = true
[axis.X]
travel_mm = [-300, 300]
[axis.Y]
travel_mm = [-300, 300]
[axis.Z]
travel_mm = [0, 400]
[state.warmth]
kind = "measured"
unit = "1"
)";

/// EX0C and EA0C grow by these with a warmth of 1; squareness stays.
constexpr const char* kTruth = R"([[location]]
name = "EX0C"
value_um = 12
[[location]]
name = "EY0C"
value_um = -8
[[location]]
name = "EA0C"
value_urad = 40
[[location]]
name = "EB0C"
value_urad = 25
[[location]]
name = "EX0C"
state = "warmth"
value_um = 20
[[location]]
name = "EA0C"
state = "warmth"
value_urad = 60
)";

constexpr double kTimeConstant = 50 * 60;

double warmth_at(double time) { return 1 - std::exp(-time / kTimeConstant); }

/// 16 positions of the table every 15 min for 4 h, each cycle within a minute.
std::string table_poses(int cycles = 17) {
  std::string text = "time_s,C_deg,X_mm,Y_mm,Z_mm,warmth\n";
  for (int c = 0; c < cycles; ++c) {
    for (int k = 0; k < 16; ++k) {
      const double time = 900 * c + 4 * k, angle = 22.5 * k;
      const double x = 90 * std::cos(angle * kDegree), y = 90 * std::sin(angle * kDegree);
      text += fmt::format("{},{},{:.6f},{:.6f},{},{:.9f}\n", time, angle, x, y, 150 + 20 * (k % 3), warmth_at(time));
    }
  }
  return text;
}

/// A tracker beside the machine sees reflectors on the table and in the spindle.
constexpr const char* kTracker = R"(name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = { xyz_um = 1 }
[[setup.station]]
name = "S1"
true_pose = { position_mm = [-900, 300, 500], angles_deg = [2, -3, 40] }
[[setup.reflector]]
name = "R1"
mounted_on = "workpiece"
offset_mm = [120, 30, 40]
[[setup.reflector]]
name = "R2"
mounted_on = "workpiece"
offset_mm = [-60, 110, 80]
[[setup.reflector]]
name = "R3"
mounted_on = "workpiece"
offset_mm = [-20, -130, 10]
[[setup.reflector]]
name = "R4"
mounted_on = "tool"
offset_mm = [0, 0, 0]
)";

constexpr const char* kLocations = R"(locations = ["EX0C", "EY0C", "EA0C", "EB0C"])";

struct WarmingTest {
  std::filesystem::path folder;
  std::string file;
};

WarmingTest warming_test(const char* name, const std::string& setup, const std::string& identify = kLocations,
                         const std::string& poses = table_poses()) {
  WarmingTest test{test::empty_folder(name), {}};
  std::ofstream(test.folder / "table.machine.toml") << kMachine;
  std::ofstream(test.folder / "truth.errors.toml") << kTruth;
  std::ofstream(test.folder / "poses.csv") << poses;
  test.file = (test.folder / "table.study.toml").string();
  std::ofstream(test.file)
      << "machine = \"table.machine.toml\"\n[simulate]\nerrors = \"truth.errors.toml\"\n[[setup]]\n"
      << setup << "[[setup.plan]]\nkind = \"poses\"\nfile = \"poses.csv\"\n[identify]\n"
      << identify << "\n";
  return test;
}

LocationDistortionTest distortion_test(const std::string& file, std::uint64_t seed = 1) {
  LocationDistortionTest test;
  test.study = read_study(file);
  test.study.seed = seed;
  test.campaign = gather_readings(test.study);
  return test;
}

Evaluation distortion_of(const WarmingTest& warming, std::uint64_t seed = 1) {
  return evaluate_readings({warming.file, distortion_test(warming.file, seed), {}, {}});
}

const WarmingSensor& location_named(const Evaluation& found, const std::string& name) {
  for (const WarmingSensor& one : std::get<LocationDistortion>(found.found).locations) {
    if (one.sensor.series.name == name) return one;
  }
  throw std::out_of_range(name);
}

/// Values of all cycles less the truth, over their standard uncertainty; their mean does not count.
std::vector<double> scaled_deviations(const WarmingSensor& one, double change) {
  const TimeSeries& series = one.sensor.series;
  std::vector<double> deviations;
  double mean = 0;
  for (std::size_t c = 0; c < series.time.size(); ++c) {
    deviations.push_back(series.values[c] - change * warmth_at(series.time[c]));
    mean += deviations.back() / static_cast<double>(series.time.size());
  }
  for (double& deviation : deviations) deviation = (deviation - mean) / one.sensor.reading_uncertainty;
  return deviations;
}

TEST(LocationDistortionByTracker, EveryCycleFindsTheTruthWithinItsUncertainty) {
  const WarmingTest warming = warming_test("abbe_location_tracker", kTracker);
  double sum = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Evaluation found = distortion_of(warming, seed);
    const auto& distortion = std::get<LocationDistortion>(found.found);
    ASSERT_EQ(distortion.cycles.size(), 17U);
    EXPECT_EQ(found.refused, "") << seed;
    for (const auto& [name, change] : {std::pair{"EX0C", 20e-3}, {"EA0C", 60e-6}, {"EY0C", 0.0}, {"EB0C", 0.0}}) {
      for (const double deviation : scaled_deviations(location_named(found, name), change)) {
        sum += deviation * deviation;
        count += 1 - 1 / 17.0;
      }
    }
    const FirstOrderResponse& response = location_named(found, "EX0C").warming;
    ASSERT_EQ(response.status, ResponseStatus::done) << seed;
    EXPECT_NEAR(response.time_constant, kTimeConstant, 4 * response.uncertainty) << seed;
    EXPECT_EQ(location_named(found, "EB0C").warming.status, ResponseStatus::no_change) << seed;
  }
  // The largest of the cycles' uncertainties is stated for all; they are nearly equal.
  EXPECT_NEAR(std::sqrt(sum / count), 1, 0.1);
}

TEST(LocationDistortionByTracker, ACycleOfItsOwnStudyFindsTheSameChanges) {
  const WarmingTest warming = warming_test("abbe_location_cycles", kTracker);
  const LocationDistortionTest test = distortion_test(warming.file);
  const Evaluation found = evaluate_readings({warming.file, test, {}, {}});
  const auto study_of_cycle = [&](std::size_t cycle) {
    StudyResult result;
    result.campaign = test.campaign;
    std::vector<std::size_t> readings;
    const InstrumentReadings& all = test.campaign.setups[0].readings;
    for (std::size_t k = 0; k < all.count(); ++k) {
      if (static_cast<std::size_t>(all.time_s[k] / 900) == cycle) readings.push_back(k);
    }
    result.campaign.setups[0].readings = all.subset(readings);
    Study study = test.study;
    study.identification->held_out_fraction = 0;
    identify_study(study, result);
    return result.identification;
  };
  const Identification first = study_of_cycle(0), last = study_of_cycle(16);
  for (const std::string name : {"EX0C", "EY0C", "EA0C", "EB0C"}) {
    const TimeSeries& series = location_named(found, name).sensor.series;
    const double uncertainty = location_named(found, name).sensor.reading_uncertainty;
    for (std::size_t p = 0; p < first.parameters.size(); ++p) {
      if (first.parameters[p].name != name) continue;
      const auto at = static_cast<Eigen::Index>(p);
      // Nothing but the location errors and the station is identified: the problems are the same.
      EXPECT_NEAR(last.estimates[at] - first.estimates[at], series.values[16] - series.values[0], 1e-3 * uncertainty);
    }
  }
}

TEST(LocationDistortionByTracker, AnotherErrorThatChangesIsNoChangeOfLocationErrors) {
  const WarmingTest warming = warming_test("abbe_location_misfit", kTracker);
  std::ofstream(warming.folder / "truth.errors.toml", std::ios::app) << R"([[motion]]
name = "EXX"
state = "warmth"
basis = "legendre"
order = 1
coefficients_um = [0, 30]
)";
  const Evaluation found = distortion_of(warming);
  EXPECT_THAT(found.refused, HasSubstr("changes of the location errors do not explain the readings"));
  EXPECT_FALSE(found.is_ok());
  EXPECT_GT(std::get<LocationDistortion>(found.found).uncertainty_factor, 1.2);
  EXPECT_THAT(found.report.notes.front(), HasSubstr("Not to be used as it is"));
}

TEST(LocationDistortionByTracker, ACycleThatWasBrokenOffIsLeftOut) {
  std::string poses = table_poses(6);
  poses.resize(poses.rfind('\n', poses.size() - 2) + 1);
  for (int k = 0; k < 10; ++k) poses.resize(poses.rfind('\n', poses.size() - 2) + 1);
  const Evaluation found = distortion_of(warming_test("abbe_location_broken", kTracker, kLocations, poses));
  EXPECT_EQ(std::get<LocationDistortion>(found.found).cycles.size(), 5U);
  const std::vector<std::string>& notes = found.report.notes;
  EXPECT_THAT(notes,
              testing::Contains(HasSubstr("The cycle that begins after 75 min is left out: it has 20 readings, a "
                                          "usual cycle 64.")));
}

std::string problem_of(const WarmingTest& warming, const std::function<void(LocationDistortionTest&)>& change = {}) {
  return message_of([&] {
    LocationDistortionTest test = distortion_test(warming.file);
    if (change) change(test);
    evaluate_readings({warming.file, test, {}, {}});
  });
}

TEST(LocationDistortionByTracker, WhatCannotBeEvaluatedIsRefused) {
  const WarmingTest warming = warming_test("abbe_location_refused", kTracker);
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.campaign.setups[0].readings.time_s.clear(); }),
              HasSubstr("table.study.toml: tracker: the readings have no times; expected a column time_s"));
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.cycle = 1e6; }), HasSubstr("show no cycles"));
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.cycle = test.pause = 60; }), HasSubstr("--pause-min"));
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.cycle = 3; }),
              AllOf(HasSubstr("fewer than two cycles determine the location errors"), Not(HasSubstr(".;"))));
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.stop = -60; }),
              HasSubstr("--stop-min: the heating stops at -1 min and starts at 0.5 min"));
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.stop = 1e6; }),
              HasSubstr("--stop-min: the cycles were read from 0 to 241 min"));
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.start = -600; }), HasSubstr("--start-min: the cycles"));
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.study.identification.reset(); }), HasSubstr("[identify]"));
  EXPECT_THAT(problem_of(warming, [](auto& test) { test.campaign.setups[0].readings = {}; }),
              HasSubstr("there are no readings"));
  EXPECT_THAT(problem_of(warming_test("abbe_location_states", kTracker, std::string(kLocations) + R"(
[[identify.location]]
errors = "EX0C"
state = "warmth"
)")),
              HasSubstr("errors depend on warmth, which would hide what the test shows"));
  EXPECT_THAT(problem_of(warming_test("abbe_location_none", kTracker, R"([[identify.motion]]
errors = "EXX"
basis = "legendre"
order = 1
)")),
              HasSubstr("no location error is identified"));
}

TEST(LocationDistortionOfTheExample, FindsTheFormulasOfItsReadings) {
  const std::string file = ABBE_SOURCE_DIR "/examples/warm_up/r-test.study.toml";
  LocationDistortionTest test = distortion_test(file);
  test.stop = 240 * 60;
  const Evaluation found = evaluate_readings({file, std::move(test), {"d_EZ0A_um=20"}, {}});
  EXPECT_TRUE(found.is_ok());
  struct Truth {
    const char* name;
    double change, minutes;
  };
  for (const Truth& truth : {Truth{"EX0C", 4e-3, 60}, Truth{"EY0C", -6e-3, 50}, Truth{"EA0C", 22e-6, 70},
                             Truth{"EY0A", -7e-3, 80}, Truth{"EZ0A", 18e-3, 60}}) {
    const WarmingSensor& one = location_named(found, truth.name);
    ASSERT_EQ(one.warming.status, ResponseStatus::done) << truth.name;
    EXPECT_NEAR(one.warming.time_constant, 60 * truth.minutes, 3 * one.warming.uncertainty) << truth.name;
    EXPECT_NEAR(one.recovery.time_constant, 1.6 * 60 * truth.minutes, 3 * one.recovery.uncertainty) << truth.name;
    // The last cycle before the stop, 228.25 min after the start, less the first, in the middle of its 6.5 min.
    const auto warm = [&](double minutes) { return truth.change * (1 - std::exp(-minutes / truth.minutes)); };
    const std::vector<double>& values = one.sensor.series.values;
    EXPECT_NEAR(values[15] - values[0], warm(228.25) - warm(3.25), 4 * one.running.uncertainty) << truth.name;
  }
  for (const char* const name : {"EB0C", "EB0A", "EC0A"}) {
    EXPECT_EQ(location_named(found, name).warming.status, ResponseStatus::no_change) << name;
  }
  const auto& distortion = std::get<LocationDistortion>(found.found);
  ASSERT_EQ(distortion.temperatures.size(), 1U);
  EXPECT_NEAR(distortion.temperatures[0].values[15], 27, 0.1);
  const nlohmann::ordered_json& locations = found.report.details.at("locations");
  EXPECT_EQ(locations[0].at("values_um").size(), 33U);
  EXPECT_LT(locations[0].at("probability_of_no_change").get<double>(), 1e-6);
}

}  // namespace
}  // namespace abbe
