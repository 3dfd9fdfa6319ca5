#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_stream.h"
#include "abbe/identify/trust/trial_readings.h"
#include "abbe/instruments/ball_bar.h"
#include "abbe/instruments/electronic_level.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/interferometer.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/instruments/polygon/polygon_placement.h"
#include "abbe/instruments/r_test.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_simulation.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
using Components = std::vector<InterferometerComponent>;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);
constexpr double kBar_mm = 100;
constexpr double kNestOffset_mm = 60;
// A prism of twelve faces, known as its maker states it (docs/polygon.md).
constexpr std::size_t kFaces = 12;
constexpr double kFaceDistance_mm = 48.3, kPrismHeight_mm = 17;
constexpr double kFaceAzimuth_rad = 5e-6, kFaceTilt_rad = 2.5e-5, kFaceDistanceError_mm = 1e-3;

/// Instruments that stand at a sensible place of a machine and were not there.
class FurtherInstruments {
 public:
  FurtherInstruments(const Problem& problem, std::vector<PossibleMeasurement>& list)
      : problem_(problem), machine_(problem.machine), list_(list) {
    PoseList all;
    all.axis.resize(machine_.axes.size());
    for (const SelectedObservations& selected : problem.observations)
      for (std::size_t k = 0; k < selected.observations->reading_count(); ++k)
        all.append(selected.observations->positions(k));
    ranges_ = measured_ranges(machine_, all);
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      const bool known = std::any_of(problem.errors.motions.begin(), problem.errors.motions.end(),
                                     [i](const ErrorMotion& motion) { return motion.axis == i; });
      if (!known || !ranges_[i].moved()) ranges_[i] = whole_travel(machine_.axes[i]);
      const bool rotary = machine_.axes[i].kind == AxisKind::rotary;
      middle_.push_back(rotary ? std::clamp(0.0, ranges_[i].from, ranges_[i].to)
                               : (ranges_[i].from + ranges_[i].to) / 2);
    }
  }

  void add() {
    // What looks at one axis comes first, for it tells the errors of that axis from those of others.
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const Axis& axis = machine_.axes[i];
      if (axis.kind == AxisKind::rotary) continue;
      if (std::abs(axis.direction.z()) < 0.5) add_level(i);
      add_interferometer({i}, {InterferometerComponent::length}, "positioning");
      add_interferometer({i}, {InterferometerComponent::straightness_y, InterferometerComponent::straightness_z},
                         "straightness");
      add_interferometer({i}, {InterferometerComponent::pitch, InterferometerComponent::yaw}, "angles");
    }
    add_ball_bar();
    for (std::size_t i = 0; i < machine_.axes.size(); ++i)
      if (machine_.axes[i].kind == AxisKind::rotary) add_r_test({i});
    for (std::size_t i = 0; i < machine_.axes.size(); ++i)
      if (machine_.axes[i].kind == AxisKind::rotary) add_polygon(i);
    for (std::size_t i = 0; i < machine_.axes.size(); ++i)
      if (machine_.axes[i].kind == AxisKind::linear)
        add_interferometer({i},
                           {InterferometerComponent::length, InterferometerComponent::straightness_y,
                            InterferometerComponent::straightness_z, InterferometerComponent::roll,
                            InterferometerComponent::pitch, InterferometerComponent::yaw},
                           "all six motions at once");
    for (std::size_t i = 0; i < machine_.axes.size(); ++i)
      for (std::size_t j = i + 1; j < machine_.axes.size(); ++j)
        if (machine_.axes[i].kind == AxisKind::linear && machine_.axes[j].kind == AxisKind::linear)
          add_interferometer({i, j}, {InterferometerComponent::straightness_y, InterferometerComponent::straightness_z},
                             "squareness, by an optical square");
    std::vector<std::size_t> rotary;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i)
      if (machine_.axes[i].kind == AxisKind::rotary) rotary.push_back(i);
    if (rotary.size() > 1) add_r_test(rotary);
    add_tracker();
  }

 private:
  /// Known in the workpiece frame: where the functional point of the tool stands in the middle of the travels.
  Vector3d middle_point() const { return nominal_workpiece_from_tool(machine_, middle_).translation; }

  std::string names(const std::vector<std::size_t>& axes) const {
    std::string text;
    for (std::size_t k = 0; k < axes.size(); ++k)
      text += (k == 0 ? "" : k + 1 == axes.size() ? " and " : ", ") + machine_.axes[axes[k]].name;
    return text;
  }

  double random_position(std::size_t axis, RandomStream& random) const {
    return random.uniform(ranges_[axis].from, ranges_[axis].to);
  }

  bool covered(const std::vector<double>& pose) const { return covers_commands(machine_, problem_.errors, pose); }

  void add_trial(std::string words, const std::shared_ptr<const Instrument>& device,
                 const InstrumentReadings& planned) {
    if (planned.count() < kLeastReadings) return;
    InstrumentSimulationOptions options;
    options.noise_factor = 0;
    const ErrorSet errors = without_errors(problem_);
    InstrumentReadings at_references = planned;
    stand_at_references(machine_, at_references.poses);
    const InstrumentReadings all = simulate_instrument(machine_, errors, device, at_references, options).readings;
    std::vector<std::size_t> finite;
    for (std::size_t k = 0; k < all.count(); ++k) {
      const bool shown = std::all_of(all.measured.begin(), all.measured.end(),
                                     [k](const std::vector<double>& values) { return std::isfinite(values[k]); });
      if (shown) finite.push_back(k);
    }
    if (finite.size() < kLeastReadings) return;
    InstrumentObservations trial(machine_, errors, device, all.subset(finite));
    std::vector<TrialUnknown> unknowns;
    for (std::size_t u = 0; u < trial.unknowns().size(); ++u) {
      const SetupQuantity& quantity = device->quantities()[trial.quantity_of(u)];
      unknowns.push_back({true, quantity.knowledge == Knowledge::within ? quantity.standard_uncertainty : 0.0});
    }
    list_.push_back(trial_measurement(problem_, kNone, std::move(words), trial, unknowns));
  }

  void add_interferometer(const std::vector<std::size_t>& axes, const Components& components, const char* what) {
    InterferometerSetup setup;
    setup.name = "trial laser";
    setup.components = components;
    const Eigen::Matrix3d workpiece_from_bed = nominal_bed_from_workpiece(machine_, middle_).rotation.transpose();
    for (const std::size_t i : axes) {
      const Axis& axis = machine_.axes[i];
      InterferometerRun run;
      run.name = "trial " + axis.name;
      run.optic = SetupPoint::exact(machine_.tool_offset);
      run.origin = SetupPoint::exact(middle_point());
      const double sense = axis.sense() * (axis.side == ChainSide::tool ? 1 : -1);
      run.direction = sense * (workpiece_from_bed * axis.direction);
      run.up = std::abs(run.direction.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX();
      run.alignment = {SetupNumber::open(0), SetupNumber::open(0), SetupNumber::open(0)};
      run.aligned_orientation = nominal_orientation(machine_, middle_, Body::tool, Body::workpiece);
      if (!setup.runs.empty()) {
        if (std::abs(run.direction.dot(setup.runs.front().direction)) > 0.1) return;
        run.square_with = setup.runs.front().name;
      }
      setup.runs.push_back(run);
    }
    const auto device = std::make_shared<Interferometer>(setup);
    InstrumentReadings planned;
    planned.poses.axis.resize(machine_.axes.size());
    for (std::size_t r = 0; r < axes.size(); ++r)
      for (std::size_t k = 0; k < kTrialReadings / 2; ++k) {
        RandomStream random(29, k);
        std::vector<double> pose = middle_;
        pose[axes[r]] = random_position(axes[r], random);
        planned.append(pose, r);
      }
    add_trial(fmt::format("a laser interferometer along {} ({})", names(axes), what), device, planned);
  }

  void add_level(std::size_t i) {
    const Axis& axis = machine_.axes[i];
    ElectronicLevelSetup setup;
    setup.name = "trial level";
    setup.body = axis.side == ChainSide::tool ? Body::tool : Body::workpiece;
    setup.relative = true;
    setup.axes = {{"along_x", Vector3d::UnitX(), SetupNumber::open(0)},
                  {"along_y", Vector3d::UnitY(), SetupNumber::open(0)}};
    InstrumentReadings planned;
    planned.poses.axis.resize(machine_.axes.size());
    for (std::size_t k = 0; k < kTrialReadings / 2; ++k) {
      RandomStream random(31, k);
      std::vector<double> pose = middle_;
      pose[i] = random_position(i, random);
      planned.append(pose, 0);
    }
    add_trial(fmt::format("an electronic level on the {} while {} moves",
                          setup.body == Body::tool ? "spindle head" : "table", axis.name),
              std::make_shared<ElectronicLevel>(setup), planned);
  }

  void add_ball_bar() {
    BallBarSetup setup;
    setup.name = "trial bar";
    setup.spindle_ball = SetupPoint::exact(machine_.tool_offset);
    setup.balls = {{"trial ball", SetupPoint::open(middle_point())}};
    const auto device = std::make_shared<BallBar>(setup);
    InstrumentReadings planned;
    planned.poses.axis.resize(machine_.axes.size());
    for (std::size_t k = 0; k < 2 * kTrialReadings; ++k) {
      const double turn = 2 * std::numbers::pi * 1.618034 * static_cast<double>(k);
      Vector3d direction = Vector3d::Zero();
      direction[static_cast<Eigen::Index>(k % 3)] = std::cos(turn);
      direction[static_cast<Eigen::Index>((k + 1) % 3)] = std::sin(turn);
      const auto pose =
          meet(machine_, middle_, Body::tool, Body::workpiece, *device->meeting_points(0), kBar_mm * direction);
      if (pose && covered(*pose)) planned.append(*pose, 0);
    }
    add_trial("a ball bar on circles in XY, YZ and ZX", device, planned);
  }

  /// The nest beside the middle, so that no axis average line goes through it.
  void add_r_test(const std::vector<std::size_t>& turning) {
    RTestSetup setup;
    setup.name = "trial nest";
    setup.nest = SetupPoint::open(middle_point() + Vector3d(kNestOffset_mm, 0.5 * kNestOffset_mm, 0));
    setup.spheres = {{"trial sphere", SetupPoint::exact(machine_.tool_offset)}};
    for (int k = 0; k < 3; ++k) {
      RTestSetup::Probe probe;
      probe.name = fmt::format("p{}", k);
      probe.direction = Vector3d::Unit(k);
      setup.probes.push_back(probe);
    }
    const auto device = std::make_shared<RTest>(setup);
    InstrumentReadings planned;
    planned.poses.axis.resize(machine_.axes.size());
    for (std::size_t k = 0; k < kTrialReadings; ++k) {
      RandomStream random(37, k);
      std::vector<double> pose = middle_;
      for (const std::size_t i : turning) pose[i] = random_position(i, random);
      const auto reached =
          meet(machine_, pose, Body::tool, Body::workpiece, *device->meeting_points(0), Vector3d::Zero());
      if (reached && covered(*reached)) planned.append(*reached, 0);
    }
    add_trial(fmt::format("an R-test (nest on the table, sphere in the spindle) while {} {}", names(turning),
                          turning.size() > 1 ? "turn" : "turns"),
              device, planned);
  }

  /// On the table, its middle on the axis average line, seen from the bed; put on twice, turned by one face.
  void add_polygon(std::size_t i) {
    const Axis& axis = machine_.axes[i];
    const double step = 2 * std::numbers::pi / static_cast<double>(kFaces);
    const bool whole_turn = axis.endless || axis.travel_max - axis.travel_min > 2 * std::numbers::pi - 1.01 * step;
    if (axis.side != ChainSide::workpiece || !whole_turn) return;
    PolygonGaugeSetup setup;
    setup.name = "trial prism";
    setup.polygon = regular_polygon(kFaces, kFaceDistance_mm, kPrismHeight_mm);
    setup.bench = regular_campaign(kFaces, kFaceDistance_mm, kPrismHeight_mm, {0}).bench;
    setup.faces.assign(kFaces, {SetupNumber::within(0, kFaceAzimuth_rad), SetupNumber::within(0, kFaceTilt_rad),
                                SetupNumber::within(kFaceDistance_mm, kFaceDistanceError_mm)});
    setup.mounts.resize(2);
    setup.mounts[0].name = "first";
    setup.mounts[1].name = "second";
    setup.mounts[1].turned_by = 1;
    PolygonPlacement placement;
    placement.axis = i;
    const Vector3d origin = machine_.bed_from_workpiece.translation;
    const Vector3d on_axis = axis.point + axis.direction * axis.direction.dot(origin - axis.point);
    placement.centre = machine_.bed_from_workpiece.inverse() * on_axis;
    placement.top = axis.direction;
    placement.toward_x = axis.direction.unitOrthogonal();
    placement.aligned_at = middle_;
    std::vector<double> first = middle_;
    if (!axis.endless) first[i] -= step * std::floor((first[i] - axis.travel_min) / step + 1e-9);
    try {
      place_polygon(machine_, placement, setup);
      const auto gauge = std::make_shared<PolygonGauge>(setup);
      const InstrumentReadings planned = polygon_plan(machine_, *gauge, i, first);
      add_trial(fmt::format("a polygon prism on the table, mounted twice, with autocollimators and displacement "
                            "sensors on the bed while {} turns",
                            axis.name),
                gauge, planned);
    } catch (const std::invalid_argument&) {
      return;  // It cannot stand on this axis.
    }
  }

  void add_tracker() {
    TrackerSetup setup;
    setup.stations.emplace_back();
    setup.stations[0].name = "trial tracker";
    setup.stations[0].body_from_tracker.translation = middle_point() + Vector3d(900, -700, 400);
    setup.stations[0].noise = TrackerNoise::isotropic(2, 1);
    const Vector3d offsets[] = {{0, 0, 0}, {120, 0, 40}, {-30, 110, -20}};
    for (const Vector3d& offset : offsets) {
      setup.reflectors.emplace_back();
      setup.reflectors.back().name = fmt::format("trial reflector {}", setup.reflectors.size());
      setup.reflectors.back().offset = machine_.tool_offset + offset;
    }
    PoseList poses;
    poses.axis.resize(machine_.axes.size());
    for (std::size_t k = 0; k < 2 * kTrialReadings; ++k) {
      RandomStream random(41, k);
      std::vector<double> pose;
      for (std::size_t i = 0; i < machine_.axes.size(); ++i) pose.push_back(random_position(i, random));
      if (covered(pose)) poses.append(pose);
    }
    if (poses.count() < kLeastReadings) return;
    stand_at_references(machine_, poses);
    TrackerSimulationOptions options;
    options.noise_factor = 0;
    options.line_of_sight = false;
    const ErrorSet errors = without_errors(problem_);
    const TrackerReadings readings = simulate_tracker(machine_, errors, setup, poses, options).readings;
    TrackerObservations trial(machine_, errors, setup, readings);
    list_.push_back(trial_measurement(
        problem_, kNone, "a laser tracker with three reflectors at known places, not on one line, all axes moving",
        trial, std::vector<TrialUnknown>(trial.unknowns().size(), {true, 0})));
  }

  const Problem& problem_;
  const Machine& machine_;
  std::vector<PossibleMeasurement>& list_;
  std::vector<TrialRange> ranges_;  // where errors are known, else the travel
  std::vector<double> middle_;
};

}  // namespace

void add_further_instruments(const Problem& problem, std::vector<PossibleMeasurement>& list) {
  FurtherInstruments(problem, list).add();
}

}  // namespace abbe
