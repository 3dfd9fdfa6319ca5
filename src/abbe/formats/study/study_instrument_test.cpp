#include "abbe/formats/study/study_instrument.h"

#include "abbe/formats/controls/turntable_machine_for_test.h"
#include "abbe/formats/readings/planned_poses.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/instruments/trackers/laser_tracker.h"

namespace abbe {
namespace {

const char* const kBallBarStudy = R"(machine = "m.machine.toml"
[simulate]
[simulate.generator]
mean_volumetric_um = 100
[[setup]]
name = "bar"
instrument = "ball-bar"
spindle_ball_mm = [0, 0, -100]
spindle_ball_standard_uncertainty_um = [5, 5, 2]
length_deviation_um = 1
length_deviation_standard_uncertainty_um = 0.5
true_length_deviation_um = 1.4
noise = { length_um = 0.2, length_um_per_m = 1 }
[[setup.ball]]
name = "B1"
centre_mm = [10, 20, 30]
[[setup.ball]]
name = "B2"
centre_mm = [40, 20, 30]
estimate_centre = false
[[setup.plan]]
kind = "circle"
plane = ["X", "Z"]
radius_mm = 150
to_deg = 180
points = 20
repeats = 2
there_and_back = true
items = ["B2"]
[[setup.plan]]
kind = "follow"
displacement_mm = [0, 0, 100]
axis.C = { count = 7 }
)";

Study parsed_study(const std::string& text) { return parse_study(text, "s.study.toml", test::endless_turntable()); }

std::string message_of_ball_bar_with(const std::string& from, const std::string& to) {
  return message_of([&] { parsed_study(test::replaced(kBallBarStudy, from, to)); });
}

TEST(StudyInstrument, ReadsABallBarWithWhatIsKnownOfIt) {
  const Study study = parsed_study(kBallBarStudy);
  const struct Setup& setup = study.setups.at(0);
  ASSERT_NE(setup.device, nullptr);
  EXPECT_EQ(setup.instrument, "ball-bar");
  const std::vector<SetupQuantity>& quantities = setup.device->quantities();
  ASSERT_EQ(quantities.size(), 10U);
  EXPECT_EQ(quantities[2].name, "bar.spindle_ball.z");
  EXPECT_EQ(quantities[2].knowledge, Knowledge::within);
  EXPECT_DOUBLE_EQ(quantities[2].standard_uncertainty, 0.002);
  EXPECT_DOUBLE_EQ(quantities[3].value, 0.001);
  EXPECT_DOUBLE_EQ(*quantities[3].truth, 0.0014);
  EXPECT_EQ(quantities[4].knowledge, Knowledge::open);
  EXPECT_EQ(quantities[7].knowledge, Knowledge::exact);
  InstrumentReadings reading;
  reading.append({0, 0, 0}, 0);
  reading.measured = {{1000}};
  EXPECT_DOUBLE_EQ(setup.device->standard_uncertainty(reading, 0, 0), 0.0002 + 0.001);
}

TEST(StudyInstrument, ReadsPlansThatBringPointsTogether) {
  const struct Setup setup = parsed_study(kBallBarStudy).setups.at(0);
  ASSERT_EQ(setup.plans.size(), 2U);
  const MeasurementPlan& circle = setup.plans[0];
  EXPECT_EQ(circle.kind, PlanKind::circle);
  EXPECT_EQ(circle.targets, std::vector<std::size_t>{1});
  EXPECT_EQ(circle.circle.v, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(circle.circle.count, 20U);
  EXPECT_EQ(circle.repeats, 2U);
  EXPECT_TRUE(circle.there_and_back);
  EXPECT_EQ(setup.plans[1].kind, PlanKind::follow);
  EXPECT_EQ(setup.plans[1].targets, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(setup.plans[1].displacement, Eigen::Vector3d(0, 0, 100));
}

TEST(StudyInstrument, SaysWhatIsWrong) {
  EXPECT_EQ(message_of_ball_bar_with("\"ball-bar\"", "\"ballbar\"")
                .find("s.study.toml:7:1: setup[1].instrument: unknown word \"ballbar\""),
            0U);
  EXPECT_NE(message_of_ball_bar_with("length_um = 0.2", "length_um = 0").find("noise.length_um: is not above zero"),
            std::string::npos);
  EXPECT_NE(message_of_ball_bar_with("[5, 5, 2]", "[5, 5, 0]").find("is not above zero"), std::string::npos);
  EXPECT_NE(message_of_ball_bar_with("spindle_ball_mm", "spindle_ball_deg").find("spindle_ball_mm"), std::string::npos);
  EXPECT_NE(message_of_ball_bar_with("items = [\"B2\"]", "items = [\"B3\"]")
                .find("there is no item \"B3\"; expected one of B1, B2"),
            std::string::npos);
  EXPECT_NE(message_of_ball_bar_with("[\"X\", \"Z\"]", "[\"X\", \"X\"]").find("is not a plane"), std::string::npos);
  EXPECT_NE(message_of_ball_bar_with("name = \"B2\"", "name = \"B1\"").find("two items are called \"B1\""),
            std::string::npos);
  EXPECT_NE(message_of_ball_bar_with("radius_mm = 150", "radius_mm = 0").find("is not above zero"), std::string::npos);
  EXPECT_NE(message_of_ball_bar_with("axis.C = { count = 7 }", "axis.X = { count = 7 }")
                .find("X is linear and follows by itself"),
            std::string::npos);
  EXPECT_NE(message_of_ball_bar_with("estimate_centre = false",
                                     "estimate_centre = true\ncentre_standard_uncertainty_um = [1,1,1]\n"
                                     "true_centre_um = [1, 2]")
                .find("true_centre_um"),
            std::string::npos);
}

/// The study with a third plan.
std::string with_plan(const std::string& plan) { return kBallBarStudy + ("[[setup.plan]]\n" + plan); }

TEST(StudyInstrument, ReadsAStepDiagonalWhichMayFall) {
  const MeasurementPlan plan = parsed_study(with_plan("kind = \"step-diagonal\"\nsteps = 4\norder = [\"Z\", \"X\"]\n"
                                                      "axis.X = { range_mm = [900, 100] }\naxis.Z = {}\n"))
                                   .setups.at(0)
                                   .plans.at(2);
  EXPECT_EQ(plan.kind, PlanKind::step_diagonal);
  EXPECT_EQ(plan.steps, 4U);
  EXPECT_EQ(plan.order, (std::vector<std::size_t>{2, 1}));
  EXPECT_EQ(plan.axes[1].from, 900);
  EXPECT_EQ(plan.axes[1].to, 100);
  const MeasurementPlan by_chain =
      parsed_study(with_plan("kind = \"step-diagonal\"\nsteps = 4\naxis.Z = {}\naxis.X = {}\n"))
          .setups.at(0)
          .plans.at(2);
  EXPECT_EQ(by_chain.order, (std::vector<std::size_t>{1, 2}));
}

TEST(StudyInstrument, SaysWhatIsWrongWithAStepDiagonal) {
  const auto wrong_plan = [](const std::string& plan) {
    return message_of([&] { parsed_study(with_plan("kind = \"step-diagonal\"\n" + plan)); });
  };
  const std::string axes = "axis.X = {}\naxis.Z = {}\n";
  EXPECT_NE(wrong_plan(axes).find("setup[1].plan[3].steps"), std::string::npos);
  EXPECT_NE(wrong_plan("steps = 0\n" + axes).find("steps"), std::string::npos);
  EXPECT_NE(wrong_plan("steps = 3\npoints = 7\n" + axes).find("points"), std::string::npos);
  EXPECT_NE(wrong_plan("steps = 3\norder = [\"X\"]\n" + axes).find("order: Z has a range and is missing"),
            std::string::npos);
  EXPECT_NE(wrong_plan("steps = 3\norder = [\"X\", \"C\", \"Z\"]\n" + axes).find("order: C does not move"),
            std::string::npos);
  EXPECT_NE(wrong_plan("steps = 3\norder = [\"X\", \"X\"]\n" + axes).find("order: X is given twice"),
            std::string::npos);
  EXPECT_NE(wrong_plan("steps = 3\naxis.X = {}\n").find("too few axes move"), std::string::npos);
}

TEST(StudyInstrument, PosesOfAFileNameTheirItems) {
  const Study study = parsed_study(with_plan("kind = \"poses\"\nfile = \"poses.csv\"\nrepeats = 2\n"));
  const abbe::Setup& bar = study.setups.at(0);
  EXPECT_EQ(bar.plans.at(2).kind, PlanKind::poses);
  EXPECT_EQ(bar.plans.at(2).file.filename(), "poses.csv");
  EXPECT_EQ(bar.plans.at(2).repeats, 2U);
  EXPECT_NE(message_of([] { parsed_study(with_plan("kind = \"poses\"\n")); }).find("setup[1].plan[3].file"),
            std::string::npos);

  const auto read = [&](const char* text) { return parse_planned_poses(text, "poses.csv", study.machine, bar); };
  const PlannedPoses all = read("C_deg,X_mm,Z_mm\n0,10,20\n90,30,40\n");
  EXPECT_EQ(all.poses.count(), 2U);
  EXPECT_EQ(all.poses.axis[1][1], 30);
  EXPECT_TRUE(all.target.empty());
  const PlannedPoses own = read("# planned\nC_deg,X_mm,Z_mm,setup,item\n0,10,20,other,B1\n90,30,40,bar,B2\n");
  EXPECT_EQ(own.poses.count(), 1U);
  EXPECT_EQ(own.target, (std::vector<std::size_t>{1}));
  EXPECT_NE(message_of([&] {
              read("C_deg,X_mm,Z_mm,item\n0,10,20,B1\n0,10,20,B9\n");
            }).find("poses.csv:3: item: 'B9' is not in the set-up 'bar'; expected one of B1, B2"),
            std::string::npos);
  EXPECT_NE(message_of([&] { read("C_deg,X_mm,Z_mm,setup\n0,10,20,other\n"); }).find("no pose for the set-up 'bar'"),
            std::string::npos);
  EXPECT_NE(message_of([&] { read("C_deg,X_mm,Z_mm\n0,10,900\n"); }).find("poses.csv:2"), std::string::npos);
}

TEST(StudyInstrument, PosesOfATrackersFileNameTheirStations) {
  const Study study = parsed_study(with_plan("kind = \"random\"\npoints = 4\naxis.X = {}\n"));
  TrackerSetup stations;
  stations.stations.resize(2);
  stations.stations[0].name = "S1";
  stations.stations[1].name = "S2";
  stations.reflectors.resize(1);
  stations.reflectors[0].name = "R1";
  abbe::Setup tracker;
  tracker.name = "tracker";
  tracker.device = std::make_shared<LaserTracker>("tracker", stations, TrackerMeasure::cartesian);
  const auto read = [&](const char* text) { return parse_planned_poses(text, "poses.csv", study.machine, tracker); };
  const PlannedPoses named = read("C_deg,X_mm,Z_mm,station\n0,10,20,S2\n90,30,40,S1\n");
  EXPECT_EQ(named.station, (std::vector<std::size_t>{1, 0}));
  EXPECT_TRUE(named.target.empty());
  EXPECT_EQ(read("C_deg,X_mm,Z_mm,station,reflector\n0,10,20,S2,R1\n").target, (std::vector<std::size_t>{0}));
  EXPECT_NE(message_of([&] {
              read("C_deg,X_mm,Z_mm,station\n0,10,20,S3\n");
            }).find("poses.csv:2: station: 'S3' is not in the set-up 'tracker'; expected one of S1, S2"),
            std::string::npos);
  // A plan of several kinds of instruments calls reflectors and items targets.
  EXPECT_EQ(read("C_deg,X_mm,Z_mm,setup,station,target\n0,10,20,bar,-,B1\n90,30,40,tracker,S2,R1\n").station,
            (std::vector<std::size_t>{1}));
  EXPECT_NE(message_of([&] {
              read("C_deg,X_mm,Z_mm,station,reflector,target\n0,10,20,S1,R1,R1\n");
            }).find("target: is given together with reflector"),
            std::string::npos);
  // With one station there is nothing to choose, with two there is.
  EXPECT_NE(message_of([&] {
              read("C_deg,X_mm,Z_mm\n0,10,20\n");
            }).find("poses.csv:2: station: is missing; expected one of S1, S2"),
            std::string::npos);
  stations.stations.pop_back();
  tracker.device = std::make_shared<LaserTracker>("tracker", stations, TrackerMeasure::cartesian);
  EXPECT_EQ(read("C_deg,X_mm,Z_mm\n0,10,20\n").station, (std::vector<std::size_t>{0}));
}

TEST(StudyInstrument, RefusesAFallingRangeWhereTheOrderSaysNothing) {
  const std::string message = message_of(
      [] { parsed_study(with_plan("kind = \"random\"\npoints = 4\naxis.X = { range_mm = [900, 100] }\n")); });
  EXPECT_NE(message.find("setup[1].plan[3].axis.X.range_mm: is falling"), std::string::npos) << message;
  EXPECT_EQ(parsed_study(with_plan("kind = \"line\"\npoints = 4\naxis.X = { range_mm = [900, 100] }\n"))
                .setups.at(0)
                .plans.at(2)
                .axes[1]
                .from,
            900);
}

}  // namespace
}  // namespace abbe
