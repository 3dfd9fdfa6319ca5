#pragma once

#include <memory>
#include <numbers>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/identify/problem.h"
#include "abbe/instruments/trackers/tracker_observations.h"

namespace abbe::benchmark_case {

inline constexpr int kLinearOrder = 3;  // Legendre degree of X and Z
inline constexpr int kHarmonics = 2;    // of C

/// Machine w C' X' b Z t, one tracker on the table, three reflectors on the tool, isotropic noise of 10 um.
///
/// Estimated: 60 parameters without any gauge freedom, so that Ceres can have the same problem.
struct XcfzCase {
  Machine machine;
  ErrorSet truth, start;
  TrackerSetup setup;
  TrackerReadings readings;
  std::vector<std::size_t> parameters;  // estimated ones of the machine; the tracker's six come on top

  explicit XcfzCase(std::size_t count) {
    const double turn = 2 * std::numbers::pi;
    const Eigen::Vector3d centre(700, 0, -100), spindle(0, 0, 300);
    Axis c{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece, .primed = true};
    c.direction = Eigen::Vector3d::UnitZ();
    c.point = centre;
    c.travel_max = turn;
    Axis x{.name = "X", .kind = AxisKind::linear, .side = ChainSide::workpiece, .primed = true};
    x.travel_max = 1400;
    Axis z{.name = "Z", .kind = AxisKind::linear, .side = ChainSide::tool};
    z.direction = Eigen::Vector3d::UnitZ();
    z.point = spindle;
    z.travel_max = 600;
    machine.name = "XCFZ";
    machine.axes = {c, x, z};
    machine.bed_from_workpiece = RigidTransform::translate(centre);
    machine.tool_reference = spindle;

    RandomStream random(7);
    std::size_t next = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (int component = 0; component < kComponentCount; ++component) {
        ErrorMotion motion;
        motion.axis = axis;
        motion.component = static_cast<Component>(component);
        motion.basis.kind = axis == 0 ? BasisKind::fourier : BasisKind::legendre;
        motion.basis.order = axis == 0 ? kHarmonics : kLinearOrder;
        motion.basis.to = machine.axes[axis].travel_max;
        motion.basis.period = axis == 0 ? turn : 0;
        const double size = component < 3 ? 0.03 : 5e-5;
        for (std::size_t k = 0; k < motion.basis.size(); ++k, ++next) {
          // Left out: what the tracker's pose or another axis could take over.
          const bool free = axis == 0   ? k >= 1 && (k > 2 || component == 2 || component == 5)
                            : axis == 1 ? k >= 1 || component == 3 || component == 4
                                        : k >= 1;
          motion.coefficients.push_back(free ? size * random.normal() : 0);
          if (free) parameters.push_back(next);
        }
        truth.motions.push_back(motion);
      }
    start = truth;
    for (ErrorMotion& motion : start.motions) std::fill(motion.coefficients.begin(), motion.coefficients.end(), 0.0);

    TrackerStation station;
    station.noise = TrackerNoise::isotropic(10, 0);
    const RigidTransform pose{rotation_from_error_angles({0.03, -0.02, 0.5}), {300, -200, 150}};
    setup.reflectors.resize(3);
    const double offsets[3][3] = {{60, 0, -150}, {0, 80, -250}, {-70, -30, -100}};
    for (std::size_t i = 0; i < 3; ++i)
      setup.reflectors[i].offset = Eigen::Vector3d(offsets[i][0], offsets[i][1], offsets[i][2]);
    station.body_from_tracker = pose;
    setup.stations = {station};

    const ChainPlan plan(machine, truth, Body::tool, Body::workpiece);
    const RigidTransform tracker_from_body = pose.inverse();
    readings.reserve(3, count);
    for (std::size_t i = 0; i < count; ++i) {
      const double position[3] = {random.uniform(0, turn), random.uniform(0, 1400), random.uniform(0, 600)};
      const double* axis[3] = {&position[0], &position[1], &position[2]};
      const std::size_t reflector = i % 3;
      Eigen::Vector3d point = setup.reflectors[reflector].offset;
      plan.transform({axis, 1}, {&point[0], &point[1], &point[2]}, {&point[0], &point[1], &point[2]});
      const Eigen::Vector3d seen = tracker_from_body * point;
      for (std::size_t a = 0; a < 3; ++a) readings.poses.axis[a].push_back(position[a]);
      readings.station.push_back(0);
      readings.reflector.push_back(static_cast<std::uint16_t>(reflector));
      for (int k = 0; k < 3; ++k)
        readings.measured[static_cast<std::size_t>(k)].push_back(seen[k] + 0.010 * random.normal());
    }
    // The identification starts from a pose that is a little wrong.
    setup.stations[0].body_from_tracker = {rotation_from_error_angles({0.035, -0.015, 0.49}), {302, -203, 151}};
  }

  std::unique_ptr<TrackerObservations> observations() const {
    return std::make_unique<TrackerObservations>(machine, start, setup, readings);
  }
  Problem problem(Observations& observed) const {
    Problem result = estimate_everything(machine, start, {borrowed(observed)});
    result.machine_parameters = parameters;
    return result;
  }
};

}  // namespace abbe::benchmark_case
