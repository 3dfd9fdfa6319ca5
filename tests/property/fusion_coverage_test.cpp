#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/instruments/ball_bar.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/interferometer.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "abbe/verify/error_map.h"

namespace abbe {
namespace {

constexpr std::size_t kCampaigns = 200;
constexpr double kTranslation = 8e-3;  // mm, prior standard uncertainty of a coefficient
constexpr double kRotation = 15e-6;    // rad

enum Choice { tracker_alone, bar_alone, laser_alone, together, kChoices };

/// Every error motion of a three-axis machine as a parabola, coefficients as the prior says.
ErrorSet drawn_errors(const Machine& machine, RandomStream* random) {
  ErrorSet errors;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    for (int component = 0; component < kComponentCount; ++component) {
      ErrorMotion motion;
      motion.axis = axis;
      motion.component = static_cast<Component>(component);
      motion.basis = {BasisKind::legendre, 2, machine.axes[axis].travel_min, machine.axes[axis].travel_max};
      for (int i = 0; i < 3; ++i) {
        const double size = is_rotation(motion.component) ? kRotation : kTranslation;
        motion.coefficients.push_back(random != nullptr ? size * random->normal() : 0);
      }
      errors.motions.push_back(motion);
    }
  }
  return errors;
}

/// One measurement of one machine with three instruments, and what each of them and all together make of it.
class FusedCampaign {
 public:
  FusedCampaign(const Machine& machine, std::uint64_t seed) : machine_(machine), random_(seed, 1), seed_(seed) {
    truth_ = drawn_errors(machine, &random_);
    add_tracker();
    add_ball_bar();
    add_laser();
  }

  struct Outcome {
    double error = 0;        ///< mean volumetric error left at unseen poses, mm
    double uncertainty = 0;  ///< its predicted root mean square, mm
    std::size_t within = 0;  ///< poses whose volumetric error lies in the k = 2 interval of its prediction
    std::size_t poses = 0;
    std::size_t coordinates_within = 0, coordinates = 0;
  };

  Outcome identified_with(const std::vector<std::size_t>& chosen) {
    std::vector<std::shared_ptr<Observations>> observations;
    for (const std::size_t i : chosen) observations.push_back(borrowed(*observations_[i]));
    Problem problem = estimate_everything(machine_, drawn_errors(machine_, nullptr), observations);
    problem.machine_parameters.resize(problem.machine_parameters.size() - 3);  // not the tool offset
    const std::vector<bool> angles = parameters_are_angles(problem.machine, problem.errors);
    for (const std::size_t p : problem.machine_parameters) {
      problem.priors.push_back({{ParameterId::kMachine, p}, 0, angles[p] ? kRotation : kTranslation});
    }
    for (std::size_t o = 0; o < chosen.size(); ++o) {
      for (const KnownQuantity& known : known_[chosen[o]]) {
        problem.priors.push_back({{o, known.unknown}, known.value, known.uncertainty});
      }
    }
    const Identification result = identify(problem);
    EXPECT_EQ(result.status, IdentifyStatus::converged) << result.message;
    EXPECT_TRUE(result.gauge.constraints.empty());
    return compared(result);
  }

 private:
  struct KnownQuantity {
    std::size_t unknown;
    double value, uncertainty;
  };

  void add_instrument(const std::shared_ptr<const Instrument>& known, const InstrumentReadings& plan) {
    std::vector<double> real;
    std::vector<KnownQuantity> priors;
    std::size_t unknown = 0;
    for (const SetupQuantity& quantity : known->quantities()) {
      real.push_back(quantity.value + quantity.standard_uncertainty * random_.normal());
      if (quantity.knowledge == Knowledge::exact) continue;
      if (quantity.knowledge == Knowledge::within) {
        priors.push_back({unknown, quantity.value, quantity.standard_uncertainty});
      }
      ++unknown;
    }
    InstrumentSimulationOptions options;
    options.seed = seed_ * 31 + observations_.size();
    const InstrumentReadings readings =
        simulate_instrument(machine_, truth_, known->with_values(real), plan, options).readings;
    observations_.push_back(
        std::make_unique<InstrumentObservations>(machine_, drawn_errors(machine_, nullptr), known, readings));
    known_.push_back(priors);
  }

  void add_tracker() {
    TrackerSetup setup;
    setup.stations.resize(1);
    setup.stations[0].body_from_tracker = RigidTransform::translate({-900, -1200, 200});
    setup.stations[0].noise = TrackerNoise::isotropic(4, 2);
    for (const Eigen::Vector3d& offset : {Eigen::Vector3d(0, 0, -150), Eigen::Vector3d(80, 0, -120)}) {
      Reflector reflector;
      reflector.name = "R" + std::to_string(setup.reflectors.size() + 1);
      reflector.offset = offset;
      setup.reflectors.push_back(reflector);
    }
    TrackerSimulationOptions options;
    options.seed = seed_;
    const PoseList poses = random_plan(machine_, full_ranges(machine_, 2), 80, seed_ + 17);
    observations_.push_back(
        std::make_unique<TrackerObservations>(machine_, drawn_errors(machine_, nullptr), setup,
                                              simulate_tracker(machine_, truth_, setup, poses, options).readings));
    known_.emplace_back();
  }

  void add_ball_bar() {
    BallBarSetup setup;
    setup.spindle_ball = SetupPoint::exact({0, 0, -150});
    setup.balls = {{"B1", SetupPoint::within({-100, 0, 200}, 0.05)}, {"B2", SetupPoint::within({120, 60, 220}, 0.05)}};
    setup.length_deviation = SetupNumber::within(0, 0.5e-3);
    setup.noise = 0.3e-3;
    const auto bar = std::make_shared<BallBar>(setup);
    InstrumentReadings plan;
    const std::array<Eigen::Vector3d, 3> axes = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                                 Eigen::Vector3d::UnitZ()};
    for (std::size_t item = 0; item < 2; ++item) {
      for (std::size_t plane = 0; plane < 3; ++plane) {
        CircleDescription circle;
        circle.u = axes[plane];
        circle.v = axes[(plane + 1) % 3];
        circle.radius = 100;
        circle.to_angle = kTurn;
        circle.count = 24;
        const PoseList poses =
            circle_plan(machine_, {0, 0, 0}, Body::tool, Body::workpiece, *bar->meeting_points(item), circle);
        for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), item);
      }
    }
    add_instrument(bar, plan);
  }

  void add_laser() {
    InterferometerSetup setup;
    setup.components = {InterferometerComponent::length, InterferometerComponent::pitch, InterferometerComponent::yaw};
    setup.length_scale = SetupNumber::within(0, 0.5e-6);
    InstrumentReadings plan;
    std::vector<double> middle;
    for (const Axis& axis : machine_.axes) middle.push_back((axis.travel_min + axis.travel_max) / 2);
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const Axis& axis = machine_.axes[i];
      InterferometerRun run;
      run.name = axis.name;
      run.optic = SetupPoint::exact({0, 0, -150});
      // Positive lengths along the tool's motion in the workpiece frame.
      run.direction = axis.side == ChainSide::workpiece ? Eigen::Vector3d(-axis.sense() * axis.direction)
                                                        : Eigen::Vector3d(axis.sense() * axis.direction);
      run.up = std::abs(run.direction.z()) > 0.5 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
      setup.runs.push_back(run);
      for (const double position : evenly_spaced(axis.travel_min, axis.travel_max, 21)) {
        std::vector<double> positions = middle;
        positions[i] = position;
        plan.append(positions, i);
      }
    }
    add_instrument(std::make_shared<Interferometer>(setup), plan);
  }

  Outcome compared(const Identification& result) const {
    const PoseList list = random_plan(machine_, full_ranges(machine_, 2), 25, seed_ * 7 + 3);
    const PoseSource poses = pose_source(list);
    ParameterCovariance covariance;
    covariance.covariance = machine_covariance(result, result.errors.parameter_count());
    for (std::size_t p = 0; p < result.errors.parameter_count(); ++p) covariance.parameters.push_back(p);
    ErrorMapOptions options;
    options.threads = 1;
    options.remove_rigid_motion = true;  // where the workpiece stands is no error of the machine
    const ErrorMap left = error_map(machine_, truth_, &result.errors, poses, options);
    const ErrorMap real = error_map(machine_, truth_, nullptr, poses, options);
    options.covariance = &covariance;
    const ErrorMap predicted = error_map(machine_, result.errors, nullptr, poses, options);
    Outcome outcome;
    double variance = 0;
    for (std::size_t k = 0; k < left.count(); ++k) {
      outcome.error += left.norm[k] / static_cast<double>(left.count());
      outcome.within += std::abs(predicted.norm[k] - real.norm[k]) <= 2 * predicted.norm_uncertainty[k] ? 1U : 0U;
      ++outcome.poses;
      for (std::size_t d = 0; d < 3; ++d) {
        const double u = predicted.uncertainty[d][k];
        variance += u * u / static_cast<double>(left.count());
        outcome.coordinates_within += std::abs(left.displacement[d][k]) <= 2 * u ? 1U : 0U;
        ++outcome.coordinates;
      }
    }
    outcome.uncertainty = std::sqrt(variance);
    return outcome;
  }

  const Machine& machine_;
  RandomStream random_;
  std::uint64_t seed_;
  ErrorSet truth_;
  std::vector<std::unique_ptr<Observations>> observations_;
  std::vector<std::vector<KnownQuantity>> known_;
};

TEST(Fusion, OfTrackerBallBarAndLaserBeatsEachAloneAndKnowsHowGoodItIs) {
  const Machine machine = read_machine(std::string(ABBE_SOURCE_DIR "/examples/machines/three-axis-mill.machine.toml"));
  const std::array<std::vector<std::size_t>, kChoices> choices = {{{0}, {1}, {2}, {0, 1, 2}}};
  std::array<double, kChoices> error{}, uncertainty{};
  std::array<std::size_t, kChoices> within{}, poses{}, coordinates_within{}, coordinates{};
  std::size_t best = 0;
  for (std::size_t campaign = 0; campaign < kCampaigns; ++campaign) {
    double smallest_alone = 1e9;
    for (std::size_t c = 0; c < kChoices; ++c) {
      FusedCampaign measured(machine, 1000 + campaign);
      const FusedCampaign::Outcome outcome = measured.identified_with(choices[c]);
      error[c] += outcome.error / kCampaigns;
      uncertainty[c] += outcome.uncertainty / kCampaigns;
      within[c] += outcome.within;
      poses[c] += outcome.poses;
      coordinates_within[c] += outcome.coordinates_within;
      coordinates[c] += outcome.coordinates;
      if (c != together) smallest_alone = std::min(smallest_alone, outcome.error);
      if (c == together && outcome.error < smallest_alone) ++best;
    }
  }
  const char* const names[] = {"tracker", "ball bar", "laser", "together"};
  for (std::size_t c = 0; c < kChoices; ++c) {
    const double coverage = 100.0 * static_cast<double>(within[c]) / static_cast<double>(poses[c]);
    const double by_coordinate =
        100.0 * static_cast<double>(coordinates_within[c]) / static_cast<double>(coordinates[c]);
    std::printf(
        "%-10s error left %.3f um, predicted %.3f um (rms); within k = 2: %.1f %% of volumetric errors, %.1f %% "
        "of coordinates\n",
        names[c], 1e3 * error[c], 1e3 * uncertainty[c], coverage, by_coordinate);
    EXPECT_GE(by_coordinate, 93) << names[c];
    EXPECT_LE(by_coordinate, 97) << names[c];
  }
  const double coverage = 100.0 * static_cast<double>(within[together]) / static_cast<double>(poses[together]);
  EXPECT_GE(coverage, 93);
  EXPECT_LE(coverage, 97);
  for (const Choice alone : {tracker_alone, bar_alone, laser_alone}) {
    EXPECT_LT(error[together], 0.85 * error[alone]) << names[alone];
    EXPECT_LT(uncertainty[together], 0.85 * uncertainty[alone]) << names[alone];
  }
  std::printf("together is the best of all in %zu of %zu campaigns\n", best, kCampaigns);
  EXPECT_GT(best, kCampaigns * 8 / 10);
}

}  // namespace
}  // namespace abbe
