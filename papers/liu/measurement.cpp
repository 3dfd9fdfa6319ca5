#include "liu/measurement.h"

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/fits/shape_fit.h"
#include "abbe/geometry/registration/fine_registration.h"
#include "abbe/geometry/rotation.h"
#include "abbe/identify/identify.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/surface_probe.h"

namespace abbe {
namespace {

ProbeBeam liu_beam(const Machine& machine) {
  ProbeBeam beam;
  beam.direction = -machine.tool_direction;
  return beam;
}

VirtualScanSetup scan_setup(const Machine& machine, const LiuScanner& scanner, std::uint64_t seed) {
  VirtualScanSetup setup;
  setup.beam = liu_beam(machine);
  setup.following_axis = machine.find_axis("Z");
  setup.search = 5;
  if (scanner.noise) {
    setup.linear_noise = 1e-3;
    setup.rotary_noise = 0.004 * kDegree;
    setup.probe_noise = 1e-4;
  }
  setup.seed = 1000 * scanner.seed + seed;
  return setup;
}

/// What the stages and the zero of the probe really are. The zero is set on the standard cylinder: if that is larger
/// than assumed, so is the height of the zero.
ErrorSet truth_of(const Machine& machine, const LiuScanner& scanner) {
  ErrorSet errors = liu_errors(machine, scanner.unit);
  errors.tool_offset_error.z() = scanner.radius_error;
  return errors;
}

/// The standard cylinder along a direction, somewhere near the origin.
struct Clamped {
  Eigen::Vector3d axis;
  bool reversed = false;
  RigidTransform pose;
};

/// Readings of one stage at four angles, 13 along the cylinder by 9 across.
void scan_clamped(const Machine& machine, const LiuScanner& scanner, const std::string& stage, const Clamped& clamped,
                  std::uint32_t item, std::uint64_t seed, InstrumentReadings& readings) {
  const RayTracer cylinder(
      cylinder_mesh(10 + scanner.radius_error, clamped.reversed ? -scanner.taper : scanner.taper, 40, clamped.axis));
  PoseList planned;
  const bool along_x = std::abs(clamped.axis.x()) > 0.5;
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (int i = 0; i < 13; ++i) {
      for (int j = 0; j < 9; ++j) {
        std::vector<double> positions(machine.axes.size(), 0.0);
        const double along = 2.0 * (i - 6), across = j - 4;
        positions[machine.find_axis(stage)] = quarter * std::numbers::pi / 2;
        positions[machine.find_axis("X")] = along_x ? along : across;
        positions[machine.find_axis("Y")] = along_x ? across : along;
        positions[machine.find_axis("Z")] = std::sqrt(100 - across * across) - 10;
        planned.append(positions);
      }
    }
  }
  VirtualScanSetup setup = scan_setup(machine, scanner, seed);
  setup.workpiece_from_part = clamped.pose;
  const VirtualScan scan = scan_part(machine, truth_of(machine, scanner), cylinder, planned, setup);
  for (std::size_t k = 0; k < scan.indication.size(); ++k) {
    readings.append(scan.positions.pose(k), item);
    readings.measured[0].push_back(scan.indication[k]);
  }
}

/// Location errors of one stage from its readings.
Identification calibrate_stage(const Machine& machine, const LiuScanner& scanner, const std::string& stage,
                               const std::vector<Clamped>& clampings, const ErrorSet& known, std::size_t first,
                               std::uint64_t seed) {
  SurfaceProbeSetup setup;
  setup.noise = scanner.noise ? 1.2e-3 : 1e-6;
  if (scanner.reversed) setup.taper = SetupNumber::open(0);
  InstrumentReadings readings;
  readings.measured.resize(1);
  for (std::size_t i = 0; i < clampings.size(); ++i) {
    SurfaceProbeSetup::Clamping clamping;
    clamping.name = "clamping" + std::to_string(i + 1);
    clamping.direction = clampings[i].axis;
    clamping.reversed = clampings[i].reversed;
    clamping.offset = SetupPoint::open({0, 0, 0});
    clamping.tilt_first = SetupNumber::open(0);
    clamping.tilt_second = SetupNumber::open(0);
    setup.clampings.push_back(clamping);
    scan_clamped(machine, scanner, stage, clampings[i], static_cast<std::uint32_t>(i), seed + i, readings);
  }
  InstrumentObservations observations(machine, known, std::make_shared<SurfaceProbe>(setup), std::move(readings));
  Problem problem = estimate_everything(machine, known, {borrowed(observations)});
  problem.machine_parameters = {first, first + 1, first + 2, first + 3};
  return identify(problem);
}

}  // namespace

LiuCalibration liu_calibrate(const Machine& machine, const LiuScanner& scanner) {
  const auto clamped = [](const Eigen::Vector3d& axis, bool reversed, const Eigen::Vector3d& tilt,
                          const Eigen::Vector3d& shift) {
    return Clamped{axis, reversed, {rotation_from_error_angles(tilt), shift}};
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  std::vector<Clamped> on_a = {clamped(x, false, {0, 0.014, 0.021}, {0, 0.11, -0.06})};
  std::vector<Clamped> on_c = {clamped(y, false, {-0.014, 0, 0.021}, {-0.11, 0, -0.07})};
  if (scanner.reversed) {
    on_a.push_back(clamped(x, true, {0, -0.012, -0.009}, {0, -0.03, 0.05}));
    on_c.push_back(clamped(y, true, {0.011, 0, -0.005}, {0.02, 0, 0.04}));
  }
  LiuCalibration result;
  const Identification a = calibrate_stage(machine, scanner, "A", on_a, liu_unknowns(machine), 0, 11);
  const Identification c = calibrate_stage(machine, scanner, "C", on_c, a.errors, 4, 21);
  result.converged = a.status == IdentifyStatus::converged && c.status == IdentifyStatus::converged;
  result.message = a.message + "; " + c.message;
  result.errors = c.errors;
  const ErrorSet truth = truth_of(machine, scanner);
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const std::size_t axis = machine.find_axis(stage == 0 ? "A" : "C");
    const RigidTransform found = actual_motion(machine, result.errors, axis, std::numbers::pi);
    const RigidTransform is = actual_motion(machine, truth, axis, std::numbers::pi);
    // A half turn is 2 d d' - 1; half of its translation is the point of the line nearest to the origin.
    const Eigen::Vector3d nominal = machine.axes[axis].direction;
    const Eigen::Vector3d d1 = (found.rotation * nominal + nominal).normalized();
    const Eigen::Vector3d d2 = (is.rotation * nominal + nominal).normalized();
    result.direction[stage] = d1.cross(d2).norm();
    result.distance[stage] = (0.5 * found.translation - 0.5 * is.translation).norm();
  }
  return result;
}

LiuMeasurement liu_measure(const Machine& machine, const LiuScanner& scanner, const ErrorSet& calibrated,
                           const LiuPart& model, const TriangleMesh& scanned, const ScanPlan& plan) {
  LiuMeasurement result;
  result.part = model.name;
  const PoseList planned = measuring_positions(plan);
  VirtualScanSetup setup = scan_setup(machine, scanner, 31);
  setup.workpiece_from_part = liu_clamping(scanner.unit);
  const VirtualScan scan = scan_part(machine, truth_of(machine, scanner), RayTracer(scanned), planned, setup);
  result.planned = planned.count();
  result.lost = scan.no_surface;
  result.too_steep = scan.too_steep;
  const ClosestPointFinder surface(model.mesh);
  const SmoothSurface smooth(model.mesh);
  FineRegistrationOptions registration;
  registration.loss = RegistrationLoss::least_squares;  // the deviations of the paper are all of them
  registration.iterations = 1000;
  const RigidTransform part_from_workpiece = setup.workpiece_from_part.inverse();
  const auto evaluate = [&](const ErrorSet& errors) {
    Eigen::Matrix3Xd points = scanned_points(machine, errors, setup.beam, scan);
    LiuDeviation deviation;
    deviation.points = static_cast<std::size_t>(points.cols());
    const bool is_sphere = result.part.starts_with("sphere"), is_cylinder = result.part == "standard cylinder";
    if (is_sphere || is_cylinder) {
      const ShapeFit fit = least_squares_fit(is_sphere ? ShapeKind::sphere : ShapeKind::cylinder, points);
      if (fit.ok()) deviation.fitted_radius = fit.shape.radius;
    }
    const FineRegistration fit = register_finely(points, surface, smooth, part_from_workpiece, registration);
    // Turns of a sphere or a cylinder are not seen and do not matter.
    deviation.registered =
        fit.status == FineRegistrationStatus::ok || fit.status == FineRegistrationStatus::undetermined;
    const RigidTransform& pose = fit.mesh_from_scan;
    points = ((pose.rotation * points).colwise() + pose.translation).eval();
    deviation.distances = surface.signed_distances(points);
    deviation.rms = std::sqrt(deviation.distances.squaredNorm() / static_cast<double>(deviation.distances.size()));
    deviation.largest = deviation.distances.cwiseAbs().maxCoeff();
    deviation.registered_points = std::move(points);
    return deviation;
  };
  result.before = evaluate({});
  result.after = evaluate(calibrated);
  return result;
}

}  // namespace abbe
