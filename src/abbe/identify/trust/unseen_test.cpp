#include "abbe/identify/trust/unseen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/singular_values.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/parameter_words.h"
#include "abbe/identify/planning_candidates.h"
#include "abbe/instruments/autocollimator.h"
#include "abbe/instruments/ball_bar.h"
#include "abbe/instruments/board_marks.h"
#include "abbe/instruments/dial_indicators.h"
#include "abbe/instruments/electronic_level.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/interferometer.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/instruments/r_test.h"
#include "abbe/instruments/touch_probe.h"
#include "abbe/instruments/trackers/tracking_interferometer.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using ::testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

/// Errors of these names with value zero; error motions of linear axes of order 2 over their travel.
ErrorSet errors_named(const Machine& machine, const std::vector<std::string>& names) {
  ErrorSet errors;
  for (const std::string& name : names) {
    std::size_t axis = 0;
    Component component = Component::X;
    bool is_location = false;
    EXPECT_TRUE(parse_error_name(machine, name, axis, component, is_location)) << name;
    if (is_location) {
      errors.locations.push_back({axis, component, 0, 0});
      continue;
    }
    ErrorMotion motion;
    motion.axis = axis;
    motion.component = component;
    const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
    motion.basis.kind = rotary ? BasisKind::fourier : BasisKind::legendre;
    motion.basis.order = rotary ? 1 : 2;
    motion.basis.from = rotary ? 0 : machine.axes[axis].travel_min;
    if (rotary) motion.basis.period = 2 * kPi;
    motion.basis.to = rotary ? 2 * kPi : machine.axes[axis].travel_max;
    motion.coefficients.assign(motion.basis.size(), 0.0);
    errors.motions.push_back(motion);
  }
  return errors;
}

/// One instrument on one machine, its readings simulated, and what is to be identified from them.
class BlindStudy {
 public:
  BlindStudy(const Machine& machine, const std::vector<std::string>& errors,
             const std::shared_ptr<const Instrument>& device, const InstrumentReadings& plan)
      : errors_(errors_named(machine, errors)) {
    const InstrumentReadings readings = simulate_instrument(machine, errors_, device, plan, {}).readings;
    observations_ = std::make_unique<InstrumentObservations>(machine, errors_, device, readings);
    problem = estimate_everything(machine, errors_, {borrowed(*observations_)});
    problem.machine_parameters.resize(problem.machine_parameters.size() - 3);  // the tool offset error comes last
    std::size_t unknown = 0;
    for (const SetupQuantity& quantity : device->quantities()) {
      if (quantity.knowledge == Knowledge::exact) continue;
      if (quantity.knowledge == Knowledge::within)
        problem.priors.push_back({{0, unknown}, quantity.value, quantity.standard_uncertainty});
      ++unknown;
    }
    identified = identify(problem);
    possible = possible_measurements(problem);
    advice = unseen_advice(problem, identified, possible);
  }

  /// The first piece of advice whose direction holds an error of that name, or a convention if there is no other.
  const Advice* about(const std::string& error) const {
    for (const AdviceKind kind : {AdviceKind::not_measured, AdviceKind::weak, AdviceKind::convention})
      for (const Advice& one : advice)
        if (one.kind == kind && one.words.find(error + ":") != std::string::npos) return &one;
    return nullptr;
  }

  /// Readings and trial as one dense problem, each column scaled: how many directions nothing sees.
  std::size_t open_directions(const PossibleMeasurement* added) const {
    const PlanningCandidates ours = candidate_rows(problem);
    const Index p = ours.rows.cols(), own = added ? static_cast<Index>(added->own) : 0;
    const Index more = added ? added->rows.rows() : 0, known = static_cast<Index>(problem.priors.size());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(ours.rows.rows() + more + known, p + own);
    all.topLeftCorner(ours.rows.rows(), p) = ours.rows;
    if (added) all.middleRows(ours.rows.rows(), more) = added->rows;
    for (Index k = 0; k < known; ++k) {
      const Prior& prior = problem.priors[static_cast<std::size_t>(k)];
      all(ours.rows.rows() + more + k, static_cast<Index>(find_estimated(problem, prior.parameter))) =
          1 / prior.standard_uncertainty;
    }
    for (Index c = 0; c < all.cols(); ++c)
      if (all.col(c).norm() > 0) all.col(c).normalize();
    const Eigen::VectorXd values = right_singular(all).values;
    std::size_t open = static_cast<std::size_t>(all.cols() - values.size());
    for (const double value : values) open += value < 1e-9 * values[0] ? 1U : 0U;
    // Its own unknowns may keep a convention of their own.
    return open;
  }

  /// The measurement that a remedy names.
  const PossibleMeasurement* remedy(const Advice& one) const {
    for (const PossibleMeasurement& measurement : possible)
      if (one.remedy.find(measurement.words) == 0) return &measurement;
    return nullptr;
  }

  Problem problem;
  Identification identified;
  std::vector<PossibleMeasurement> possible;
  std::vector<Advice> advice;

 private:
  ErrorSet errors_;
  std::unique_ptr<InstrumentObservations> observations_;
};

/// The advice names the error, a measurement for it, and that measurement really leaves fewer directions open.
void expect_shown_by(const BlindStudy& study, const std::string& error, const std::string& words) {
  const std::size_t before = study.open_directions(nullptr);
  EXPECT_GT(before, 0u);
  std::string said;
  for (const Advice& one : study.advice) {
    if (one.kind != AdviceKind::not_measured || one.words.find(error + ":") == std::string::npos) continue;
    said += one.text + ": " + one.remedy + "\n";
    EXPECT_TRUE(one.shown) << one.text << ": " << one.remedy;
    const PossibleMeasurement* measurement = study.remedy(one);
    ASSERT_NE(measurement, nullptr) << one.remedy;
    // Unknowns of its own that stay open would count too.
    EXPECT_LT(study.open_directions(measurement), before + measurement->own) << one.remedy;
  }
  EXPECT_THAT(said, HasSubstr(words)) << error;
  EXPECT_FALSE(said.empty()) << error << " was seen";
}

InstrumentReadings at(const PoseList& poses, std::size_t item = 0) {
  InstrumentReadings plan;
  plan.poses.axis.resize(poses.axis.size());
  for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), item);
  return plan;
}

/// All axes at the middle of their travel (rotary: zero) but one, in equal steps over it.
PoseList along(const Machine& machine, const std::string& axis, std::size_t count, double from = 0.05,
               double to = 0.95) {
  std::vector<double> pose = test::middle(machine);
  PoseList poses;
  const std::size_t i = machine.find_axis(axis);
  const double low = machine.axes[i].endless ? 0 : machine.axes[i].travel_min;
  const double high = machine.axes[i].endless ? 2 * kPi : machine.axes[i].travel_max;
  for (std::size_t k = 0; k < count; ++k) {
    const double share = from + (to - from) * static_cast<double>(k) / static_cast<double>(count - 1);
    pose[i] = low + (high - low) * share;
    poses.append(pose);
  }
  return poses;
}

TEST(Unseen, a_ball_bar_on_circles_of_one_plane_is_told_to_go_through_the_others) {
  const Machine machine = test::three_axis_mill();
  BallBarSetup setup;
  setup.spindle_ball = SetupPoint::exact(machine.tool_offset);
  const std::vector<double> middle = test::middle(machine);
  setup.balls = {{"ball", SetupPoint::open(nominal_workpiece_from_tool(machine, middle).translation)}};
  const auto bar = std::make_shared<BallBar>(setup);
  CircleDescription circle;
  circle.radius = 100;
  circle.to_angle = 2 * kPi;
  circle.count = 37;
  const PoseList poses = circle_plan(machine, middle, Body::tool, Body::workpiece, *bar->meeting_points(0), circle);
  const BlindStudy study(machine, {"EC0Y", "EA0Z", "EB0Z"}, bar, at(poses));
  expect_shown_by(study, "EA0Z", "ballbar1 in other directions");
  EXPECT_EQ(study.about("EC0Y"), nullptr);  // the plane that was measured
  EXPECT_THAT(study.about("EB0Z")->words, HasSubstr("squareness or parallelism error of Z about Y"));
}

TEST(Unseen, an_r_test_with_one_axis_turning_is_told_to_turn_the_other) {
  const Machine machine = test::trunnion_mill();
  RTestSetup setup;
  setup.nest = SetupPoint::open({90, 20, 60});
  setup.spheres = {{"sphere", SetupPoint::exact(machine.tool_offset)}};
  for (int k = 0; k < 3; ++k) {
    setup.probes.emplace_back();
    setup.probes.back().name = std::string("p") + "xyz"[k];
    setup.probes.back().direction = Vector3d::Unit(k);
  }
  const auto nest = std::make_shared<RTest>(setup);
  const PoseList poses = follow_plan(machine, along(machine, "C", 24, 0, 0.96), Body::tool, Body::workpiece,
                                     *nest->meeting_points(0), Vector3d::Zero());
  const BlindStudy study(machine, {"EX0C", "EY0C", "EY0A", "EZ0A"}, nest, at(poses));
  expect_shown_by(study, "EZ0A", "moving A over its travel with rtest1");
  EXPECT_THAT(study.about("EZ0A")->words, HasSubstr("position error of the axis average line of A in Z"));
}

TEST(Unseen, a_probe_on_a_sphere_on_the_axis_is_told_to_put_it_elsewhere) {
  const Machine machine = test::trunnion_mill();
  TouchProbeSetup setup;
  setup.tip = SetupPoint::exact(machine.tool_offset);
  setup.spheres.emplace_back();
  setup.spheres[0].centre = SetupPoint::open({0, 0, 80});
  const auto probe = std::make_shared<TouchProbe>(setup);
  const PoseList poses = follow_plan(machine, along(machine, "C", 24, 0, 0.96), Body::tool, Body::workpiece,
                                     *probe->meeting_points(0), Vector3d::Zero());
  const BlindStudy study(machine, {"EXC", "EYC", "EZC", "ECC"}, probe, at(poses));
  expect_shown_by(study, "ECC", "at another place, 100 mm off in x");
  EXPECT_THAT(study.about("ECC")->words, HasSubstr("angular positioning error motion of C"));
}

TEST(Unseen, one_dial_on_a_plate_is_told_to_stand_elsewhere) {
  const Machine machine = test::three_axis_mill();
  DialIndicatorsSetup setup;
  std::vector<double> pose = test::middle(machine);
  setup.faces.emplace_back();
  setup.faces[0].point = nominal_workpiece_from_tool(machine, pose).translation;
  setup.faces[0].offset = SetupNumber::open(0);
  setup.arrangements.emplace_back();
  setup.arrangements[0].dials.emplace_back();
  setup.arrangements[0].dials[0].position = SetupPoint::exact(machine.tool_offset);
  setup.arrangements[0].dials[0].direction = Vector3d::UnitZ();
  const auto dial = std::make_shared<DialIndicators>(setup);
  const BlindStudy study(machine, {"EZX", "EAX"}, dial, at(along(machine, "X", 25)));
  const Advice* roll = study.about("EAX");
  ASSERT_NE(roll, nullptr);
  expect_shown_by(study, "EAX", "dial1 at another place, 100 mm off in y");
  EXPECT_THAT(roll->words, HasSubstr("roll error motion of X"));
}

TEST(Unseen, a_level_does_not_see_yaw_and_a_laser_does) {
  const Machine machine = test::three_axis_mill();
  ElectronicLevelSetup setup;
  setup.relative = true;
  setup.axes = {{"along_x", Vector3d::UnitX(), SetupNumber::open(0)},
                {"along_y", Vector3d::UnitY(), SetupNumber::open(0)}};
  const auto level = std::make_shared<ElectronicLevel>(setup);
  const BlindStudy study(machine, {"EAX", "EBX", "ECX"}, level, at(along(machine, "X", 25)));
  expect_shown_by(study, "ECX", "a laser interferometer along X");
  EXPECT_THAT(study.about("ECX")->words, HasSubstr("angular error motion of X about Z"));
  // The table as a whole may lie as it likes.
  bool constant = false;
  for (const Advice& one : study.advice)
    constant = constant || (one.kind == AdviceKind::convention && one.text.find("constant of EAX") == 0);
  EXPECT_TRUE(constant);
}

TEST(Unseen, an_autocollimator_does_not_see_roll_and_a_level_does) {
  const Machine machine = test::three_axis_mill();
  AutocollimatorSetup setup;
  setup.zero_first = setup.zero_second = SetupNumber::open(0);
  const auto collimator = std::make_shared<Autocollimator>(setup);
  const BlindStudy study(machine, {"EAX", "EBX", "ECX"}, collimator, at(along(machine, "X", 25)));
  expect_shown_by(study, "EAX", "an electronic level on the table while X moves");
}

TEST(Unseen, a_laser_that_measures_length_does_not_see_straightness) {
  const Machine machine = test::three_axis_mill();
  const std::vector<double> middle = test::middle(machine);
  InterferometerSetup setup;
  InterferometerRun run;
  run.optic = SetupPoint::exact(machine.tool_offset);
  run.origin = SetupPoint::exact(nominal_workpiece_from_tool(machine, middle).translation);
  run.direction = -Vector3d::UnitX();  // the table carries the workpiece away from the tool
  run.aligned_orientation = nominal_orientation(machine, middle, Body::tool, Body::workpiece);
  setup.runs = {run};
  const auto laser = std::make_shared<Interferometer>(setup);
  const BlindStudy study(machine, {"EXX", "EYX", "EZX"}, laser, at(along(machine, "X", 25)));
  const Advice* straightness = study.about("EYX");
  ASSERT_NE(straightness, nullptr);
  EXPECT_THAT(straightness->words, HasSubstr("straightness error motion of X in Y"));
  expect_shown_by(study, "EYX", "");
  expect_shown_by(study, "EZX", "");
}

TEST(Unseen, lengths_from_one_station_to_one_reflector_ask_for_another_reflector) {
  const Machine machine = test::three_axis_mill();
  TrackingInterferometerSetup setup;
  setup.stations.resize(1);
  setup.stations[0].position = SetupPoint::exact({-500, -400, 300});
  setup.reflectors.resize(1);
  setup.reflectors[0].offset = SetupPoint::exact(machine.tool_offset);
  setup.runs.resize(1);
  const auto lengths = std::make_shared<TrackingInterferometer>(setup);
  const BlindStudy study(machine, {"EXX", "EAX", "EBX", "ECX"}, lengths, at(along(machine, "X", 25)));
  expect_shown_by(study, "EAX", "");
  bool another = false;
  for (const Advice& one : study.advice)
    another = another || one.remedy.find("station1 at another place") == 0 || one.remedy.find("moving") == 0 ||
              one.remedy.find("reflector1 at another place") == 0;
  EXPECT_TRUE(another);
}

TEST(Unseen, marks_on_a_board_do_not_see_its_height) {
  const Machine machine = test::three_axis_mill();
  BoardMarksSetup setup;
  const std::vector<double> middle = test::middle(machine);
  setup.focus = SetupPoint::exact(machine.tool_offset);
  setup.boards.resize(1);
  setup.boards[0].position = SetupPoint::open(nominal_workpiece_from_tool(machine, middle).translation);
  const auto marks = std::make_shared<BoardMarks>(setup);
  const BlindStudy study(machine, {"EXX", "EYX", "EZX"}, marks, at(along(machine, "X", 25)));
  expect_shown_by(study, "EZX", "");
  bool set_up = false;
  for (const Advice& one : study.advice) set_up = set_up || one.kind == AdviceKind::set_up;
  EXPECT_TRUE(set_up);  // the board's height without widths
}

TEST(Unseen, what_only_a_prior_holds_is_said_so) {
  const Machine machine = test::three_axis_mill();
  ElectronicLevelSetup setup;
  setup.relative = true;
  setup.axes = {{"along_x", Vector3d::UnitX(), SetupNumber::exact(0)},
                {"along_y", Vector3d::UnitY(), SetupNumber::exact(0)}};
  const auto level = std::make_shared<ElectronicLevel>(setup);
  const InstrumentReadings plan = at(along(machine, "X", 25));
  BlindStudy study(machine, {"EAX", "ECX"}, level, plan);
  for (std::size_t i = 0; i < 6; ++i) study.problem.priors.push_back({{ParameterId::kMachine, i}, 0, 1e-4});
  study.identified = identify(study.problem);
  ASSERT_TRUE(study.identified.gauge.constraints.empty());
  study.advice = unseen_advice(study.problem, study.identified, study.possible);
  const Advice* yaw = study.about("ECX");
  ASSERT_NE(yaw, nullptr);
  EXPECT_FALSE(yaw->unseen);
  EXPECT_EQ(yaw->kind, AdviceKind::not_measured);
  EXPECT_THAT(yaw->text, HasSubstr("rests on prior knowledge alone"));
  EXPECT_TRUE(yaw->shown);
  EXPECT_GT(yaw->factor, 2);
  EXPECT_EQ(study.about("EAX"), nullptr);
}

TEST(Unseen, equal_entries_are_named_in_their_order_whatever_the_rounding) {
  Eigen::VectorXd direction(5);
  direction << 0.5, -0.5 * (1 + 1e-9), 0.05, -2, 0.5 * (1 - 1e-9);
  EXPECT_EQ(largest_entries(direction, 0.2), (std::vector<std::size_t>{3, 0, 1, 4}));
  EXPECT_EQ(largest_entries(1e-9 * direction, 0.02), (std::vector<std::size_t>{3, 0, 1, 4, 2}));
  EXPECT_TRUE(largest_entries(Eigen::VectorXd(), 0.2).empty());
}

TEST(Unseen, errors_have_their_words_in_the_standards) {
  const Machine machine = test::trunnion_mill();
  const auto words = [&](const char* name) {
    std::size_t axis = 0;
    Component component = Component::X;
    bool is_location = false;
    EXPECT_TRUE(parse_error_name(machine, name, axis, component, is_location));
    return error_words(machine, axis, component, is_location);
  };
  EXPECT_EQ(words("EXX"), "positioning error motion of X");
  EXPECT_EQ(words("EZX"), "straightness error motion of X in Z");
  EXPECT_EQ(words("EAX"), "roll error motion of X");
  EXPECT_EQ(words("ECX"), "angular error motion of X about Z");
  EXPECT_EQ(words("EZC"), "axial error motion of C");
  EXPECT_EQ(words("EXC"), "radial error motion of C in X");
  EXPECT_EQ(words("EAC"), "tilt error motion of C about X");
  EXPECT_EQ(words("ECC"), "angular positioning error motion of C");
  EXPECT_EQ(words("EB0A"), "orientation error of the axis average line of A about Y");
  EXPECT_EQ(words("EX0C"), "position error of the axis average line of C in X");
  EXPECT_EQ(words("EB0Z"), "squareness or parallelism error of Z about Y");
}

}  // namespace
}  // namespace abbe
