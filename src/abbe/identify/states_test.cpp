#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/identify/identify.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

/// A slide with an arm on it: the scale grows with the temperature, the lower joint gives way to the weight of the arm
/// and of what it carries.
struct ArmCase {
  Machine machine = parse_chain("w b X C B t").machine;
  ErrorSet truth;
  TrackerSetup setup;
  PoseList poses;

  ArmCase() {
    machine.axes[0].travel_min = -500;
    machine.axes[0].travel_max = 500;
    machine.axes[1].endless = false;
    machine.axes[1].travel_min = -2.6;
    machine.axes[1].travel_max = 2.6;
    machine.axes[2].travel_min = -1.4;
    machine.axes[2].travel_max = 1.0;
    machine.axes[2].point = {0, 0, 600};
    machine.tool_reference = {900, 0, 600};
    machine.states.push_back({.name = "ambient", .unit = "degC", .reference = 20});
    machine.states.push_back({.name = "payload", .unit = "kg"});
    MachineState torque{.name = "torque", .kind = StateKind::gravity, .axis = 2};
    torque.loads = {{2, 12, {400, 0, 600}}};
    machine.states.push_back(torque);
    MachineState flange{.name = "flange", .kind = StateKind::gravity, .axis = 2};
    flange.loads = {{2, 1, {900, 0, 600}}};
    machine.states.push_back(flange);
    machine.states.push_back({.name = "loaded", .kind = StateKind::product, .first = 1, .second = 3});

    const Basis cubic{.kind = BasisKind::legendre, .order = 3, .from = -500, .to = 500};
    const Basis line{.kind = BasisKind::legendre, .order = 1, .from = -500, .to = 500};
    const Basis even{.kind = BasisKind::legendre, .order = 0, .from = -1.4, .to = 1.0};
    truth.motions.push_back({0, Component::X, cubic, {0, 0.02, -0.008, 0.005}, {}});
    truth.motions.push_back({0, Component::Z, cubic, {0, 0, 0.012, -0.004}, {}});
    truth.motions.push_back({0, Component::X, line, {0.0008, 0.00575}, {}, 0});  // 11.5 um/m/K over 1 m
    truth.motions.push_back({2, Component::B, even, {1.9e-6}, {}, 2});
    truth.motions.push_back({2, Component::B, even, {2.2e-6}, {}, 4});
    truth.locations.push_back({1, Component::B, 40e-6, 0});
    truth.locations.push_back({1, Component::B, -3e-6, 0, 0});

    setup.stations.resize(1);
    setup.stations[0].body = Body::bed;
    setup.stations[0].noise = TrackerNoise::isotropic(3, 0);
    setup.stations[0].body_from_tracker = {rotation_about(Eigen::Vector3d::UnitZ(), 1.2), {1500, -2200, 300}};
    for (const Eigen::Vector3d& offset :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(40, 120, -60), Eigen::Vector3d(-50, -80, 90)}) {
      setup.reflectors.emplace_back();
      setup.reflectors.back().offset = offset;
    }
    RandomStream random(3);
    poses.state.resize(machine.states.size());
    for (int k = 0; k < 200; ++k) {
      poses.append({random.uniform(-500, 500), random.uniform(-2.6, 2.6), random.uniform(-1.4, 1.0)});
      poses.state[0].push_back(18 + 9.0 * k / 199);
      poses.state[1].push_back(k % 3 == 0 ? 0 : 4.5);
    }
  }

  /// Readings with noise, identified from errors of zero.
  Identification identified(const ErrorSet& structure, std::uint64_t seed) const {
    TrackerSimulationOptions options;
    options.seed = seed;
    options.line_of_sight = false;
    TrackerReadings readings = simulate_tracker(machine, truth, setup, poses, options).readings;
    EXPECT_EQ(readings.poses.state[0].size(), readings.count());
    ErrorSet start = structure;
    start.set_parameters(std::vector<double>(start.parameter_count(), 0.0));
    TrackerSetup given = setup;
    given.stations[0].estimate_pose = true;
    const auto observations = std::make_shared<TrackerObservations>(machine, start, given, readings);
    Problem problem = estimate_everything(machine, start, {observations});
    // The tool offset is known: three reflectors at stated places.
    problem.machine_parameters.resize(start.parameter_count() - 3);
    return identify(problem);
  }
};

TEST(IdentifyStates, ThermalGrowthAndComplianceAreRecoveredWithinTheirUncertainty) {
  const ArmCase c;
  const std::vector<std::string> names = parameter_names(c.machine, c.truth);
  const std::vector<double> real = c.truth.parameters();
  std::size_t within = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Identification found = c.identified(c.truth, seed);
    ASSERT_EQ(found.status, IdentifyStatus::converged) << found.message;
    EXPECT_NEAR(found.statistics.variance_factor, 1, 0.15);
    std::size_t with_states = 0;
    for (std::size_t i = 0; i < found.parameters.size(); ++i) {
      const std::string& name = found.parameters[i].name;
      if (name.find('*') == std::string::npos) continue;
      const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
      ASSERT_LT(at, real.size()) << name;
      const double u = found.standard_uncertainties[static_cast<Eigen::Index>(i)];
      const double off = found.estimates[static_cast<Eigen::Index>(i)] - real[at];
      EXPECT_GT(u, 0) << name << " is fixed";
      EXPECT_LT(u, 0.25 * std::abs(real[at])) << name << " is hardly determined";
      EXPECT_LT(std::abs(off), 4 * u) << name;
      within += std::abs(off) < 2 * u ? 1 : 0;
      ++all;
      ++with_states;
    }
    EXPECT_EQ(with_states, 5U);
    EXPECT_EQ(found.errors.motions[2].state, 0U);
    EXPECT_EQ(found.errors.locations[1].state, 0U);
    EXPECT_GT(found.errors.locations[1].standard_uncertainty, 0);
  }
  EXPECT_GE(within, all * 8 / 10) << "about 95 % are within two standard uncertainties";
}

TEST(IdentifyStates, LeftOutTheyShowInTheFit) {
  const ArmCase c;
  ErrorSet plain = c.truth;
  std::erase_if(plain.motions, [](const ErrorMotion& motion) { return motion.state != kNoState; });
  std::erase_if(plain.locations, [](const LocationError& location) { return location.state != kNoState; });
  EXPECT_GT(c.identified(plain, 1).statistics.variance_factor, 20);
}

TEST(IdentifyStates, ReadingsWithoutAStateAreRefusedByName) {
  ArmCase c;
  c.poses.state[0].clear();
  try {
    c.identified(c.truth, 1);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "errors depend on the state ambient, which is not given at all poses");
  }
}

}  // namespace
}  // namespace abbe
