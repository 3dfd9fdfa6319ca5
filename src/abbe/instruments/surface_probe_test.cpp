#include "abbe/instruments/surface_probe.h"

#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Standard = SurfaceProbeSetup::Standard;

/// A probe on the spindle over a standard that is clamped twice, the second time end for end; everything off by a
/// little.
SurfaceProbeSetup clamped_standard(const Machine& machine, Standard standard) {
  SurfaceProbeSetup setup;
  setup.standard = standard;
  setup.zero = SetupPoint::within({0.4, -0.3, -120}, 0.01);
  setup.beam = {0.02, 0.01, -1};
  setup.beam_first = SetupNumber::within(1e-3, 1e-4);
  setup.beam_second = SetupNumber::within(-2e-3, 1e-4);
  setup.radius = SetupNumber::within(20.003, 1e-3);
  setup.taper = SetupNumber::open(3e-4);
  SurfaceProbeSetup::Clamping clamping;
  const Eigen::Vector3d surface =
      test::seen_from_workpiece(machine, ErrorSet{}, test::middle(machine), setup.zero.value());
  clamping.point = standard == Standard::plane ? surface : Eigen::Vector3d(surface - Eigen::Vector3d(0, 0, 20));
  clamping.direction = standard == Standard::plane ? Eigen::Vector3d(0.1, 0, 1) : Eigen::Vector3d(0.1, 1, 0.05);
  clamping.offset = SetupPoint::open({0.05, -0.02, 0.03});
  clamping.tilt_first = SetupNumber::open(0.01);
  clamping.tilt_second = SetupNumber::open(-0.02);
  setup.clampings.assign(2, clamping);
  setup.clampings[1].name = "turned";
  setup.clampings[1].reversed = true;
  setup.clampings[1].offset.coordinate[0].value = -0.04;
  return setup;
}

/// How far a point lies outside the clamped standard, independent of the instrument.
double outside(const SurfaceProbeSetup& setup, const SurfaceProbeSetup::Clamping& clamping, const Eigen::Vector3d& p) {
  const Eigen::Vector3d offset = clamping.offset.value();
  if (setup.standard == Standard::sphere) return (p - clamping.point - offset).norm() - setup.radius.value;
  const DirectionFrame frame = DirectionFrame::of(clamping.direction);
  const Eigen::Vector3d direction =
      (frame.direction + clamping.tilt_first.value * frame.first + clamping.tilt_second.value * frame.second)
          .normalized();
  if (setup.standard == Standard::plane) return direction.dot(p - clamping.point - offset[2] * frame.direction);
  const Eigen::Vector3d w = p - clamping.point - offset[0] * frame.first - offset[1] * frame.second;
  const double along = direction.dot(w), taper = clamping.reversed ? -setup.taper.value : setup.taper.value;
  return direction.cross(w).norm() - (setup.radius.value + taper * along);
}

TEST(SurfaceProbe, FollowsTheBeamToTheSurface) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  for (const Standard standard : {Standard::cylinder, Standard::sphere, Standard::plane}) {
    const SurfaceProbeSetup setup = clamped_standard(machine, standard);
    const auto probe = std::make_shared<SurfaceProbe>(setup);
    const InstrumentReadings plan = test::meeting_plan(machine, *probe, 1.0, 0.3, 20);
    const InstrumentReadings readings = test::exact_readings(machine, errors, probe, plan);
    const DirectionFrame frame = DirectionFrame::of(setup.beam);
    const Eigen::Vector3d beam = (frame.direction + 1e-3 * frame.first - 2e-3 * frame.second).normalized();
    for (std::size_t k = 0; k < readings.count(); ++k) {
      const double h = readings.measured[0][k];
      const Eigen::Vector3d met =
          test::seen_from_workpiece(machine, errors, plan.poses.pose(k), setup.zero.value() + h * beam);
      const Eigen::Vector3d before =
          test::seen_from_workpiece(machine, errors, plan.poses.pose(k), setup.zero.value() + (h - 0.01) * beam);
      const SurfaceProbeSetup::Clamping& clamping = setup.clampings[plan.item[k]];
      EXPECT_NEAR(outside(setup, clamping, met), 0, 1e-10);
      EXPECT_GT(outside(setup, clamping, before), 0) << "the beam meets the far side";
      EXPECT_LT(std::abs(h), 4) << "a plan brings the zero near the surface";
    }
  }
}

TEST(SurfaceProbe, DerivativesEqualDifferences) {
  // A shift by L times the step of 1e-5 rad leaves 3 x L^3 / (6 r^3) of its square: 6e-6 for x = 1 mm, r = 20 mm, L = 1
  // m.
  for (const Machine& machine : {test::trunnion_mill(), test::head_table_mill()}) {
    for (const Standard standard : {Standard::cylinder, Standard::sphere, Standard::plane}) {
      const auto probe = std::make_shared<SurfaceProbe>(clamped_standard(machine, standard));
      test::expect_jacobian_equals_differences(machine, test::some_errors(machine), probe,
                                               test::meeting_plan(machine, *probe, 1.0, 0.2, 6), 3e-5);
    }
  }
}

TEST(SurfaceProbe, HasNoIndicationBesideTheStandard) {
  const Machine machine = test::trunnion_mill();
  const auto probe = std::make_shared<SurfaceProbe>(clamped_standard(machine, Standard::sphere));
  InstrumentReadings plan;
  plan.append(*meet(machine, test::middle(machine), Body::tool, Body::workpiece, *probe->meeting_points(0), {25, 0, 0}),
              0);
  EXPECT_TRUE(std::isnan(test::exact_readings(machine, ErrorSet{}, probe, plan).measured[0][0]));
}

TEST(SurfaceProbe, RefusesASetupThatIsNone) {
  SurfaceProbeSetup setup;
  EXPECT_THROW(SurfaceProbe{setup}, std::invalid_argument);
  setup.clampings.resize(1);
  setup.beam.setZero();
  EXPECT_THROW(SurfaceProbe{setup}, std::invalid_argument);
  setup.beam = {0, 0, -1};
  setup.radius = SetupNumber::exact(0);
  EXPECT_THROW(SurfaceProbe{setup}, std::invalid_argument);
  setup.standard = Standard::plane;
  EXPECT_NO_THROW(SurfaceProbe{setup}) << "a plane has no radius";
}

}  // namespace
}  // namespace abbe
