#include "abbe/errors/pose_model.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/errors/random_stream.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

constexpr std::size_t kPoses = 2 * ChainPlan::kBlockSize + 3;

/// Random commands within the travel, and arrays for what comes out.
struct PoseModelCase {
  explicit PoseModelCase(const Machine& machine) : commands(machine.axes.size(), std::vector<double>(kPoses)) {
    RandomStream random(5);
    for (std::size_t i = 0; i < commands.size(); ++i) {
      const Axis& axis = machine.axes[i];
      for (double& value : commands[i]) value = random.uniform(axis.travel_min, axis.travel_max);
      pointers.push_back(commands[i].data());
    }
    for (std::vector<double>& values : out) values.resize(kPoses);
  }
  PositionArrays positions() const { return {pointers, kPoses}; }
  PointArrays points() { return {out[0].data(), out[1].data(), out[2].data()}; }
  RotationArrays rotations() {
    RotationArrays arrays;
    for (std::size_t e = 0; e < 9; ++e) arrays.r[e] = out[3 + e].data();
    return arrays;
  }
  std::vector<double> pose(std::size_t k) const {
    std::vector<double> result;
    for (const std::vector<double>& values : commands) result.push_back(values[k]);
    return result;
  }
  void expect_near(const RigidTransform& expected, std::size_t k) const {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(out[c][k], expected.translation[static_cast<Eigen::Index>(c)], 1e-9);
      for (std::size_t d = 0; d < 3; ++d) {
        EXPECT_NEAR(out[3 + 3 * c + d][k],
                    expected.rotation(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(d)), 1e-12);
      }
    }
  }

  std::vector<std::vector<double>> commands;
  std::vector<const double*> pointers;
  std::array<std::vector<double>, 12> out;
};

TEST(PoseModel, AgreesWithSinglePosesOnAllMachines) {
  for (const test::NamedMachine& named : test::all_machines()) {
    SCOPED_TRACE(named.name);
    const Machine& machine = named.machine;
    RandomErrorOptions options;
    options.seed = 3;
    options.constant_terms = true;
    ErrorSet errors = random_errors(machine, options);
    errors.tool_offset_error = {0.02, -0.03, 0.01};
    const PoseModel model(machine, errors);
    PoseModelCase c(machine);
    const std::size_t parameters = errors.parameter_count(), axes = machine.axes.size();
    std::vector<std::uint8_t> covered(kPoses);
    std::array<std::vector<double>, 6> deviation;
    std::array<double*, 6> deviations{};
    for (std::size_t r = 0; r < 6; ++r) {
      deviation[r].resize(kPoses);
      deviations[r] = deviation[r].data();
    }
    std::vector<double> jacobian(kPoses * 6 * parameters), by_position(kPoses * 6 * axes);
    model.deviations(c.positions(), deviations.data(), covered.data());
    model.jacobian(c.positions(), jacobian.data());
    model.jacobian_by_positions(c.positions(), by_position.data());
    for (const std::size_t k : {std::size_t{0}, ChainPlan::kBlockSize, kPoses - 1}) {
      model.nominal_poses(c.positions(), c.points(), c.rotations());
      c.expect_near(nominal_workpiece_from_tool(machine, c.pose(k)), k);
      model.poses(c.positions(), c.points(), c.rotations());
      c.expect_near(actual_workpiece_from_tool(machine, errors, c.pose(k)), k);

      Deviation expected;
      Eigen::MatrixXd by_parameters, by_positions;
      const PoseStatus status = tool_deviation(machine, errors, c.pose(k), expected, &by_parameters, &by_positions);
      EXPECT_EQ(covered[k] == 1, status == PoseStatus::ok);
      for (std::size_t r = 0; r < 6; ++r) {
        const auto row = static_cast<Eigen::Index>(r);
        EXPECT_NEAR(deviation[r][k], expected[row], 1e-9);
        for (std::size_t p = 0; p < parameters; ++p) {
          EXPECT_NEAR(jacobian[(k * 6 + r) * parameters + p], by_parameters(row, static_cast<Eigen::Index>(p)), 1e-7)
              << parameter_names(machine, errors)[p];
        }
        for (std::size_t i = 0; i < axes; ++i) {
          EXPECT_NEAR(by_position[(k * 6 + r) * axes + i], by_positions(row, static_cast<Eigen::Index>(i)), 1e-7);
        }
      }
    }
  }
}

TEST(PoseModel, SaysWherePositionsAreNotCovered) {
  const Machine machine = test::three_axis_mill();
  ErrorSet errors;
  ErrorMotion motion;
  motion.basis = {.kind = BasisKind::legendre, .order = 1, .from = 0, .to = 100};
  motion.coefficients = {0.01, 0.02};
  errors.motions.push_back(motion);
  const PoseModel model(machine, errors);
  const double x[] = {50, 150}, other[] = {0, 0};
  const double* axes[] = {x, other, other};
  double px[2], py[2], pz[2];
  std::uint8_t covered[2];
  model.poses({axes, 2}, {px, py, pz}, {}, covered);
  EXPECT_EQ(covered[0], 1);
  EXPECT_EQ(covered[1], 0);
  model.poses({axes, 0}, {px, py, pz});  // nothing to do
}

TEST(PoseModel, RefusesErrorsOfFirstOrder) {
  ErrorSet errors;
  errors.composition.first_order = true;
  EXPECT_THROW(PoseModel(test::three_axis_mill(), errors), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
