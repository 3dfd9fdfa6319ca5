#pragma once

#include <array>
#include <memory>
#include <numbers>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/identify/problem.h"
#include "abbe/instruments/ball_bar.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/interferometer.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/instruments/r_test.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "abbe/instruments/trackers/tracking_interferometer.h"

namespace abbe::benchmark_case {

/// Estimated coefficients of each axis in chain order, six components each: C two harmonics, A parabolas, Y X Z cubics.
inline constexpr std::array<int, 5> kAxisParameters = {30, 18, 24, 24, 24};
inline constexpr int kMachineParameters = 120;

/// Unknowns of each set-up: tracker's pose; scale's zero and ball; zeros of three runs; nest; two stations and two dead
/// paths.
inline constexpr std::array<int, 5> kSetupParameters = {6, 4, 9, 3, 8};

/// Trunnion mill w C' A' Y' b X Z t of examples/machines, measured with laser tracker, ball bar, interferometer
/// (length, pitch, yaw), R-test and tracking interferometer; 150 unknowns, weak knowledge of every coefficient, so that
/// there is no gauge freedom.
class FiveInstrumentsCase {
 public:
  static constexpr double kTrackerNoise = 0.010;    // mm
  static constexpr double kBarNoise = 0.3e-3;       // mm
  static constexpr double kLengthNoise = 0.1e-3;    // mm
  static constexpr double kAngleNoise = 1e-6;       // rad
  static constexpr double kProbeNoise = 0.5e-3;     // mm
  static constexpr double kTrackingNoise = 0.3e-3;  // mm
  static constexpr double kTranslation = 0.02;      // mm, standard uncertainty of a coefficient beforehand
  static constexpr double kRotation = 5e-5;         // rad

  Machine machine;
  ErrorSet truth, start;
  TrackerSetup tracker;
  TrackerReadings tracked;
  std::vector<std::shared_ptr<const Instrument>> instruments;  ///< [4] bar, interferometer, R-test, tracking
  std::vector<InstrumentReadings> readings;                    ///< [4]
  std::vector<Eigen::Vector3d> probe_directions;               ///< [3] unit, R-test

  /// @param count  of each instrument, a multiple of 40
  explicit FiveInstrumentsCase(std::size_t count) {
    build_machine();
    truth = errors(&random_);
    start = errors(nullptr);
    measure_tracker(count);
    measure_ball_bar(count);
    measure_interferometer(count);
    measure_r_test(count);
    measure_tracking(count);
  }

  /// Fresh ones at the start of the identification: tracker first, then the others in their order.
  std::vector<std::unique_ptr<Observations>> observations() const {
    std::vector<std::unique_ptr<Observations>> result;
    result.push_back(std::make_unique<TrackerObservations>(machine, start, tracker, tracked));
    for (std::size_t i = 0; i < instruments.size(); ++i) {
      result.push_back(std::make_unique<InstrumentObservations>(machine, start, instruments[i], readings[i]));
    }
    return result;
  }

  Problem problem(const std::vector<std::unique_ptr<Observations>>& observed) const {
    std::vector<std::shared_ptr<Observations>> all;
    for (const std::unique_ptr<Observations>& one : observed) all.push_back(borrowed(*one));
    Problem result = estimate_everything(machine, start, all);
    result.machine_parameters.resize(result.machine_parameters.size() - 3);  // not the tool offset
    const std::vector<bool> angles = parameters_are_angles(machine, start);
    for (const std::size_t p : result.machine_parameters) {
      result.priors.push_back({{ParameterId::kMachine, p}, 0, angles[p] ? kRotation : kTranslation});
    }
    for (std::size_t i = 0; i < instruments.size(); ++i) {
      std::size_t unknown = 0;
      for (const SetupQuantity& quantity : instruments[i]->quantities()) {
        if (quantity.knowledge == Knowledge::exact) continue;
        if (quantity.knowledge == Knowledge::within) {
          result.priors.push_back({{i + 1, unknown}, quantity.value, quantity.standard_uncertainty});
        }
        ++unknown;
      }
    }
    return result;
  }

 private:
  static constexpr double kTurn = 2 * std::numbers::pi;
  static constexpr double kDegree = kTurn / 360;

  void build_machine() {
    const auto axis = [](const char* name, AxisKind kind, ChainSide side, const Eigen::Vector3d& direction, double from,
                         double to) {
      Axis result;
      result.name = name;
      result.kind = kind;
      result.side = side;
      result.primed = side == ChainSide::workpiece;
      result.direction = direction;
      result.travel_min = from;
      result.travel_max = to;
      return result;
    };
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
    machine.name = "trunnion mill";
    machine.axes = {axis("C", AxisKind::rotary, ChainSide::workpiece, z, 0, kTurn),
                    axis("A", AxisKind::rotary, ChainSide::workpiece, x, -120 * kDegree, 30 * kDegree),
                    axis("Y", AxisKind::linear, ChainSide::workpiece, y, -255, 255),
                    axis("X", AxisKind::linear, ChainSide::tool, x, -300, 300),
                    axis("Z", AxisKind::linear, ChainSide::tool, z, -510, 0)};
    machine.axes[1].point = {0, 0.02, 50};
    machine.tool_reference = {0, 0, 560};
    machine.tool_offset = {0, 0, -150};
  }

  ErrorSet errors(RandomStream* random) const {
    ErrorSet result;
    for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
      for (int component = 0; component < kComponentCount; ++component) {
        ErrorMotion motion;
        motion.axis = axis;
        motion.component = static_cast<Component>(component);
        motion.basis.kind = axis == 0 ? BasisKind::fourier : BasisKind::legendre;
        motion.basis.order = axis <= 1 ? 2 : 3;
        motion.basis.from = machine.axes[axis].travel_min;
        motion.basis.to = machine.axes[axis].travel_max;
        motion.basis.period = axis == 0 ? kTurn : 0;
        const double size = is_rotation(motion.component) ? kRotation : kTranslation;
        for (std::size_t k = 0; k < motion.basis.size(); ++k) {
          motion.coefficients.push_back(random != nullptr ? size * random->normal() : 0);
        }
        result.motions.push_back(motion);
      }
    }
    return result;
  }

  /// Readings of an instrument whose quantities differ from what is known of them by their uncertainties.
  void measure(const std::shared_ptr<const Instrument>& known, const InstrumentReadings& plan, double open_error) {
    std::vector<double> real;
    for (const SetupQuantity& quantity : known->quantities()) {
      const double error = quantity.knowledge == Knowledge::open     ? open_error * (quantity.is_angle ? 1e-5 : 1)
                           : quantity.knowledge == Knowledge::within ? quantity.standard_uncertainty
                                                                     : 0;
      real.push_back(quantity.value + error * random_.normal());
    }
    InstrumentSimulationOptions options;
    options.seed = 100 + readings.size();
    readings.push_back(simulate_instrument(machine, truth, known->with_values(real), plan, options).readings);
    instruments.push_back(known);
  }

  void measure_tracker(std::size_t count) {
    TrackerStation station;
    station.noise = TrackerNoise::isotropic(1e3 * kTrackerNoise, 0);
    station.body_from_tracker = {rotation_from_error_angles({0.03, -0.02, 0.5}), {-900, -1200, 200}};
    tracker.stations = {station};
    tracker.reflectors.resize(2);
    tracker.reflectors[0].offset = {60, 0, -150};
    tracker.reflectors[1].offset = {-40, 70, -100};
    TrackerSimulationOptions options;
    options.choice = SightChoice::cycle;
    options.seed = 3;
    tracked =
        simulate_tracker(machine, truth, tracker, random_plan(machine, full_ranges(machine, 2), count, 17), options)
            .readings;
    // The identification starts from a pose that is a little wrong.
    tracker.stations[0].body_from_tracker = {rotation_from_error_angles({0.031, -0.019, 0.498}), {-899, -1202, 201}};
  }

  /// Positions of the rotary axes; the linear ones at the middle of their travel.
  std::vector<double> middle(double c, double a) const { return {c, a, 0, 0, -255}; }

  void measure_ball_bar(std::size_t count) {
    BallBarSetup setup;
    setup.spindle_ball = SetupPoint::exact({0, 0, -150});
    setup.balls = {{"ball", SetupPoint::within({20, 10, 80}, 0.05)}};
    setup.length_deviation = SetupNumber::within(0, 0.5e-3);
    setup.noise = kBarNoise;
    const auto bar = std::make_shared<BallBar>(setup);
    const std::array<Eigen::Vector3d, 3> axes = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                                 Eigen::Vector3d::UnitZ()};
    InstrumentReadings plan;
    constexpr std::size_t kCircles = 40;
    for (std::size_t i = 0; i < kCircles; ++i) {
      CircleDescription circle;
      circle.u = axes[i % 3];
      circle.v = axes[(i + 1) % 3];
      circle.radius = 100;
      circle.to_angle = kTurn;
      circle.count = count / kCircles;
      const double part = static_cast<double>(i) / kCircles;
      const PoseList poses = circle_plan(machine, middle(kTurn * part, (-100 + 120 * part) * kDegree), Body::tool,
                                         Body::workpiece, *bar->meeting_points(0), circle);
      for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), 0);
    }
    measure(bar, plan, 0);
  }

  void measure_interferometer(std::size_t count) {
    InterferometerSetup setup;
    setup.components = {InterferometerComponent::length, InterferometerComponent::pitch, InterferometerComponent::yaw};
    setup.length_noise = kLengthNoise;
    setup.angle_noise = kAngleNoise;
    InstrumentReadings plan;
    for (std::size_t axis = 2; axis < 5; ++axis) {
      InterferometerRun run;
      run.name = machine.axes[axis].name;
      run.optic = SetupPoint::exact({0, 0, -150});
      run.direction = machine.axes[axis].direction;
      run.up = axis == 4 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
      setup.runs.push_back(run);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t run = 3 * k / count, axis = run + 2;
      std::vector<double> positions = middle(0, 0);
      positions[axis] = random_.uniform(machine.axes[axis].travel_min, machine.axes[axis].travel_max);
      plan.append(positions, run);
    }
    measure(std::make_shared<Interferometer>(setup), plan, 0.1);
  }

  void measure_r_test(std::size_t count) {
    RTestSetup setup;
    setup.nest = SetupPoint::within({60, -20, 100}, 0.05);
    const double slope = std::numbers::sqrt2;
    for (const double at : {0.0, kTurn / 3, 2 * kTurn / 3}) {
      RTestSetup::Probe probe;
      probe.name = "probe" + std::to_string(setup.probes.size() + 1);
      probe.direction = {slope * std::cos(at), slope * std::sin(at), -1};
      setup.probes.push_back(probe);
      probe_directions.push_back(probe.direction.normalized());
    }
    setup.spheres = {{"sphere", SetupPoint::exact({0, 0, -150})}};
    setup.noise = kProbeNoise;
    const auto nest = std::make_shared<RTest>(setup);
    PoseList rotary;
    for (std::size_t k = 0; k < count; ++k) {
      rotary.append(middle(random_.uniform(0, kTurn), random_.uniform(-90 * kDegree, 20 * kDegree)));
    }
    const PoseList poses =
        follow_plan(machine, rotary, Body::tool, Body::workpiece, *nest->meeting_points(0), Eigen::Vector3d::Zero());
    InstrumentReadings plan;
    for (std::size_t k = 0; k < count; ++k) plan.append(poses.pose(k), 0);
    measure(nest, plan, 0);
  }

  void measure_tracking(std::size_t count) {
    TrackingInterferometerSetup setup;
    setup.stations = {{"station1", Body::workpiece, SetupPoint::open({-700, -300, 120})},
                      {"station2", Body::workpiece, SetupPoint::open({500, -600, 300})}};
    setup.reflectors = {{"reflector", Body::tool, SetupPoint::exact({0, 40, -150})}};
    setup.runs = {{"run1", 0, 0, SetupNumber::open(400)}, {"run2", 1, 0, SetupNumber::open(500)}};
    setup.noise = kTrackingNoise;
    const PoseList poses = random_plan(machine, full_ranges(machine, 2), count, 23);
    InstrumentReadings plan;
    for (std::size_t k = 0; k < count; ++k) plan.append(poses.pose(k), 2 * k / count);
    measure(std::make_shared<TrackingInterferometer>(setup), plan, 1);
  }

  RandomStream random_{7};
};

}  // namespace abbe::benchmark_case
