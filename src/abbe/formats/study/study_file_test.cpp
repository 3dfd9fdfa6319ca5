#include "abbe/formats/study/study_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "abbe/formats/controls/turntable_machine_for_test.h"
#include "abbe/formats/study/study_parts.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/trackers/laser_tracker.h"

namespace abbe {
namespace {

const char* const kSimulated = R"(name = "tracker on the table"
machine = "xcfz.machine.toml"
seed = 7

[simulate]
[simulate.generator]
mean_volumetric_um = 100
linear_order = 3
[simulate.outliers]
fraction = 0.3
size_um = 500

[[setup]]
name = "table"
instrument = "tracker"
noise = { xyz_um = 10, xyz_um_per_m = 5 }
[[setup.station]]
name = "S1"
pose = "find"
true_pose = { position_mm = [300, -200, 150], angles_deg = [1, 2, 30] }
[[setup.reflector]]
name = "T1"
offset_mm = [60, 0, -150]
estimate_offset = true
[[setup.reflector]]
name = "T2"
offset_mm = [0, 80, -250]
[[setup.plan]]
kind = "grid"
axis.X = { range_mm = [0, 1400], count = 8 }
axis.Z = { count = 4 }
axis.C = { at_deg = 90 }
reflectors = ["T2"]
[[setup.plan]]
kind = "random"
points = 500
axis.X = {}
axis.C = { step_deg = 5 }

[identify]
locations = ["E?0C", "EX0X"]
strategy = "combined"
loss = "cauchy"
[[identify.motion]]
errors = ["E?X", "EXZ"]
basis = "legendre"
orders = [1, 6]
[[identify.motion]]
errors = "E*C"
basis = "fourier"
order = 4
[[identify.prior]]
parameters = ["EXX[*]", "EZX[*]"]
standard_uncertainty_um = 50

[map]
axis.X = { count = 11 }

[report]
title = "Tracker"
)";

Study parsed_in_folder(const std::string& text) {
  return parse_study(text, "folder/xcfz.study.toml", test::endless_turntable());
}

std::string message_of_simulation_with(const std::string& from, const std::string& to) {
  return message_of([&] { parsed_in_folder(test::replaced(kSimulated, from, to)); });
}

TEST(StudyFile, ReadsASimulation) {
  const Study study = parsed_in_folder(kSimulated);
  EXPECT_EQ(study.machine_file, "folder/xcfz.machine.toml");
  EXPECT_EQ(study.output, "folder/results/xcfz");
  EXPECT_EQ(study.seed, 7U);
  ASSERT_TRUE(study.simulation && study.simulation->generator);
  EXPECT_EQ(*study.simulation->generator->mean_volumetric, 0.1);
  EXPECT_EQ(study.simulation->outliers.size, 0.5);

  ASSERT_EQ(study.setups.size(), 1U);
  const auto& setup = study.setups[0];
  const TrackerSetup tracker = dynamic_cast<const LaserTracker&>(*setup.device).setup();
  const TrackerStation& station = tracker.stations[0];
  EXPECT_EQ(station.body, Body::workpiece);
  EXPECT_DOUBLE_EQ(station.noise.range_um, 10);
  EXPECT_DOUBLE_EQ(station.noise.transverse_um_per_m, 5);
  EXPECT_FALSE(station.pose_is_known);
  EXPECT_TRUE(station.estimate_pose);
  EXPECT_DOUBLE_EQ(error_angles_from_rotation(station.true_pose->rotation).z(), std::numbers::pi / 6);
  EXPECT_TRUE(tracker.reflectors[0].estimate_offset);

  ASSERT_EQ(setup.plans.size(), 2U);
  EXPECT_EQ(setup.plans[0].axes[1].count, 8U);
  EXPECT_EQ(setup.plans[0].axes[2].to, 600);
  EXPECT_DOUBLE_EQ(setup.plans[0].axes[0].from, std::numbers::pi / 2);
  EXPECT_TRUE(setup.plans[0].axes[0].is_fixed());
  EXPECT_EQ(setup.plans[0].targets, (std::vector<std::size_t>{1}));
  EXPECT_EQ(setup.plans[1].points, 500);
  EXPECT_EQ(setup.plans[1].axes[1].to, 1400);
  EXPECT_TRUE(setup.plans[1].axes[2].is_fixed());
  EXPECT_EQ(setup.plans[1].axes[2].from, 0);
  EXPECT_DOUBLE_EQ(setup.plans[1].axes[0].step, std::numbers::pi / 36);
  EXPECT_EQ(setup.plans[1].targets, (std::vector<std::size_t>{0, 1}));

  const IdentificationPlan& identify = *study.identification;
  EXPECT_EQ(identify.motions.size(), 6U + 1U + 6U);
  EXPECT_EQ(identify.motions[0].smallest_order, 1);
  EXPECT_EQ(identify.motions[0].basis.order, 6);
  EXPECT_EQ(identify.motions[0].basis.to, 1400);
  EXPECT_EQ(identify.motions[6].basis.to, 600);
  EXPECT_EQ(identify.motions[7].basis.period, 2 * std::numbers::pi);
  EXPECT_TRUE(identify.select_order);
  ASSERT_EQ(identify.locations.size(), 5U);  // EX0C EY0C EA0C EB0C, not the zero EC0C; EX0X because it is named
  EXPECT_EQ(identify.strategy, Strategy::combined);
  EXPECT_EQ(identify.loss, LossKind::cauchy);
  ASSERT_EQ(identify.priors.size(), 2U);
  EXPECT_EQ(identify.priors[1].parameters, "EZX[*]");
  EXPECT_EQ(identify.priors[0].standard_uncertainty, 0.05);
  EXPECT_FALSE(identify.priors[0].is_angle);
  EXPECT_EQ(study.map->axes[1].count, 11U);
  EXPECT_EQ(study.report.title, "Tracker");
}

TEST(StudyFile, ReadsMeasuredDataAndTheMachineBesideIt) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "abbe_study";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "xcfz.machine.toml") << test::kEndlessTurntable;
  std::ofstream(folder / "a.study.toml") << R"(machine = "xcfz.machine.toml"
output = "out"
[[setup]]
name = "tracker"
instrument = "tracker"
measure = "range-angles"
noise = { range_um = 5, range_um_per_m = 0.5, angle_arcsec = 1 }
[[setup.data]]
file = "readings.csv"
ignore = ["remark"]
columns = { X_mm = "x", C_deg = "c" }
[identify]
locations = "EC0X"
)";
  std::filesystem::remove(folder / "readings.csv");
  EXPECT_EQ(message_of([&] { read_study(folder / "a.study.toml"); }),
            (folder / "a.study.toml").string() + ":9:1: setup[1].data[1].file: there is no file " +
                (folder / "readings.csv").string() + "; expected a file of readings");
  std::ofstream(folder / "readings.csv") << "x\n";
  const Study study = read_study(folder / "a.study.toml");
  EXPECT_EQ(study.name, "a");
  EXPECT_EQ(study.output, folder / "out");
  EXPECT_FALSE(study.simulation);
  EXPECT_EQ(study.machine.chain(), "w C' X' b Z t");
  const auto& setup = study.setups[0];
  EXPECT_EQ(setup.data[0].file, folder / "readings.csv");
  EXPECT_EQ(setup.data[0].mapping.columns.at("C_deg"), "c");
  EXPECT_EQ(setup.data[0].mapping.ignore, (std::vector<std::string>{"remark"}));
  const LaserTracker& tracker = dynamic_cast<const LaserTracker&>(*setup.device);
  EXPECT_EQ(tracker.measure(), TrackerMeasure::range_and_angles);
  EXPECT_DOUBLE_EQ(tracker.setup().stations[0].noise.transverse_um_per_m, std::numbers::pi / 648000 * 1e6);
  EXPECT_EQ(tracker.station_names(), (std::vector<std::string>{"tracker"}));

  std::ofstream(folder / "b.study.toml") << "machine = \"no.machine.toml\"\n";
  EXPECT_EQ(message_of([&] { read_study(folder / "b.study.toml"); }),
            (folder / "b.study.toml").string() + ":1:1: machine: there is no file " +
                (folder / "no.machine.toml").string() + "; expected a machine file beside the study");
}

TEST(StudyFile, RefusesAxesAndRangesTheMachineDoesNotHave) {
  const std::string file = "folder/xcfz.study.toml";
  EXPECT_EQ(message_of_simulation_with("axis.X = { range_mm = [0, 1400], count = 8 }", "axis.Y = { count = 8 }"),
            file + ":30:6: setup[1].plan[1].axis.Y: the machine has no axis Y; expected one of C, X, Z");
  EXPECT_EQ(
      message_of_simulation_with("[0, 1400], count = 8", "[0, 1500], count = 8"),
      file +
          ":30:12: setup[1].plan[1].axis.X.range_mm: 1500 mm is outside the travel of axis X; expected 0 to 1400 mm");
  EXPECT_EQ(message_of_simulation_with("range_mm = [0, 1400], count = 8", "range_deg = [0, 1400], count = 8"),
            file +
                ":30:12: setup[1].plan[1].axis.X.range_deg: 'deg' is not a unit of a length; expected range_mm, "
                "range_um or range_m");
  EXPECT_EQ(message_of_simulation_with("axis.C = { at_deg = 90 }", "axis.C = { at_deg = nan }"),
            file + ":32:21: setup[1].plan[1].axis.C.at_deg: nan is not a finite number; expected an angle in deg");
}

TEST(StudyFile, RefusesContradictionsInASetUp) {
  const std::string file = "folder/xcfz.study.toml";
  EXPECT_EQ(message_of_simulation_with("noise = { xyz_um = 10, xyz_um_per_m = 5 }", "noise = { xyz = 10 }"),
            file + ":16:11: setup[1].noise.xyz: the unit is missing from the name; expected xyz_mm, xyz_um or xyz_m");
  EXPECT_EQ(message_of_simulation_with("noise = { xyz_um = 10, xyz_um_per_m = 5 }", "noise = { range_um = 10 }"),
            file +
                ":16:9: setup[1].noise: the noise is missing or zero; expected xyz_um with xyz_um_per_m, or range_um "
                "with range_um_per_m and angle_arcsec");
  EXPECT_EQ(message_of_simulation_with("instrument = \"tracker\"", "instrument = \"ballbar\"")
                .find(file + ":15:1: setup[1].instrument: unknown word \"ballbar\"; expected \"tracker\""),
            0U);
  EXPECT_EQ(message_of_simulation_with("reflectors = [\"T2\"]", "reflectors = [\"T3\"]"),
            file + ":33:1: setup[1].plan[1].reflectors: there is no reflector \"T3\"; expected one of T1, T2");
  EXPECT_EQ(message_of_simulation_with("name = \"T2\"", "name = \"T1\""),
            file + ":26:1: setup[1].reflector[2].name: another one is called \"T1\"; expected different names");
  EXPECT_EQ(message_of_simulation_with("name = \"T2\"", "name = \"T2\"\nmounted_on = \"workpiece\""),
            file +
                ":25:1: setup[1].reflector[2]: the reflector and the instrument are on the same body, so that no axis "
                "moves between them; expected another mounted_on for one of them");
  EXPECT_EQ(message_of_simulation_with("true_pose = { position_mm = [300, -200, 150], angles_deg = [1, 2, 30] }", ""),
            file +
                ":17:1: setup[1].station[1]: a simulation needs the true pose; expected true_pose = { position_mm = "
                "[x, y, z], angles_deg = [a, b, c] }");
  EXPECT_EQ(message_of_simulation_with("points = 500", ""),
            file +
                ":34:1: setup[1].plan[2].points: missing; expected a whole number from 1 "
                "to 10000000");
  EXPECT_EQ(message_of_simulation_with("fraction = 0.3", "fraction = 0.7"),
            file + ":10:1: simulate.outliers.fraction: is above one half; expected a fraction from 0 to 0.5");
  EXPECT_EQ(message_of_simulation_with("mean_volumetric_um = 100", ""),
            file +
                ":6:1: simulate.generator: the size of the errors is missing or given twice; expected either "
                "mean_volumetric_um or maximum_volumetric_um");
}

TEST(StudyFile, RefusesWhatCannotBeIdentified) {
  const std::string file = "folder/xcfz.study.toml";
  EXPECT_EQ(
      message_of_simulation_with("\"E?X\", \"EXZ\"", "\"E?Y\""),
      file +
          ":45:1: identify.motion[1].errors: \"E?Y\" is not an error motion of this machine; expected names like EXX "
          "or patterns like \"E?C\" (* any text, ? one character); axes C, X, Z");
  EXPECT_EQ(message_of_simulation_with("\"E?X\", \"EXZ\"", "\"E?X\", \"EXC\""),
            file +
                ":45:1: identify.motion[1].errors: linear and rotary axes in one table: their positions have "
                "different units; expected one [[identify.motion]] for each kind of axis");
  EXPECT_EQ(
      message_of_simulation_with("\"E?X\", \"EXZ\"", "\"E?X\", \"EXX\""),
      file +
          ":45:1: identify.motion[1].errors: EXX is given twice in the same basis; expected each error motion once "
          "per basis");
  EXPECT_EQ(message_of_simulation_with("[\"E?0C\", \"EX0X\"]", "[\"EZ0C\"]"),
            file +
                ":41:1: identify.locations: \"EZ0C\" has no effect on the axis; expected a location error that "
                "displaces the axis line");
  EXPECT_EQ(message_of_simulation_with("[1, 6]", "[6, 1]"),
            file + ":47:1: identify.motion[1].orders: is not a range; expected [smallest, largest]");
  EXPECT_EQ(message_of_simulation_with("strategy =", "stratgey ="),
            file + ":42:1: identify.stratgey: unknown key, did you mean strategy?");
}

TEST(StudyFile, MatchesPatterns) {
  EXPECT_TRUE(matches_pattern("EXX[P2]", "EXX[*]"));
  EXPECT_TRUE(matches_pattern("EXX", "E?X"));
  EXPECT_FALSE(matches_pattern("EX0X", "E?X"));
  EXPECT_TRUE(matches_pattern("abcbc", "a*bc"));
  EXPECT_FALSE(matches_pattern("abcb", "a*bc"));
  EXPECT_TRUE(matches_pattern("", "**"));
  EXPECT_FALSE(matches_pattern("x", ""));
}

}  // namespace
}  // namespace abbe
