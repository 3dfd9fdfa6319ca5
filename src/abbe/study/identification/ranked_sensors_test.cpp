#include "abbe/study/identification/ranked_sensors.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/identify/time_blocks.h"
#include "abbe/study/report/report_identification.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const char* const kFourSensors = R"(name = "cross table"
chain = "w X' Y' b Z t"
[axis.X]
travel_mm = [0, 600]
[axis.Y]
travel_mm = [0, 400]
[axis.Z]
travel_mm = [0, 300]
[state.column]
kind = "measured"
unit = "degC"
[state.spindle]
kind = "measured"
unit = "degC"
[state.coolant]
kind = "measured"
unit = "degC"
[state.column2]
kind = "measured"
unit = "degC"
)";

/// The column bends, the spindle grows; the coolant does nothing, and column2 is nearly as warm as the column.
const char* const kTruthOfSensors = R"([[motion]]
name = "EXX"
basis = "legendre"
order = 2
coefficients_um = [0, 9, -4]
[[motion]]
name = "EYX"
state = "column"
basis = "legendre"
order = 1
coefficients_um = [0, 5]
[[motion]]
name = "EZZ"
state = "spindle"
basis = "legendre"
order = 1
coefficients_um = [0, 2]
)";

std::filesystem::path sensors_folder(const char* name) {
  std::filesystem::path folder = test::empty_folder(name);
  std::ofstream(folder / "table.machine.toml") << kFourSensors;
  std::ofstream(folder / "truth.errors.toml") << kTruthOfSensors;
  std::ofstream poses(folder / "poses.csv");
  poses << "time_s,X_mm,Y_mm,Z_mm,column_degC,spindle_degC,coolant_degC,column2_degC\n";
  RandomStream random(12);
  for (int k = 0; k < 160; ++k) {
    const double t = k / 20.0, x = k % 53 == 0 ? 0 : k % 53 == 1 ? 600 : random.uniform(0, 600);
    const double column = 21 + 4 * (1 - std::exp(-t / 2));
    poses << fmt::format("{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", 180 * k, x, random.uniform(0, 400),
                         random.uniform(0, 300), column, 26 + 3 * std::sin(1.4 * t), 20 + 2 * std::sin(2.7 * t + 1),
                         column + 0.1 * std::sin(3.3 * t));
  }
  return folder;
}

std::string terms_of_sensors(bool optional) {
  std::string text;
  for (const char* sensor : {"column", "spindle", "coolant", "column2"}) {
    text += fmt::format(
        "[[identify.motion]]\nerrors = [\"EYX\", \"EZZ\"]\nstate = \"{}\"\nbasis = \"legendre\"\norder = 1\n{}", sensor,
        optional ? "optional = true\n" : "");
  }
  return text;
}

Study study_of_sensors(const std::filesystem::path& folder, const std::string& identify) {
  const std::filesystem::path file = folder / "table.study.toml";
  std::ofstream(file) << fmt::format(R"(machine = "table.machine.toml"
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
kind = "poses"
file = "poses.csv"
[identify]
held_out_fraction = 0
{}
[[identify.motion]]
errors = ["EXX", "EYX", "EZZ"]
basis = "legendre"
order = 2
)",
                                     identify);
  return read_study(file);
}

RankedSensors ranked(const Study& study) {
  StudyResult result;
  result.campaign = gather_readings(study);
  prepare_study(study, result);
  return result.sensors.value();
}

TEST(RankedSensors, ThoseThatDriveErrorsComeFirstAndAreEnough) {
  const std::filesystem::path folder = sensors_folder("ranked_sensors");
  Study study = study_of_sensors(folder, "rank_sensors = true\n" + terms_of_sensors(true));
  for (std::uint64_t draw = 0; draw < 10; ++draw) {
    study.seed = 20 + draw;
    const RankedSensors found = ranked(study);
    ASSERT_TRUE(found.done);
    ASSERT_EQ(found.names.size(), 4U);
    ASSERT_EQ(found.forward.size(), 5U);
    EXPECT_EQ(found.enough, 2U) << draw;
    const std::vector<std::size_t>& two = found.forward[2].sensors;
    EXPECT_TRUE(two == (std::vector<std::size_t>{0, 1}) || two == (std::vector<std::size_t>{1, 3}));
    EXPECT_GT(found.forward[0].length_rms, 1.2 * found.forward[1].length_rms);
    EXPECT_GT(found.forward[1].rms, found.forward[2].rms + found.forward[2].standard_error / 2);
    // Noise of 2 um along three axes.
    EXPECT_NEAR(found.forward[2].length_rms, 2e-3 * std::sqrt(3), 0.3e-3);
    // Nothing stands in for the spindle; for the column column2 does.
    EXPECT_EQ(found.without.front().sensors, (std::vector<std::size_t>{0, 2, 3}));
  }
}

/// Every figure by identifications of their own, with the terms that are in the model and without the block.
TEST(RankedSensors, ErrorsAreThoseOfIdentificationsWithoutTheirBlocks) {
  const std::filesystem::path folder = sensors_folder("ranked_refitted");
  const Study all = study_of_sensors(folder, "rank_sensors = true\ntime_blocks = 10\n" + terms_of_sensors(false));
  const RankedSensors found = ranked(all);
  ASSERT_TRUE(found.done);
  for (const HeldOutSensors& one : found.forward) {
    Study study = all;
    std::erase_if(study.identification->motions, [&](const IdentifiedMotion& motion) {
      return motion.state != kNoState &&
             std::find(one.sensors.begin(), one.sensors.end(), motion.state) == one.sensors.end();
    });
    study.identification->rank_sensors = false;
    StudyResult result;
    result.campaign = gather_readings(study);
    prepare_study(study, result);
    const std::vector<TimeBlocks> blocks = divide_by_time({result.campaign.setups[0].readings.time_s}, 10, 0);
    double mean = 0, mean_length = 0;
    for (std::size_t b = 0; b < 10; ++b) {
      Problem training = result.model.problem;
      std::vector<std::uint8_t>& use = training.observations[0].use;
      use.clear();
      for (const std::size_t block : blocks[0].block) use.push_back(block != b ? 1 : 0);
      const Identification identified = identify(training);
      ASSERT_EQ(identified.status, IdentifyStatus::converged);
      const std::vector<double> residuals = residuals_by_reading(*training.observations[0].observations);
      double sum = 0, count = 0;
      std::vector<double> lengths;
      for (std::size_t k = 0; k < use.size(); ++k) {
        if (use[k] != 0) continue;
        for (std::size_t row = 0; row < 3; ++row) sum += residuals[3 * k + row] * residuals[3 * k + row], count += 1;
        lengths.push_back(*training.observations[0].observations->length_of_deviation(k));
      }
      mean += sum / count / 10;
      for (const double length : lengths) mean_length += length * length / static_cast<double>(lengths.size()) / 10;
    }
    EXPECT_NEAR(one.rms / std::sqrt(mean), 1, 1e-4);
    EXPECT_NEAR(one.length_rms / std::sqrt(mean_length), 1, 1e-4);
  }
}

TEST(RankedSensors, AreReported) {
  const std::filesystem::path folder = sensors_folder("ranked_report");
  const Study study = study_of_sensors(folder, "rank_sensors = true\n" + terms_of_sensors(true));
  const StudyResult result = run_study(study);
  ASSERT_TRUE(result.usable()) << result.identification.message;
  const std::string text = study_text(study, result, nullptr);
  EXPECT_THAT(text, HasSubstr("sensors by 20 held-out blocks of time"));
  EXPECT_THAT(text, HasSubstr("<- enough: within a standard error of the best"));
  EXPECT_THAT(text, HasSubstr("no gain"));
  EXPECT_THAT(text, HasSubstr("all without spindle_degC"));
  EXPECT_THAT(text, HasSubstr("note: column follows from column2"));
  EXPECT_THAT(report_assumptions(study, result), testing::Contains(HasSubstr("; 2 of 4 are enough")));
  const nlohmann::ordered_json json = study_summary(study, result)["sensors"];
  EXPECT_EQ(json["added_in_turn"].size(), 5U);
  EXPECT_EQ(json["enough"], 2);
  EXPECT_GT(json["added_in_turn"][0]["held_out_rms_um"].get<double>(), 4.5);
  // Ranking does not change what is identified.
  const StudyResult alone = run_study(study_of_sensors(folder, terms_of_sensors(true)));
  EXPECT_EQ(alone.identification.estimates, result.identification.estimates);
  EXPECT_EQ(study_summary(study, alone).count("sensors"), 0U);
}

TEST(RankedSensors, RefusesWhatCannotBeRanked) {
  const std::filesystem::path folder = sensors_folder("ranked_refused");
  EXPECT_THAT(message_of([&] { study_of_sensors(folder, "rank_sensors = true\n"); }),
              HasSubstr("rank_sensors: is given, and no error depends on a measured state"));
  EXPECT_THAT(message_of([&] {
                study_of_sensors(folder, "rank_sensors = true\nloss = \"huber\"\n" + terms_of_sensors(false));
              }),
              HasSubstr("rank_sensors: compares sums of squares"));
}

}  // namespace
}  // namespace abbe
