#include <Eigen/Eigenvalues>
#include <cstring>
#include <limits>
#include <random>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/runtime/allocations_for_test.h"
#include "abbe/runtime/frozen_for_test.h"
#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_uncertainty.h"

namespace abbe {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A trunnion mill with errors that are linear in the positions, and a covariance with correlations.
struct Uncertain {
  Uncertain() : machine(test::trunnion_mill()), errors(test::tens_of_micrometres(machine, 3)) {
    options.tool = machine.tool_offset;
    options.tool_length_min = 100;
    options.tool_length_max = 200;
    options.poses = 30;
    const auto n = static_cast<Eigen::Index>(errors.parameter_count());
    std::mt19937_64 generator(4);
    std::normal_distribution<double> normal(0, 2e-6);
    Eigen::MatrixXd root(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < 3; ++k) root(i, k) = normal(generator);
    }
    options.covariance = root * root.transpose();
    options.covariance.diagonal().array() += 1e-12;
  }

  /// By finite differences of the actual pose, with the tool itself in the machine.
  double uncertainty(const std::vector<double>& position, double length) const {
    Machine with_tool = machine;
    with_tool.tool_offset = -length * machine.tool_direction;
    const std::vector<double> values = errors.parameters();
    Eigen::MatrixXd by_parameters(3, static_cast<Eigen::Index>(values.size()));
    for (std::size_t p = 0; p < values.size(); ++p) {
      constexpr double kStep = 1e-6;
      std::vector<double> up = values, down = values;
      up[p] += kStep;
      down[p] -= kStep;
      ErrorSet changed = errors;
      changed.set_parameters(up);
      const Eigen::Vector3d above = actual_workpiece_from_tool(with_tool, changed, position).translation;
      changed.set_parameters(down);
      const Eigen::Vector3d below = actual_workpiece_from_tool(with_tool, changed, position).translation;
      by_parameters.col(static_cast<Eigen::Index>(p)) = (above - below) / (2 * kStep);
    }
    const Eigen::Matrix3d spread = by_parameters * options.covariance * by_parameters.transpose();
    return std::sqrt(SymmetricEigen<3>(spread).eigenvalues()[2]);
  }

  Machine machine;
  ErrorSet errors;
  FreezeOptions options;
};

const FrozenCompensation& frozen_once() {
  static const FrozenCompensation frozen = [] {
    const Uncertain made;
    return freeze(made.machine, made.errors, made.options);
  }();
  return frozen;
}

TEST(RuntimeUncertainty, IsThatOfTheParametersThroughTheChain) {
  const Uncertain made;
  const FrozenCompensation& frozen = frozen_once();
  ASSERT_EQ(frozen.problem, "");
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  abbe_runtime_information about;
  abbe_runtime_describe(runtime.get(), &about);
  EXPECT_EQ(about.has_uncertainty, 1);
  EXPECT_EQ(about.largest_uncertainty_mm, frozen.largest_uncertainty);
  EXPECT_GT(frozen.largest_uncertainty, frozen.mean_uncertainty);
  EXPECT_GT(frozen.mean_uncertainty, 0);
  std::mt19937_64 generator(8);
  double largest = 0, nodes = 0;
  for (int i = 0; i < 40; ++i) {
    std::vector<double> position;
    const bool in_node = i % 2 == 0;
    for (const Axis& axis : made.machine.axes) {
      const double from = axis.endless ? -kPi : axis.travel_min, to = axis.endless ? kPi : axis.travel_max;
      // A quarter is a node of five and of nine.
      const double share = in_node ? 0.25 * static_cast<double>(generator() % 5)
                                   : std::uniform_real_distribution<double>(0, 1)(generator);
      position.push_back(from + share * (to - from));
    }
    const double length = in_node ? 150 : std::uniform_real_distribution<double>(100, 200)(generator);
    const Eigen::Vector3d tool = -length * made.machine.tool_direction;
    double found = 0;
    EXPECT_EQ(abbe_runtime_uncertainty(runtime.get(), position.data(), tool.data(), &found), ABBE_OK);
    const double difference = std::abs(found - made.uncertainty(position, length));
    (in_node ? nodes : largest) = std::max(in_node ? nodes : largest, difference);
  }
  // To first order: the tool is turned by the errors as well, by 1e-4.
  EXPECT_LT(nodes, 5e-4 * about.largest_uncertainty_mm);
  EXPECT_LT(largest, 1.5 * about.uncertainty_lattice_mm);
  EXPECT_LT(about.uncertainty_lattice_mm, 0.5 * about.mean_uncertainty_mm);
}

TEST(RuntimeUncertainty, StaysAtTheEndsAndTurnsWithEndlessAxes) {
  const Uncertain made;
  const test::RuntimePointer runtime = test::loaded(frozen_once().bytes);
  const auto at = [&](std::vector<double> joints, double length, int expected) {
    const Eigen::Vector3d tool = -length * made.machine.tool_direction;
    double found = -1;
    EXPECT_EQ(abbe_runtime_uncertainty(runtime.get(), joints.data(), tool.data(), &found), expected);
    return found;
  };
  const std::size_t z = made.machine.find_axis("Z"), c = made.machine.find_axis("C");
  std::vector<double> joints(5, 0.0);
  joints[z] = -510;
  const double end = at(joints, 150, ABBE_OK);
  joints[z] = -520;
  EXPECT_EQ(at(joints, 150, ABBE_OUTSIDE_MAP | ABBE_OUTSIDE_TRAVEL), end);
  joints[z] = -100;
  joints[c] = 0.3;
  const double turned = at(joints, 150, ABBE_OK);
  joints[c] = 0.3 - 4 * kPi;
  EXPECT_NEAR(at(joints, 150, ABBE_OK), turned, 1e-12);
  EXPECT_EQ(at(joints, 250, ABBE_OUTSIDE_TOOL), at(joints, 200, ABBE_OK));
  joints[c] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(at(joints, 150, ABBE_NOT_FINITE), -1);
  double found = 0;
  EXPECT_EQ(abbe_runtime_uncertainty(nullptr, joints.data(), nullptr, &found), ABBE_NULL);
}

TEST(RuntimeUncertainty, ToolsAndAxesThatTheLatticeLeavesOutAreFlaggedAsWell) {
  Uncertain made;
  made.options.tool_length_min = 100;
  made.options.tool_length_max = 100;
  const std::size_t x = made.machine.find_axis("X");
  made.machine.axes[x].travel_min = made.machine.axes[x].travel_max = 20;
  const FrozenCompensation frozen = freeze(made.machine, made.errors, made.options);
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  std::vector<double> joints(made.machine.axes.size(), 0.0);
  joints[x] = 20;
  const auto result = [&](double length) {
    const Eigen::Vector3d tool = -length * made.machine.tool_direction;
    double found = 0;
    return abbe_runtime_uncertainty(runtime.get(), joints.data(), tool.data(), &found);
  };
  EXPECT_EQ(result(100), ABBE_OK);
  EXPECT_EQ(result(300), ABBE_OUTSIDE_TOOL);
  EXPECT_EQ(result(99), ABBE_OUTSIDE_TOOL);
  joints[x] = 21;
  EXPECT_EQ(result(100), ABBE_OUTSIDE_TRAVEL);
}

TEST(RuntimeUncertainty, WhatTheLatticeLeavesOutIsInTheDifferenceThatIsStated) {
  // Eight axes: the one nearest the workpiece is not in the lattice, and the uncertainty is that of a slope over it:
  // zero in its middle.
  Machine machine;
  machine.name = "eight";
  for (const char* name : {"X1", "Y1", "Z1", "X", "Y", "Z", "U", "V"}) {
    Axis axis;
    axis.name = name;
    axis.side = machine.axes.empty() ? ChainSide::workpiece : ChainSide::tool;
    axis.kind = AxisKind::linear;
    axis.direction = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(machine.axes.size() % 3));
    axis.travel_min = -100;
    axis.travel_max = 100;
    machine.axes.push_back(axis);
  }
  ErrorSet errors;
  errors.motions.push_back({0, Component::X, {BasisKind::legendre, 1, -100, 100}, {0, 0}, {}});
  FreezeOptions options;
  options.poses = 5;
  options.tool_length_max = 0;
  options.covariance = Eigen::MatrixXd::Zero(5, 5);
  options.covariance(1, 1) = 1e-6;
  const FrozenCompensation frozen = freeze(machine, errors, options);
  ASSERT_EQ(frozen.problem, "");
  EXPECT_GT(frozen.largest_uncertainty, 0);
  EXPECT_NEAR(frozen.uncertainty_lattice, frozen.largest_uncertainty, 1e-9);
}

TEST(RuntimeUncertainty, AllocatesNothing) {
  const test::RuntimePointer runtime = test::loaded(frozen_once().bytes);
  const double joints[5] = {0.1, -0.2, 10, 20, -30};
  double found = 0;
  const long before = test::allocations();
  for (int i = 0; i < 100; ++i) ASSERT_EQ(abbe_runtime_uncertainty(runtime.get(), joints, nullptr, &found), ABBE_OK);
  EXPECT_EQ(test::allocations(), before);
}

TEST(RuntimeUncertainty, IsNotStatedWithoutThoseOfTheErrors) {
  const Uncertain made;
  const test::RuntimePointer runtime = test::runtime_of(made.machine, made.errors);
  const double joints[5] = {};
  double found = -1;
  EXPECT_EQ(abbe_runtime_uncertainty(runtime.get(), joints, nullptr, &found), ABBE_NOT_STATED);
  EXPECT_EQ(found, -1);
  FreezeOptions wrong = made.options;
  wrong.covariance = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_NE(freeze(made.machine, made.errors, wrong).problem, "");
}

TEST(RuntimeUncertainty, FilesOfTheVersionBeforeAndBrokenLatticesAreRefused) {
  const std::vector<unsigned char> sound = frozen_once().bytes;
  abbe_runtime* runtime = nullptr;
  char text[200];
  std::vector<unsigned char> old = sound;
  old[frozen::kFormatAt] = 1;
  EXPECT_EQ(abbe_runtime_load(old.data(), old.size(), text, sizeof text, &runtime), ABBE_FILE_VERSION);
  EXPECT_STREQ(text, "the file has another version of the format: freeze the compensation again");
  // Behind the groups, to the end: values, dimensions (five axes and the tool), one uncertainty per node.
  using namespace frozen;
  const auto value_at = [&](std::size_t place) {
    double value = 0;
    std::memcpy(&value, sound.data() + kHeaderBytes + 8 * place, sizeof value);
    return value;
  };
  const std::size_t count = (sound.size() - kHeaderBytes) / 8;
  std::size_t dimension = 0;
  for (std::size_t at = kMachineValues; at + 6 * kDimensionValues < count && dimension == 0; ++at) {
    double nodes = 1;
    for (std::size_t k = 0; k < 6; ++k) nodes *= value_at(at + k * kDimensionValues + kNodes);
    const bool ends = nodes == static_cast<double>(count - at - 6 * kDimensionValues);
    if (ends &&
        value_at(at + 5 * kDimensionValues + kDimensionAxis) == static_cast<double>(FrozenUncertainty::kToolLength))
      dimension = at;
  }
  ASSERT_GT(dimension, 0U);
  const std::size_t first = dimension - kUncertaintyValues;
  ASSERT_EQ(value_at(first + kDimensions), 6);
  const struct {
    std::size_t place;
    double value;
  } changes[] = {{first + kDimensions, 9},
                 {first + kDimensions, 5},
                 {first + kUncertainties, -1},
                 {dimension + kDimensionAxis, 7},
                 {dimension + kNodes, 1},
                 {dimension + kNodes, 1e5},
                 {dimension + kEnds + 1, value_at(dimension + kEnds)},
                 {dimension + kPeriodic, 2},
                 {count - 1, -1}};
  for (const auto& change : changes) {
    std::vector<unsigned char> broken = sound;
    std::memcpy(broken.data() + kHeaderBytes + 8 * change.place, &change.value, sizeof change.value);
    const std::uint64_t sum = checksum(broken.data(), broken.size());
    std::memcpy(broken.data() + kChecksumAt, &sum, sizeof sum);
    EXPECT_EQ(abbe_runtime_load(broken.data(), broken.size(), text, sizeof text, &runtime), ABBE_FILE_CONTENT)
        << change.place - first << " " << change.value;
    EXPECT_STREQ(text, "the content of the file is not usable: uncertainty of the correction");
  }
}

}  // namespace
}  // namespace abbe
