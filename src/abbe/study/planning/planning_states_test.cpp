// Plans of readings of errors that depend on temperatures.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/study/planning/plan_page.h"
#include "abbe/study/planning/plan_text.h"
#include "abbe/study/planning/planning.h"
#include "abbe/study/random_poses.h"
#include "abbe/study/run_study.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const char* const kPlannedSlide = R"(name = "column on a slide"
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

const char* const kPlannedStudy = R"(name = "day"
machine = "slide.machine.toml"
seed = 4
{simulate}
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = {{ xyz_um = 2 }}
[[setup.station]]
name = "station"
pose = {pose}
[[setup.reflector]]
name = "R1"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
offset_mm = [120, 40, -60]
[[setup.reflector]]
name = "R3"
offset_mm = [-80, -50, 90]
{in_setup}
[identify]
[[identify.motion]]
errors = ["EXX", "EZZ"]
basis = "legendre"
order = 2
[[identify.motion]]
errors = "EXX"
state = "hall"
basis = "legendre"
order = 1
[[identify.motion]]
errors = ["EZZ", "EBZ"]
state = "column"
basis = "legendre"
order = 1
{plan}
)";

const char* const kPose = "{ position_mm = [1500, -2200, 300], angles_deg = [0.4, -0.8, 70] }";

std::filesystem::path planned_folder(const char* name) {
  const std::filesystem::path folder = test::empty_folder(name);
  std::ofstream(folder / "slide.machine.toml") << kPlannedSlide;
  return folder;
}

Study planned_study(const std::filesystem::path& folder, const std::string& plan) {
  const std::filesystem::path file = folder / "plan.study.toml";
  std::ofstream(file) << fmt::format(fmt::runtime(kPlannedStudy), fmt::arg("simulate", ""), fmt::arg("pose", kPose),
                                     fmt::arg("in_setup", ""), fmt::arg("plan", "[plan]\nposes = 240\n" + plan));
  Study study = read_study(file);
  study.threads = 1;
  return study;
}

const char* const kValues = R"(
[plan.state.hall]
values = [18, 20, 24]
[plan.state.motor]
from = 25
to = 40
levels = 2
)";

std::set<std::vector<double>> taken_states(const StudyPlan& plan, std::size_t state) {
  std::set<std::vector<double>> values;
  for (const std::vector<double>& one : plan.reading_states) values.insert({one[state]});
  return values;
}

/// What an identification from the readings of a plan finds: root mean square over the poses and states of the plan.
double found_uncertainty(const std::filesystem::path& folder, const Study& planned, const StudyPlan& plan) {
  std::ofstream(folder / "poses.csv") << plan_csv(planned, plan);
  std::ofstream(folder / "truth.errors.toml")
      << "[[motion]]\nname = \"EXX\"\nstate = \"hall\"\nbasis = \"legendre\"\norder = 1\ncoefficients_um = [1, 5]\n"
         "[[motion]]\nname = \"EBZ\"\nstate = \"column\"\nbasis = \"legendre\"\norder = 0\ncoefficients_urad = [4]\n";
  const std::filesystem::path file = folder / "run.study.toml";
  std::ofstream(file) << fmt::format(
      fmt::runtime(kPlannedStudy), fmt::arg("simulate", "[simulate]\nerrors = \"truth.errors.toml\""),
      fmt::arg("pose", std::string("\"find\"\ntrue_pose = ") + kPose),
      fmt::arg("in_setup", "[[setup.plan]]\nkind = \"poses\"\nfile = \"poses.csv\""), fmt::arg("plan", ""));
  Study study = read_study(file);
  study.identification->held_out_fraction = 0;
  const StudyResult result = run_study(study);
  EXPECT_TRUE(result.usable()) << result.identification.message;
  const PlanningModel model(planned);
  PoseList poses = random_plan(planned.machine, planned.planning->axes, 400, 99);
  std::vector<std::vector<double>> states;
  const std::vector<std::vector<double>>& used = model.states().used_at();
  for (std::size_t k = 0; k < poses.count(); ++k) states.push_back(used[k % used.size()]);
  give_states(states, poses);
  const Eigen::MatrixXd rows = model.prediction_rows(poses);
  const auto& found = result.identification;
  Eigen::MatrixXd by_found = Eigen::MatrixXd::Zero(rows.rows(), static_cast<Eigen::Index>(found.parameters.size()));
  for (std::size_t i = 0; i < found.parameters.size(); ++i) {
    for (std::size_t p = 0; p < model.parameter_count(); ++p) {
      if (model.parameters()[p].name == found.parameters[i].name)
        by_found.col(static_cast<Eigen::Index>(i)) = rows.col(static_cast<Eigen::Index>(p));
    }
  }
  return std::sqrt((by_found * found.covariance).cwiseProduct(by_found).sum() / static_cast<double>(poses.count()));
}

TEST(PlanOverStates, TakesTheStatesThatTellTheErrorsApart) {
  const std::filesystem::path folder = planned_folder("plan_values");
  const Study study = planned_study(folder, std::string("readings = 90\n") + kValues);
  const StudyPlan plan = plan_study(study);
  ASSERT_EQ(plan.plan.status, PlanningStatus::done);
  ASSERT_EQ(plan.states.conditions().size(), 6U);
  ASSERT_GE(plan.condition_curve.size(), 3U);
  const ConditionsOfANumber &one = plan.condition_curve[0], &two = plan.condition_curve[1];
  // With one state, what hall and column do cannot be told from what is always there: EXX and EZZ with two orders, EBZ
  // of the second order is nothing else. Two states tell one of the two apart only if the other does not change along.
  EXPECT_GT(one.open, 0U);
  EXPECT_THAT(one.open_words, HasSubstr("*"));
  EXPECT_LT(two.open, one.open);
  EXPECT_EQ(plan.conditions.open, 0U);
  EXPECT_FALSE(leaves_states_open(plan));
  EXPECT_GE(plan.conditions.conditions.size(), 3U);
  // Effects proportional to a temperature are seen best at its ends.
  EXPECT_TRUE(taken_states(plan, 0).count({18}) && taken_states(plan, 0).count({24}));
  EXPECT_EQ(taken_states(plan, 2), (std::set<std::vector<double>>{{25}, {40}})) << "a lag has the value of its channel";
  // A state is left once.
  std::set<std::size_t> left;
  for (std::size_t k = 1; k < plan.readings.size(); ++k) {
    if (plan.readings[k].condition == plan.readings[k - 1].condition) continue;
    EXPECT_TRUE(left.insert(plan.readings[k - 1].condition).second);
    EXPECT_EQ(left.count(plan.readings[k].condition), 0U);
  }
  EXPECT_NEAR(found_uncertainty(folder, study, plan), plan.uncertainty, 0.1 * plan.uncertainty);
  double sum = 0;
  for (const UncertaintyAtStates& at : plan.over_states) {
    sum += at.uncertainty * at.uncertainty / static_cast<double>(plan.over_states.size());
  }
  EXPECT_NEAR(std::sqrt(sum), plan.uncertainty, 0.02 * plan.uncertainty);

  const std::string text = study_plan_text(study, plan);
  EXPECT_THAT(text, HasSubstr("at how many states"));
  EXPECT_THAT(text, HasSubstr("directions open, most of all in"));
  EXPECT_THAT(text, HasSubstr("which sensors matter"));
  EXPECT_THAT(text, HasSubstr("without motor_degC"));
  const nlohmann::ordered_json json = plan_json(study, plan);
  EXPECT_TRUE(json["states"]["determined"].get<bool>());
  EXPECT_EQ(json["states"]["numbers"].size(), plan.condition_curve.size());
  EXPECT_EQ(plan_page_data(study, plan)["tables"].size(), 7U);

  ASSERT_EQ(plan.plain_states.size(), 2U);
  const PlainStates &ends = plan.plain_states[0], &single = plan.plain_states[1];
  EXPECT_EQ(ends.conditions, (std::vector<std::size_t>{0, 5}));
  // Hall and motor act on different errors, so that the ends tell both, though not as well.
  ASSERT_TRUE(ends.grids.determined && ends.grids.any && single.grids.any);
  EXPECT_GT(ends.grids.determined->value.uncertainty, plan.uncertainty);
  EXPECT_FALSE(single.grids.determined);
  EXPECT_GT(single.grids.any->open, 0U);
  EXPECT_GE(ends.grids.any->value.readings, 90U);
  EXPECT_GT(ends.grids.any->value.with_prior, plan.with_prior);
  EXPECT_GT(single.grids.any->value.with_prior, 2 * plan.with_prior);
  EXPECT_THAT(text, HasSubstr("a grid at the lowest and highest states (hall_degC = 18"));
  EXPECT_GT(json["states"]["against"][0]["gain"].get<double>(), 1);
  EXPECT_GT(json["states"]["against"][1]["gain_with_prior"].get<double>(), 2);
}

TEST(PlanOverStates, SaysWhatOneTemperatureLeavesOpen) {
  const std::filesystem::path folder = planned_folder("plan_one_value");
  const Study study = planned_study(folder,
                                    "readings = 60\n[plan.state.hall]\nvalues = [22]\nused = [18, 26]\n"
                                    "[plan.state.motor]\nvalues = [25, 40]\n");
  const StudyPlan plan = plan_study(study);
  ASSERT_EQ(plan.plan.status, PlanningStatus::done);
  EXPECT_TRUE(leaves_states_open(plan));
  EXPECT_THAT(plan.conditions.open_words, testing::StartsWith("EXX*hall"));
  const std::string text = study_plan_text(study, plan);
  EXPECT_THAT(text, HasSubstr("not determined at these states"));
  EXPECT_EQ(plan_json(study, plan).count("predicted_volumetric_uncertainty_um"), 0U);
  EXPECT_FALSE(plan_json(study, plan)["states"]["determined"].get<bool>());
  const auto hall = std::find_if(plan.sensors.alike.begin(), plan.sensors.alike.end(),
                                 [](const SensorLikeness& one) { return one.still(); });
  ASSERT_NE(hall, plan.sensors.alike.end());
  EXPECT_EQ(plan.sensors.courses[hall->sensor], "hall");
  // Far from the measured temperature prior knowledge is all there is.
  double near = 1e9, far = 0;
  for (const UncertaintyAtStates& at : plan.over_states) {
    near = std::min(near, at.uncertainty);
    far = std::max(far, at.uncertainty);
  }
  EXPECT_GT(far, 2 * near);
}

TEST(PlanOverStates, AChangeThatTakesLongIsMadeLessOften) {
  const std::filesystem::path folder = planned_folder("plan_changes");
  const auto conditions = [&](const char* change) {
    const Study study =
        planned_study(folder, fmt::format("time_min = 12\n[plan.state.hall]\nfrom = 18\nto = 24\nlevels = 4\n{}\n"
                                          "[plan.state.motor]\nvalues = [25, 40]\n{}\n",
                                          change, change));
    const StudyPlan plan = plan_study(study);
    EXPECT_EQ(plan.plan.status, PlanningStatus::done) << change;
    EXPECT_LE(plan.time, study.planning->time) << change;
    EXPECT_FALSE(leaves_states_open(plan)) << change;
    return plan.conditions.conditions.size();
  };
  const std::size_t quick = conditions("change_s = 0"), slow = conditions("change_min = 2");
  EXPECT_GE(quick, slow);
  EXPECT_LE(slow, 4U);
}

constexpr double kMinute = 60, kHour = 3600, kLag = 50 * kMinute;

double hall_of(double time) { return 21 + 2.5 * std::sin(2 * std::numbers::pi * (time / kHour - 3) / 24); }

/// Work of three hours from 2 h on: the motor stands at 25 degC before and at 40 degC then, with short ramps.
double motor_of(double time) {
  const double t = time / kHour;
  return t < 2 ? 25 : t < 2.1 ? 25 + 150 * (t - 2) : t < 5 ? 40 : t < 5.1 ? 40 - 150 * (t - 5) : 25;
}

const char* const kCourse = R"(
[plan.course]
channels = ["hall.csv", "motor.csv"]
slot_min = 30
visit_min = 5
)";

std::filesystem::path course_folder(const char* name) {
  std::filesystem::path folder = planned_folder(name);
  std::ofstream hall(folder / "hall.csv"), motor(folder / "motor.csv");
  hall << "time_min,hall_degC\n";
  motor << "time_min,motor_degC\n";
  for (int k = 0; k <= 60; ++k) hall << fmt::format("{},{}\n", 10 * k, hall_of(600.0 * k));
  for (int k = 0; k <= 600; ++k) motor << fmt::format("{},{}\n", k, motor_of(60.0 * k));
  return folder;
}

TEST(PlanOverStates, SaysWhenInTheCourseOfADay) {
  const std::filesystem::path folder = course_folder("plan_course");
  const Study study = planned_study(folder, std::string("readings = 100\n") + kCourse);
  const StudyPlan plan = plan_study(study);
  ASSERT_EQ(plan.plan.status, PlanningStatus::done);
  ASSERT_EQ(plan.states.conditions().size(), 20U);
  EXPECT_FALSE(leaves_states_open(plan));
  EXPECT_GT(plan.condition_curve[0].open, 0U);
  const std::vector<double> times = reading_times(study, plan.readings, plan.states);
  ASSERT_EQ(times.size(), plan.reading_states.size());
  // The lag behind a straight line, integrated in small steps from equilibrium.
  std::vector<double> lag = {25};
  for (int second = 1; second <= 36000; ++second) {
    lag.push_back(lag.back() + (motor_of(second - 0.5) - lag.back()) * (1 - std::exp(-1 / kLag)));
  }
  double before = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const PlanningCondition& slot = plan.states.conditions()[plan.readings[k].condition];
    EXPECT_GT(times[k], before);
    before = times[k];
    EXPECT_GE(times[k], slot.from_s + 2);
    EXPECT_LE(times[k], slot.to_s);
    EXPECT_NEAR(plan.reading_states[k][0], hall_of(times[k]), 0.01);
    EXPECT_TRUE(std::isnan(plan.reading_states[k][1])) << "no error depends on the motor but through its lag";
    EXPECT_NEAR(plan.reading_states[k][2], lag[static_cast<std::size_t>(times[k])], 0.02);
  }
  EXPECT_LT(plan.time, times.back()) << "pauses are no time of the measurement";
  EXPECT_NEAR(found_uncertainty(folder, study, plan), plan.uncertainty, 0.1 * plan.uncertainty);
  const std::string csv = plan_csv(study, plan);
  EXPECT_THAT(csv, HasSubstr("X_mm,Z_mm,station,reflector,time_s,hall_degC,column_degC\n"));
  EXPECT_THAT(study_plan_text(study, plan), HasSubstr("column is taken to be in equilibrium with motor at 0 s"));
  ASSERT_EQ(plan.sensors.names, (std::vector<std::string>{"hall_degC", "motor_degC"}));
  EXPECT_GT(plan.sensors.without.front().error, plan.sensors.all);
}

TEST(PlanOverStates, NoMoreReadingsThanAPartOfTheCourseHasTimeFor) {
  const std::filesystem::path folder = course_folder("plan_full_course");
  Study study = planned_study(folder, std::string("readings = 400\nsettle_s = 20\nreading_s = 10\n") + kCourse);
  study.planning->candidates = 600;
  const StudyPlan plan = plan_study(study);
  ASSERT_EQ(plan.plan.status, PlanningStatus::done);
  const std::vector<double> times = reading_times(study, plan.readings, plan.states);
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_LE(times[k], plan.states.conditions()[plan.readings[k].condition].to_s) << k;
  }
  EXPECT_GT(plan.readings.size(), 100U);
}

TEST(PlanOverStates, WhatIsMissingIsSaid) {
  const std::filesystem::path folder = course_folder("plan_states_missing");
  const auto message = [&](const std::string& plan) {
    return message_of([&] { plan_study(planned_study(folder, "readings = 60\n" + plan)); });
  };
  EXPECT_EQ(
      message(""),
      "plan: the errors depend on hall, and the study does not say at which values readings can be taken; expected a "
      "table [plan.state.hall] with from and to, or [plan.course]");
  EXPECT_THAT(
      message("[plan.state.hall]\nvalues = [18, 24]\n"),
      HasSubstr("the errors depend on column, and the study does not say at which values readings can be taken; "
                "expected a table [plan.state.motor]"));
  EXPECT_THAT(message("[plan.state.wind]\nvalues = [1]\n"), HasSubstr("wind: is not a state of this machine"));
  EXPECT_THAT(message("[plan.state.hall]\nvalues = [24, 18]\n"), HasSubstr("values: do not increase"));
  EXPECT_THAT(message("[plan.state.hall]\nfrom = 24\nto = 18\n"), HasSubstr("to: is not above from"));
  EXPECT_THAT(message("[plan.state.hall]\nvalues = [18]\n[plan.course]\nchannels = \"hall.csv\"\n"),
              HasSubstr("course: is given beside [plan.state]"));
  EXPECT_THAT(message("[plan.course]\nslot_s = 60\n"), HasSubstr("channels: is missing"));
  EXPECT_THAT(message("[plan.course]\nchannels = \"hall.csv\"\n"),
              HasSubstr("the errors depend on column, which the course does not have; expected a column column_degC"));
  EXPECT_THAT(message("[plan.course]\nchannels = [\"hall.csv\", \"motor.csv\"]\nslot_s = 60\n"),
              HasSubstr("the course has 600 parts of this length; expected at least slot_s = 360"));
}

}  // namespace
}  // namespace abbe
