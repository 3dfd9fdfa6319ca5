#include "abbe/instruments/point_scan.h"

#include <gtest/gtest.h>

#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

TEST(PointScan, PutsEveryIndicationWhereTheActualMachineHasIt) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const ProbeBeam beam{{0.3, -0.2, -110}, Eigen::Vector3d(0.1, -0.2, -1).normalized()};
  constexpr std::size_t kCount = 2500;  // more than two blocks, the last one short
  PoseList poses;
  std::vector<double> indication;
  for (std::size_t k = 0; k < kCount; ++k) {
    RandomStream random(3, k);
    std::vector<double> positions = test::middle(machine);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] += machine.axes[i].kind == AxisKind::rotary ? random.uniform(-0.5, 0.5) : random.uniform(-50, 50);
    }
    poses.append(positions);
    indication.push_back(random.uniform(-0.2, 0.2));
  }
  std::vector<const double*> axis;
  for (const std::vector<double>& values : poses.axis) axis.push_back(values.data());
  std::vector<double> x(kCount), y(kCount), z(kCount);
  std::vector<std::uint8_t> covered(kCount, 0);
  PointScan(machine, errors, beam)
      .points({axis, kCount}, indication.data(), {x.data(), y.data(), z.data()}, covered.data());
  for (std::size_t k = 0; k < kCount; ++k) {
    const Eigen::Vector3d expected =
        test::seen_from_workpiece(machine, errors, poses.pose(k), beam.zero + indication[k] * beam.direction);
    ASSERT_NEAR((Eigen::Vector3d(x[k], y[k], z[k]) - expected).norm(), 0, 1e-11) << k;
    ASSERT_EQ(covered[k], 1);
  }
}

TEST(PointScan, RefusesABeamWithoutUnitDirection) {
  EXPECT_THROW(PointScan(test::trunnion_mill(), ErrorSet{}, {{0, 0, 0}, {0, 0, -2}}), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
