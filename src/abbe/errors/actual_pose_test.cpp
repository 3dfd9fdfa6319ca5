#include "abbe/errors/actual_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "abbe/errors/chain_plan_cases.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using chain_cases::random_vector;

/// A machine of 1 to 6 axes in any order, sense and (every other time) any direction, with errors in mixed bases.
struct MachineInPose {
  Machine machine;
  ErrorSet errors;
  std::vector<double> positions;
};

MachineInPose random_machine_in_pose(std::uint64_t seed, double size) {
  RandomStream random(seed);
  MachineInPose c;
  const std::size_t axes = 1 + random.bits() % 6;
  const std::size_t workpiece_side = random.bits() % (axes + 1);
  for (std::size_t i = 0; i < axes; ++i) {
    Axis axis;
    axis.name = std::string(1, "XYZABC"[random.bits() % 6]) + std::to_string(i + 1);
    axis_kind_from_letter(axis.name[0], axis.kind);
    axis.direction = direction_from_letter(axis.name[0]);
    if (seed % 2 == 0) axis.direction = random_vector(random, 1).normalized();
    axis.side = i < workpiece_side ? ChainSide::workpiece : ChainSide::tool;
    axis.primed = random.bits() % 2 == 0;
    axis.point = random_vector(random, 300);
    const bool rotary = axis.kind == AxisKind::rotary;
    axis.travel_min = rotary ? -2 : -300;
    axis.travel_max = rotary ? 2 : 300;
    c.positions.push_back(random.uniform(axis.travel_min, axis.travel_max));
    for (int k = 0; k < kComponentCount; ++k) {
      const Component component = static_cast<Component>(k);
      Basis basis{.kind = BasisKind::legendre, .order = 2, .from = axis.travel_min, .to = axis.travel_max};
      if (rotary) basis = {.kind = BasisKind::fourier, .order = 2, .from = -4, .to = 4, .period = 2 * std::numbers::pi};
      ErrorMotion motion{i, component, basis, std::vector<double>(basis.size()), {}};
      for (double& value : motion.coefficients) value = random.uniform(-size, size) * (k < 3 ? 1.0 : 1e-2);
      c.errors.motions.push_back(motion);
      if (location_error_is_valid(axis, component)) {
        c.errors.locations.push_back({i, component, random.uniform(-size, size) * (k < 3 ? 1.0 : 1e-2), 0});
      }
    }
    c.machine.axes.push_back(axis);
  }
  c.machine.tool_reference = random_vector(random, 200);
  c.machine.tool_offset = random_vector(random, 100);
  c.machine.bed_from_workpiece = {rotation_from_vector(random_vector(random, 1)), random_vector(random, 200)};
  c.errors.tool_offset_error = random_vector(random, size);
  return c;
}

TEST(ActualPose, ZeroErrorsGiveTheNominalPose) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const MachineInPose c = random_machine_in_pose(seed, 0);
    Deviation deviation;
    ASSERT_EQ(tool_deviation(c.machine, c.errors, c.positions, deviation), PoseStatus::ok);
    EXPECT_LE(deviation.head<3>().norm(), 1e-11);
    EXPECT_LE(deviation.tail<3>().norm(), 1e-14);
  }
}

TEST(ActualPose, JacobiansMatchCentralDifferences) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    MachineInPose c = random_machine_in_pose(seed, 0.5);
    Deviation deviation;
    Eigen::MatrixXd by_parameters, by_positions;
    ASSERT_EQ(tool_deviation(c.machine, c.errors, c.positions, deviation, &by_parameters, &by_positions),
              PoseStatus::ok);
    const auto pose = [&](const MachineInPose& at) {
      return actual_workpiece_from_tool(at.machine, at.errors, at.positions);
    };
    const auto difference = [](const RigidTransform& more, const RigidTransform& less, double step) {
      Deviation d;
      d.head<3>() = (more.translation - less.translation) / (2 * step);
      d.tail<3>() = rotation_vector(more.rotation * less.rotation.transpose()) / (2 * step);
      return d;
    };
    const std::vector<double> start = c.errors.parameters();
    const std::vector<bool> angle = parameters_are_angles(c.machine, c.errors);
    const std::vector<std::string> names = parameter_names(c.machine, c.errors);
    for (std::size_t k = 0; k < start.size(); ++k) {
      const double step = angle[k] ? 1e-6 : 1e-3;
      MachineInPose more = c, less = c;
      std::vector<double> values = start;
      values[k] = start[k] + step;
      more.errors.set_parameters(values);
      values[k] = start[k] - step;
      less.errors.set_parameters(values);
      const Deviation expected = difference(pose(more), pose(less), step);
      EXPECT_LE((by_parameters.col(static_cast<Eigen::Index>(k)) - expected).norm(), 1e-5 * (1 + expected.norm()))
          << names[k] << " of " << c.machine.chain() << " seed " << seed;
    }
    for (std::size_t k = 0; k < c.positions.size(); ++k) {
      const double step = c.machine.axes[k].kind == AxisKind::rotary ? 1e-6 : 1e-4;
      MachineInPose more = c, less = c;
      more.positions[k] += step;
      less.positions[k] -= step;
      const Deviation expected = difference(pose(more), pose(less), step);
      EXPECT_LE((by_positions.col(static_cast<Eigen::Index>(k)) - expected).norm(), 1e-5 * (1 + expected.norm()))
          << c.machine.axes[k].name << " of " << c.machine.chain() << " seed " << seed;
    }
  }
}

/// Of an axis that is parallel to none of X, Y, Z the part of its rotations (translations) along it.
void take_zero_positions_away(const Machine& machine, ErrorSet& errors) {
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    const auto effect = [&](const LocationError& location) {
      return location.axis == axis ? location_effect(machine.axes[axis], location.component).zero_position : 0.0;
    };
    double zero = 0;
    for (const LocationError& location : errors.locations) zero += effect(location) * location.value;
    for (LocationError& location : errors.locations) location.value -= effect(location) * zero;
  }
}

TEST(ActualPose, LocationErrorsMoveNothingWhileTheAxisIsAtZero) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    MachineInPose c = random_machine_in_pose(seed, 0.5);
    c.errors.motions.clear();
    c.errors.tool_offset_error.setZero();
    take_zero_positions_away(c.machine, c.errors);
    std::fill(c.positions.begin(), c.positions.end(), 0.0);
    Deviation deviation;
    tool_deviation(c.machine, c.errors, c.positions, deviation);
    EXPECT_LE(deviation.norm(), 1e-11);
  }
}

TEST(ActualPose, AnObliqueAxisHasTheLocationErrorsOfOneAlongZ) {
  // The same machine described in a base frame that is turned: a tilt of 10 urad and a zero position error of 0.2 rad.
  // (Angles about X, Y, Z are no vector, which is a matter of 1e-10 rad.)
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomStream random(seed, 4);
    MachineInPose c = random_machine_in_pose(1, 0);
    Axis& axis = c.machine.axes.front();
    axis.kind = seed % 2 == 0 ? AxisKind::rotary : AxisKind::linear;
    axis.direction = seed % 4 < 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(0, 0, -1);
    c.errors = ErrorSet{};
    const Component about = Component::C, along = Component::Z;
    const bool rotary = axis.kind == AxisKind::rotary;
    const double zero = 0.2;
    c.errors.locations = {
        {0, Component::A, 1e-5, 0}, {0, Component::B, -2e-5, 0}, {0, rotary ? about : along, zero, 0}};

    MachineInPose turned = c;
    const Eigen::Matrix3d turn = rotation_from_vector(random_vector(random, 2));
    for (Axis& each : turned.machine.axes) {
      each.direction = turn * each.direction;
      each.point = turn * each.point;
    }
    turned.machine.tool_reference = turn * c.machine.tool_reference;
    turned.machine.bed_from_workpiece = RigidTransform{turn, Eigen::Vector3d::Zero()} * c.machine.bed_from_workpiece;
    turned.machine.tool_offset = turn * c.machine.tool_offset;
    Eigen::Vector3d own = turned.machine.axes.front().direction;
    Eigen::Index nearest = 0;
    own.cwiseAbs().maxCoeff(&nearest);
    if (own[nearest] < 0) own = -own;
    Eigen::Vector3d rotations = turn * Eigen::Vector3d(1e-5, -2e-5, 0), translations = Eigen::Vector3d::Zero();
    (rotary ? rotations : translations) += zero * own;
    turned.errors.locations.clear();
    for (int k = 0; k < 3; ++k) {
      turned.errors.locations.push_back({0, static_cast<Component>(k + 3), rotations[k], 0});
      turned.errors.locations.push_back({0, static_cast<Component>(k), translations[k], 0});
    }
    const RigidTransform one = actual_workpiece_from_tool(c.machine, c.errors, c.positions);
    const RigidTransform other = actual_workpiece_from_tool(turned.machine, turned.errors, turned.positions);
    EXPECT_LT((other.translation - one.translation).norm(), 1e-6) << seed;
    EXPECT_LT((other.rotation - one.rotation * turn.transpose()).norm(), 1e-8) << seed;
  }
}

TEST(ActualPose, DoesNotDependOnTheBaseFrame) {
  // The same machine described in a machine frame that is moved (not turned: error motions are parallel to it).
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const MachineInPose c = random_machine_in_pose(seed, 0.5);
    MachineInPose moved = c;
    const Eigen::Vector3d shift(1234, -567, 89);
    for (Axis& axis : moved.machine.axes) axis.point += shift;
    moved.machine.tool_reference += shift;
    moved.machine.bed_from_workpiece.translation += shift;
    const RigidTransform a = actual_workpiece_from_tool(c.machine, c.errors, c.positions);
    const RigidTransform b = actual_workpiece_from_tool(moved.machine, moved.errors, moved.positions);
    EXPECT_LE((a.translation - b.translation).norm(), 1e-10);
    EXPECT_LE((a.rotation - b.rotation).norm(), 1e-13);
  }
}

TEST(ActualPose, SquarenessTurnsTheDirectionOfALinearAxis) {
  Machine machine;
  machine.axes = {{.name = "Y", .direction = Eigen::Vector3d::UnitY(), .travel_max = 500}};
  ErrorSet errors;
  errors.locations = {{0, Component::C, 20e-6, 0}};
  Deviation deviation;
  tool_deviation(machine, errors, {500}, deviation);
  // +20 urad about Z turns +Y towards -X: 10 um at 500 mm.
  EXPECT_NEAR(deviation[0], -0.010, 1e-9);
  EXPECT_EQ(deviation.tail<3>().norm(), 0);
}

TEST(ActualPose, AbbeOffsetTurnsAnAngleIntoAnError) {
  Machine machine;
  machine.axes = {{.name = "X", .travel_max = 500}};
  machine.tool_offset = {0, 0, -200};
  ErrorSet errors;
  errors.motions = {{0, Component::B, {.kind = BasisKind::monomial, .order = 0, .from = 0, .to = 500}, {50e-6}, {}}};
  Deviation deviation;
  tool_deviation(machine, errors, {100}, deviation);
  EXPECT_NEAR(deviation[0], -0.010, 1e-9);  // EB = 50 urad, 200 mm below the reference point
}

TEST(ActualPose, OutsideTheMeasuredRangeIsSaid) {
  MachineInPose c = random_machine_in_pose(5, 0.1);
  c.errors.motions[0].basis.to = c.positions[0] - 1;
  Deviation deviation;
  if (c.errors.motions[0].basis.kind == BasisKind::fourier) c.errors.motions[0].basis.from = c.positions[0] - 2;
  EXPECT_EQ(tool_deviation(c.machine, c.errors, c.positions, deviation), PoseStatus::out_of_range);
}

}  // namespace
}  // namespace abbe
