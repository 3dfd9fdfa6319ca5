#include "abbe/instruments/grid_encoder.h"

#include <numbers>

#include "abbe/errors/actual_pose.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

GridEncoderSetup a_grid() {
  GridEncoderSetup setup;
  setup.head = SetupPoint::within({10, -20, -140}, 0.1);
  setup.scale_x = SetupNumber::open(20e-6);
  setup.scale_y = SetupNumber::within(-15e-6, 1e-6);
  setup.squareness = SetupNumber::open(30e-6);
  setup.placements = {{"flat", Eigen::Vector3d(100, 80, 20), SetupNumber::open(0.7), SetupNumber::open(-0.4),
                       SetupPoint::open({0.01, -0.02, 0.1})},
                      {"upright", Eigen::Vector3d(50, 60, 70), SetupNumber::exact(0), SetupNumber::exact(0),
                       SetupPoint::open({std::numbers::pi / 2, 0, 0.2})}};
  return setup;
}

TEST(GridEncoder, DerivativesEqualFiniteDifferences) {
  const Machine machine = test::trunnion_mill();
  const auto device = std::make_shared<GridEncoder>(a_grid());
  InstrumentReadings plan = test::anywhere(machine, 40);
  for (std::size_t k = 0; k < plan.count(); k += 2) plan.item[k] = 1;
  test::expect_jacobian_equals_differences(machine, test::some_errors(machine), device, plan, 1e-6);
}

TEST(GridEncoder, ReadsWhereTheHeadIsInTheAxesOfTheGrid) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const GridEncoderSetup setup = a_grid();
  const auto device = std::make_shared<GridEncoder>(setup);
  const InstrumentReadings exact = test::exact_readings(machine, errors, device, test::anywhere(machine, 20));
  const double k = setup.squareness.value;
  for (std::size_t i = 0; i < exact.count(); ++i) {
    const std::vector<double> pose = exact.poses.pose(i);
    const RigidTransform seen = actual_bed_from_workpiece(machine, errors, pose).inverse() *
                                actual_bed_from_tool(machine, errors, pose) *
                                RigidTransform::translate(-machine.tool_offset - errors.tool_offset_error);
    const Eigen::Vector3d head = seen * (setup.head.value() + errors.tool_offset_error);
    // The grid's axes, at 90 degrees + k, as columns: what is read is the solution for their multiples.
    const Eigen::Matrix3d plate = device->places()[0].rotation.value();
    Eigen::Matrix3d axes;
    axes << plate.col(0), -std::sin(k) * plate.col(0) + std::cos(k) * plate.col(1), plate.col(2);
    const Eigen::Vector3d multiples = axes.inverse() * (head - device->places()[0].position);
    EXPECT_NEAR(exact.measured[0][i], (1 + setup.scale_x.value) * multiples[0], 1e-9);
    EXPECT_NEAR(exact.measured[1][i], (1 + setup.scale_y.value) * multiples[1], 1e-9);
  }
}

TEST(GridEncoder, RefusesWhatCannotBe) {
  GridEncoderSetup setup = a_grid();
  setup.noise_per_length = 1e-6;
  InstrumentReadings reading;
  reading.append({0, 0, 0, 0, 0}, 0);
  reading.measured = {{-200}, {50}};
  EXPECT_DOUBLE_EQ(GridEncoder(setup).standard_uncertainty(reading, 0, 0), 0.1e-3 + 0.2e-3);
  setup.grid_body = Body::tool;
  EXPECT_THROW(GridEncoder{setup}, std::invalid_argument);
  setup = a_grid();
  setup.placements.clear();
  EXPECT_THROW(GridEncoder{setup}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
