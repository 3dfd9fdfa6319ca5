#include "abbe/instruments/interferometer.h"

#include <Eigen/Geometry>
#include <numbers>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
using enum InterferometerComponent;

const std::vector<InterferometerComponent> kAll = {length, straightness_y, straightness_z, roll, pitch, yaw};

struct Ray {
  Vector3d at, along;  // along: unit
  double path = 0;

  double distance(const Vector3d& point, const Vector3d& normal) const {
    return normal.dot(point - at) / normal.dot(along);
  }
  void go(double length) {
    at += length * along;
    path += length;
  }
  void reflect(const Vector3d& point, const Vector3d& normal) {
    go(distance(point, normal));
    along -= 2 * normal.dot(along) * normal;
  }
  /// Three mirrors at right angles, open towards `opening`.
  void reflect_in_corner(const Vector3d& vertex, const Vector3d& opening) {
    Eigen::Matrix3d normals = rotation_between(Vector3d(1, 1, 1), opening);
    std::vector<int> left = {0, 1, 2};
    while (!left.empty()) {
      const auto nearest = std::min_element(left.begin(), left.end(), [&](int a, int b) {
        return distance(vertex, normals.col(a)) < distance(vertex, normals.col(b));
      });
      reflect(vertex, normals.col(*nearest));
      left.erase(nearest);
    }
  }
  void end_at(const Vector3d& point, const Vector3d& normal) { go(distance(point, normal)); }
};

/// A line along X of the trunnion machine with everything misaligned.
InterferometerSetup misaligned(std::vector<InterferometerComponent> components) {
  InterferometerSetup setup;
  setup.name = "laser";
  setup.components = std::move(components);
  InterferometerRun run;
  run.name = "X";
  run.optic = SetupPoint::within({12, -7, -90}, 0.5);
  run.origin = SetupPoint::within({-300, 4, 90}, 0.5);
  run.direction = {2, 0.1, -0.05};
  run.up = {0.1, 0, 1};
  run.alignment = {SetupNumber::open(0.002), SetupNumber::open(-0.001), SetupNumber::open(0.003)};
  setup.runs = {run};
  setup.length_scale = SetupNumber::within(2e-6, 1e-7);
  setup.straightness_scale = SetupNumber::within(-0.005, 0.005);
  setup.angle_scale = SetupNumber::within(0.002, 0.002);
  return setup;
}

InterferometerSetup without_scales(InterferometerSetup setup) {
  setup.length_scale = setup.straightness_scale = setup.angle_scale = SetupNumber::exact(0);
  return setup;
}

InstrumentReadings poses_of(const Machine& machine, std::size_t count, std::size_t items = 1, double share = 0.1) {
  // Rotary axes stay near zero: the optics see each other.
  std::vector<AxisRange> ranges = full_ranges(machine, 2);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (machine.axes[i].kind == AxisKind::rotary) ranges[i] = {share * ranges[i].from, share * ranges[i].to, 2, 0};
  }
  const PoseList poses = random_plan(machine, ranges, count, 3);
  InstrumentReadings plan;
  for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), k % items);
  return plan;
}

/// Beam axes as the header says, made of elementary rotations.
Eigen::Matrix3d axes_of(const InterferometerRun& run) {
  const Vector3d x = run.direction.normalized(), y = run.up.cross(x).normalized();
  Eigen::Matrix3d nominal;
  nominal << x, y, x.cross(y);
  return nominal * rotation_from_error_angles({run.alignment[0].value, run.alignment[1].value, run.alignment[2].value});
}

/// Body of the tool in the workpiece's frame, origin at the gauge point.
RigidTransform tool_of(const Machine& machine, const ErrorSet& errors, const std::vector<double>& pose) {
  RigidTransform tool = actual_workpiece_from_tool(machine, errors, pose);
  tool.translation = tool * Vector3d(-machine.tool_offset);
  return tool;
}

TEST(Interferometer, LengthIsHalfThePathTracedThroughACubeCorner) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const InterferometerSetup setup = without_scales(misaligned({length}));
  const InterferometerRun& run = setup.runs[0];
  const auto laser = std::make_shared<Interferometer>(setup);
  const InstrumentReadings readings = test::exact_readings(machine, errors, laser, poses_of(machine, 20));
  const Vector3d x = axes_of(run).col(0), origin = run.origin.value();
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const RigidTransform tool = tool_of(machine, errors, readings.poses.pose(k));
    const Vector3d vertex = tool * run.optic.value();
    // Enters the corner 2 mm beside the vertex, seen along the beam.
    const Vector3d beside = Vector3d(1.3, -0.4, 1.5);
    Ray ray{vertex - x * (1000 + x.dot(vertex - origin)) + (beside - x * x.dot(beside)), x};
    ray.reflect_in_corner(vertex, tool.rotation * Vector3d(-x));
    ray.end_at(origin - 1000 * x, x);
    EXPECT_NEAR(ray.along.dot(x), -1, 1e-12);
    EXPECT_NEAR(readings.measured[0][k], ray.path / 2 - 1000, 1e-9) << k;
  }
}

TEST(Interferometer, PlaneMirrorLengthIsAQuarterOfThePathOfTwoReflections) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  InterferometerSetup setup = without_scales(misaligned({length}));
  setup.runs[0].target = LengthTarget::plane_mirror;
  setup.runs[0].origin = SetupPoint::exact({-3000, 4, 90});
  const InterferometerRun& run = setup.runs[0];
  const auto laser = std::make_shared<Interferometer>(setup);
  const InstrumentReadings readings = test::exact_readings(machine, errors, laser, poses_of(machine, 20, 1, 0.001));
  const Eigen::Matrix3d axes = axes_of(run);
  const Vector3d x = axes.col(0), corner = run.origin.value();
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const RigidTransform tool = tool_of(machine, errors, readings.poses.pose(k));
    const Vector3d mirror = tool * run.optic.value(), normal = tool.rotation * x;
    // The fixed cube corner sits beside the outgoing beam and sends the reflected one back to the mirror.
    Ray ray{corner + 8 * axes.col(1), x};
    ray.reflect(mirror, normal);
    ray.reflect_in_corner(corner, x);
    ray.reflect(mirror, normal);
    ray.end_at(corner, x);
    EXPECT_NEAR(ray.along.dot(x), -1, 1e-12);
    EXPECT_NEAR(readings.measured[0][k], ray.path / 4, 1e-8) << k;
  }
}

TEST(Interferometer, StraightnessIsThePathDifferenceOfTheTwoBeamsOfAWollastonPrism) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::some_errors(machine);
  for (const bool moves : {false, true}) {
    InterferometerSetup setup = without_scales(misaligned({straightness_y, straightness_z}));
    setup.runs[0].straightness_reflector_moves = moves;
    const InterferometerRun& run = setup.runs[0];
    const auto laser = std::make_shared<Interferometer>(setup);
    const InstrumentReadings readings = test::exact_readings(machine, errors, laser, poses_of(machine, 20));
    const Eigen::Matrix3d axes = axes_of(run);
    const double half = 0.75 * std::numbers::pi / 180;
    for (std::size_t k = 0; k < readings.count(); ++k) {
      const RigidTransform tool = tool_of(machine, errors, readings.poses.pose(k));
      const Vector3d optic = tool * run.optic.value(), origin = run.origin.value();
      const Eigen::Matrix3d reflector = moves ? Eigen::Matrix3d(tool.rotation * axes) : axes;
      const Vector3d prism = moves ? origin : optic, apex = moves ? optic : origin;
      for (int direction = 1; direction <= 2; ++direction) {
        double path[2];
        for (const int side : {0, 1}) {
          const double sign = side == 0 ? 1 : -1;
          // Beams leave along the mirrors' normals; the mirrors stand far beyond the prism.
          const Vector3d normal = std::cos(half) * reflector.col(0) + sign * std::sin(half) * reflector.col(direction);
          Ray ray{prism, normal};
          ray.reflect(apex + 5000 * reflector.col(0), normal);
          ray.end_at(prism, normal);
          path[side] = ray.path;
        }
        const double traced = (moves ? -1 : 1) * (path[1] - path[0]) / (4 * std::sin(half));
        EXPECT_NEAR(readings.measured[static_cast<std::size_t>(direction - 1)][k], traced, 1e-8) << k;
      }
    }
  }
}

TEST(Interferometer, PitchAndYawAreThePathDifferenceOfTwoCubeCornersOnTheMovingBody) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const InterferometerSetup setup = without_scales(misaligned({pitch, yaw, roll}));
  const InterferometerRun& run = setup.runs[0];
  const auto laser = std::make_shared<Interferometer>(setup);
  const InstrumentReadings readings = test::exact_readings(machine, errors, laser, poses_of(machine, 20, 1, 0.02));
  const Eigen::Matrix3d axes = axes_of(run);
  const Vector3d x = axes.col(0);
  constexpr double kBase = 32;  // mm
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const RigidTransform tool = tool_of(machine, errors, readings.poses.pose(k));
    const auto angle = [&](const Vector3d& base) {
      double path[2];
      for (const int side : {0, 1}) {
        const Vector3d vertex = tool * Vector3d(run.optic.value() + (side - 0.5) * kBase * base);
        Ray ray{vertex - 4000 * x + 2 * axes.col(1) - axes.col(2), x};
        const Vector3d start = run.origin.value() - 4000 * x;
        ray.at -= x * x.dot(ray.at - start);
        ray.reflect_in_corner(vertex, -x);
        ray.end_at(start, x);
        path[side] = ray.path;
      }
      return std::asin((path[1] - path[0]) / (2 * kBase));
    };
    EXPECT_NEAR(readings.measured[0][k], angle(axes.col(2)), 1e-10) << k;
    EXPECT_NEAR(readings.measured[1][k], angle(-axes.col(1)), 1e-10) << k;
    // Roll: by the rotation vector, to second order in the other two angles.
    const Vector3d turn = axes.transpose() * rotation_vector(tool.rotation);
    EXPECT_NEAR(readings.measured[2][k], turn.x(), 0.6 * turn.squaredNorm() + 1e-12) << k;
  }
}

TEST(Interferometer, ASixComponentRunSeesTheSixErrorMotionsOfItsAxis) {
  Machine machine = test::single_axis("w b X t");
  machine.axes[0].point = machine.tool_reference;  // no lever between error motions and optic
  const double from = machine.axes[0].travel_min, to = machine.axes[0].travel_max;
  RandomErrorOptions options;
  options.locations = false;
  const ErrorSet errors = random_errors(machine, options);
  InterferometerSetup setup;
  setup.components = kAll;
  setup.runs.resize(1);
  setup.runs[0].origin = SetupPoint::exact(machine.tool_reference);
  const auto laser = std::make_shared<Interferometer>(setup);
  InstrumentReadings plan;
  for (const double position : evenly_spaced(from, to, 9)) plan.append({position}, 0);
  const InstrumentReadings readings = test::exact_readings(machine, errors, laser, plan);
  for (std::size_t k = 0; k < plan.count(); ++k) {
    const double position = plan.poses.axis[0][k];
    const std::array<double, 6> motion = errors.evaluate(0, position);
    EXPECT_NEAR(readings.measured[0][k], position + motion[0], 1e-10);
    EXPECT_NEAR(readings.measured[1][k], motion[1], 1e-10);
    EXPECT_NEAR(readings.measured[2][k], motion[2], 1e-10);
    // Angles to the products of two of them.
    for (std::size_t row = 3; row < 6; ++row) EXPECT_NEAR(readings.measured[row][k], motion[row], 1e-8) << row;
  }
}

TEST(Interferometer, AnOpticalSquareTurnsTheReferenceByItsAngle) {
  const Machine machine = test::three_axis_mill();
  InterferometerSetup setup;
  setup.components = {straightness_y, straightness_z};
  InterferometerRun along_x, along_y;
  along_x.name = "X";
  along_x.alignment[1] = SetupNumber::exact(0.0007);
  along_x.alignment[2] = SetupNumber::exact(0.0003);
  along_y.name = "Y";
  along_y.direction = {0, 1, 0};
  along_y.square_with = "X";
  along_y.square_angle = SetupNumber::exact(20e-6);
  setup.runs = {along_x, along_y};
  const auto laser = std::make_shared<Interferometer>(setup);
  ErrorSet errors;
  errors.locations = {{machine.find_axis("Y"), Component::C, 50e-6, 0}};
  InstrumentReadings plan;
  const std::size_t x = machine.find_axis("X"), y = machine.find_axis("Y");
  for (const std::size_t item : {std::size_t{0}, std::size_t{1}}) {
    for (const double q : {50.0, 350.0}) {
      std::vector<double> pose(3, 0.0);
      pose[item == 0 ? x : y] = q;
      plan.append(pose, item);
    }
  }
  const std::vector<double> seen = test::exact_readings(machine, errors, laser, plan).measured[0];
  // Deviation of the axes from a right angle: turn of the second line minus turn of the first, against the square.
  const double turn_x = (seen[1] - seen[0]) / 300, turn_y = (seen[3] - seen[2]) / 300;
  // Actual directions of the tool in the workpiece by distances between poses.
  const auto direction = [&](std::size_t first) {
    return Vector3d(actual_workpiece_from_tool(machine, errors, plan.poses.pose(first + 1)).translation -
                    actual_workpiece_from_tool(machine, errors, plan.poses.pose(first)).translation)
        .normalized();
  };
  const double beyond_right_angle = std::acos(direction(0).dot(direction(2))) - std::numbers::pi / 2;
  EXPECT_NEAR(std::abs(beyond_right_angle), 50e-6, 1e-8);
  EXPECT_NEAR(turn_y - turn_x, beyond_right_angle - 20e-6, 1e-8);
}

TEST(Interferometer, DerivativesEqualDifferences) {
  for (const Machine& machine : {test::trunnion_mill(), test::head_table_mill(), test::gantry_fork_head(),
                                 test::moving_table_cmm(), test::wang_grinder()}) {
    InterferometerSetup setup = misaligned(kAll);
    InterferometerRun square = setup.runs[0];
    square.name = "Y";
    square.direction = {0.02, 1, 0.01};
    square.square_with = "X";
    square.square_angle = SetupNumber::within(3e-5, 1e-6);
    square.bidirectional = true;
    InterferometerRun mirror = setup.runs[0];
    mirror.name = "mirror";
    mirror.target = LengthTarget::plane_mirror;
    mirror.straightness_reflector_moves = true;
    InterferometerRun table = setup.runs[0];
    table.name = "table";
    table.moving_body = Body::bed;
    table.optic = SetupPoint::open({100, 50, 20});
    setup.runs.push_back(square);
    setup.runs.push_back(mirror);
    if (machine.workpiece_axis_count() > 0) setup.runs.push_back(table);
    const auto laser = std::make_shared<Interferometer>(setup);
    const std::size_t items = laser->items().size();
    // Angles near a right angle have no derivative: the rotary axes stay near zero.
    test::expect_jacobian_equals_differences(machine, test::some_errors(machine), laser,
                                             poses_of(machine, 5 * items, items, 0.02), 5e-7);
  }
}

TEST(Interferometer, BothDirectionsOfABidirectionalRunShareTheirZeroAndDifferByTheReversal) {
  const Machine machine = test::three_axis_mill();
  InterferometerSetup setup = misaligned({length, pitch});
  setup.runs[0].bidirectional = true;
  std::shared_ptr<const Instrument> laser = std::make_shared<Interferometer>(setup);
  ASSERT_EQ(laser->items().size(), 2u);
  EXPECT_EQ(laser->items()[0].name, "X+");
  EXPECT_EQ(laser->items()[1].name, "X-");
  std::vector<double> values;
  for (const SetupQuantity& quantity : laser->quantities()) {
    values.push_back(quantity.name == "X.length.reversal"  ? 0.004
                     : quantity.name == "X.pitch.reversal" ? 3e-6
                                                           : quantity.value);
  }
  laser = laser->with_values(values);
  InstrumentReadings plan;
  for (const std::size_t item : {std::size_t{0}, std::size_t{1}}) plan.append({300, 100, -50}, item);
  const InstrumentReadings readings = test::exact_readings(machine, test::some_errors(machine), laser, plan);
  EXPECT_NEAR(readings.measured[0][0] - readings.measured[0][1], 0.004, 1e-12);
  EXPECT_NEAR(readings.measured[1][0] - readings.measured[1][1], 3e-6, 1e-15);
}

TEST(Interferometer, ZerosAreFoundFromTheReadingsAndAReversedSignIsNoted) {
  const Machine machine = test::three_axis_mill();
  InterferometerSetup setup;
  setup.components = {length, yaw};
  setup.runs.resize(1);
  const auto laser = std::make_shared<Interferometer>(setup);
  InstrumentReadings plan;
  for (const double x : evenly_spaced(0, 760, 11)) plan.append({x, 0, 0}, 0);
  InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, laser, plan);
  // Displacement from the first reading, one gross error.
  const double first = readings.measured[0][0];
  for (double& value : readings.measured[0]) value -= first;
  readings.measured[0][4] += 5;
  std::vector<std::string> notes;
  const std::vector<double> start = laser->start_values(machine, readings, notes);
  EXPECT_TRUE(notes.empty());
  for (std::size_t q = 0; q < start.size(); ++q) {
    const std::string& name = laser->quantities()[q].name;
    EXPECT_NEAR(start[q], name == "run1.length.zero" ? -first : 0, 1e-9) << name;
  }
  for (double& value : readings.measured[0]) value = -value;
  laser->start_values(machine, readings, notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("run1: the indicated length falls"), std::string::npos);
}

TEST(Interferometer, NoiseOfALengthGrowsWithThePathAndItsDeadPart) {
  InterferometerSetup setup;
  setup.components = {length, straightness_z, pitch};
  setup.runs.resize(1);
  setup.runs[0].dead_path = 100;
  setup.length_noise = 1e-4;
  setup.length_noise_per_length = 1e-7;
  const Interferometer laser(setup);
  InstrumentReadings readings;
  readings.append({-400, 0, 0}, 0);
  readings.measured = {{-400}, {0}, {0}};
  EXPECT_NEAR(laser.standard_uncertainty(readings, 0, 0), 1.5e-4, 1e-12);
  EXPECT_EQ(laser.standard_uncertainty(readings, 0, 1), setup.straightness_noise);
  EXPECT_EQ(laser.standard_uncertainty(readings, 0, 2), setup.angle_noise);
}

TEST(Interferometer, SetupsThatCannotBeAreRefused) {
  const auto message = [](const InterferometerSetup& setup) -> std::string {
    try {
      const Interferometer laser(setup);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  InterferometerSetup good;
  good.runs.resize(2);
  good.runs[1].name = "Y";
  good.runs[1].direction = {0, 1, 0};
  EXPECT_EQ(message(good), "");
  InterferometerSetup bad = good;
  bad.runs.clear();
  EXPECT_EQ(message(bad), "laser1: no run");
  bad = good;
  bad.components = {pitch, length, pitch};
  EXPECT_EQ(message(bad), "laser1: pitch is measured twice");
  bad = good;
  bad.runs[1].direction.setZero();
  EXPECT_EQ(message(bad), "Y: direction without length");
  bad = good;
  bad.runs[1].up = {0, 3, 0};
  EXPECT_EQ(message(bad), "Y: `up` lies along the direction of the beam");
  bad = good;
  bad.runs[1].square_with = "Z";
  EXPECT_EQ(message(bad), "Y: no earlier run Z to be square with");
  bad = good;
  bad.runs[1].square_with = "run1";
  EXPECT_EQ(message(bad), "");
  bad.runs[1].reference_body = Body::bed;
  EXPECT_EQ(message(bad), "Y: the straightness reflector has to stand on one body for both runs");
  bad = good;
  bad.runs[1].direction = {-1, 0, 0};
  bad.runs[1].square_with = "run1";
  EXPECT_EQ(message(bad), "Y: parallel to run1");
}

}  // namespace
}  // namespace abbe
