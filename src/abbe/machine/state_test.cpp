#include "abbe/machine/state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/machine/chain.h"
#include "abbe/machine/machine.h"
#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// An arm with two joints about Y, 400 mm and 300 mm long, straight along X at zero, on a turntable about Z.
Machine arm() {
  Machine machine = parse_chain("w b C B1 B2 t").machine;
  machine.axes[1].point = {0, 0, 500};
  machine.axes[2].point = {400, 0, 500};
  machine.tool_reference = {700, 0, 500};
  MachineState shoulder{.name = "shoulder", .kind = StateKind::gravity, .axis = 1};
  shoulder.loads = {{1, 10, {200, 0, 500}}, {2, 6, {550, 0, 500}}};
  machine.states.push_back(shoulder);
  MachineState elbow{.name = "elbow", .kind = StateKind::gravity, .axis = 2};
  elbow.loads = {{2, 6, {550, 0, 500}}};
  machine.states.push_back(elbow);
  return machine;
}

TEST(MachineState, TheTorqueOfGravityIsThatOfTheLeverArms) {
  const Machine machine = arm();
  const double g = 9.80665;
  // Stretched out: 10 kg at 0.2 m and 6 kg at 0.55 m turn the shoulder about +Y.
  std::vector<double> q = {0.7, 0, 0};
  EXPECT_NEAR(state_factor(machine, 0, q, {}), g * (10 * 0.2 + 6 * 0.55), 1e-12);
  EXPECT_NEAR(state_factor(machine, 1, q, {}), g * 6 * 0.15, 1e-12);
  // Upper arm upright (B turns X to -Z), forearm level again: only the forearm has an arm.
  q = {0.7, -std::numbers::pi / 2, std::numbers::pi / 2};
  EXPECT_NEAR(state_factor(machine, 0, q, {}), g * 6 * 0.15, 1e-12);
  EXPECT_NEAR(state_factor(machine, 1, q, {}), g * 6 * 0.15, 1e-12);
  // Hanging on a wall: gravity along the turntable's X at zero.
  Machine wall = machine;
  wall.gravity = {g, 0, 0};
  q = {0, 0, 0};
  EXPECT_NEAR(state_factor(wall, 0, q, {}), 0, 1e-12);
}

TEST(MachineState, SlopesOfTheTorqueMatchCentralDifferences) {
  Machine machine = arm();
  machine.gravity = {1, -2, -9};
  machine.axes.insert(machine.axes.begin() + 1, {"X", AxisKind::linear, ChainSide::tool});
  for (MachineState& state : machine.states) {
    ++state.axis;
    for (GravityLoad& load : state.loads) ++load.carried_by;
  }
  machine.axes[2].direction = Eigen::Vector3d(0.1, 1, 0.2).normalized();
  // A slide between the joints' loads, and a turned gravity, so that no slope is zero for a trivial reason.
  machine.states.push_back(machine.states[0]);
  machine.states[2].axis = 1;
  ASSERT_TRUE(find_problems(machine).size() == 1) << "the copy has the same name";
  for (std::size_t s = 0; s < 3; ++s) {
    std::vector<double> q = {0.4, 30, -0.6, 1.1}, slopes;
    state_factor(machine, s, q, {}, &slopes);
    for (std::size_t i = 0; i < q.size(); ++i) {
      const double step = 1e-5;
      std::vector<double> up = q, down = q;
      up[i] += step;
      down[i] -= step;
      const double expected = (state_factor(machine, s, up, {}) - state_factor(machine, s, down, {})) / (2 * step);
      EXPECT_NEAR(slopes[i], expected, 1e-7) << s << " " << i;
    }
  }
}

TEST(MachineState, AMovingTableLiftsItsLoadsWithItsPrimedAxes) {
  Machine machine = parse_chain("w A' Y' b Z t").machine;
  machine.axes[0].point = {0, 0, -50};
  MachineState cradle{.name = "cradle", .kind = StateKind::gravity, .axis = 0};
  cradle.loads = {{0, 20, {0, 100, -50}}};
  machine.states.push_back(cradle);
  // Weight -z at +y from the axis line turns about -x, wherever Y stands.
  for (const double y : {0.0, 80.0}) {
    EXPECT_NEAR(state_factor(machine, 0, std::vector<double>{0, y, 0}, {}), -20 * 9.80665 * 0.1, 1e-12);
  }
  // Primed: a command of +30 deg turns the table by -30 deg, and the lever is shorter by its cosine.
  const std::vector<double> tilted = {std::numbers::pi / 6, 0, 0};
  EXPECT_NEAR(state_factor(machine, 0, tilted, {}), -20 * 9.80665 * 0.1 * std::cos(std::numbers::pi / 6), 1e-12);
}

TEST(MachineState, ProductsMultiplyAndTellTheirUnit) {
  Machine machine = arm();
  machine.states.push_back({.name = "payload", .unit = "kg"});
  MachineState loaded{.name = "loaded", .kind = StateKind::product};
  loaded.first = 2;
  loaded.second = 1;
  machine.states.push_back(loaded);
  const std::vector<double> q = {0.1, 0.2, 0.3}, given = {std::nan(""), std::nan(""), 3, std::nan("")};
  EXPECT_DOUBLE_EQ(state_factor(machine, 3, q, given), 3 * state_factor(machine, 1, q, given));
  EXPECT_TRUE(std::isnan(state_factor(machine, 3, q, {})));
  EXPECT_EQ(factor_unit(machine, 3), "kg N m");
  EXPECT_EQ(factor_unit(machine, 0), "N m");
  EXPECT_TRUE(depends_on_commands(machine, 3));
  EXPECT_FALSE(depends_on_commands(machine, 2));
}

TEST(MachineState, FactorsCountFromTheReference) {
  Machine machine = parse_chain("w X' b Z t").machine;
  machine.states.push_back({.name = "ambient", .unit = "degC", .reference = 20});
  machine.states.push_back({.name = "ram", .kind = StateKind::axis, .reference = 50, .axis = 1});
  machine.states.push_back({.name = "side", .kind = StateKind::approach, .axis = 0});
  const std::vector<double> q = {0, 80}, given = {23.5, std::nan(""), -1};
  EXPECT_THAT(state_factors(machine, q, given), ElementsAre(3.5, 30, -1));
  EXPECT_EQ(state_factor(machine, 2, q, {}), 0) << "a side that is not known";
  EXPECT_EQ(factor_unit(machine, 0), "K");
  EXPECT_EQ(state_column(machine.states[0]), "ambient_degC");
}

TEST(MachineState, ALagFollowsAStepAndARampExactly) {
  const double tau = 120;
  // A step within a time step of zero, then constant: the exponential, whatever the times are.
  const std::vector<double> time = {0, 0, 7, 60, 61, 600};
  const std::vector<double> step = lagged(time, std::vector<double>{20, 25, 25, 25, 25, 25}, tau);
  EXPECT_EQ(step[1], 20);
  for (std::size_t k = 2; k < time.size(); ++k) EXPECT_NEAR(step[k], 25 - 5 * std::exp(-time[k] / tau), 1e-13);
  // A ramp of 0.01 K/s: in the end it is tau times the rate behind.
  std::vector<double> ramp_time, ramp;
  for (int k = 0; k <= 100; ++k) {
    ramp_time.push_back(13.7 * k);
    ramp.push_back(20 + 0.01 * ramp_time.back());
  }
  const std::vector<double> behind = lagged(ramp_time, ramp, tau);
  for (std::size_t k = 0; k < ramp.size(); ++k) {
    EXPECT_NEAR(behind[k], ramp[k] - 0.01 * tau * (1 - std::exp(-ramp_time[k] / tau)), 1e-12);
  }
  EXPECT_TRUE(lagged({}, {}, tau).empty());
}

TEST(MachineState, WhatIsWrongWithAStateIsSaid) {
  const auto problem = [](const auto& change) {
    Machine machine = arm();
    change(machine);
    const std::vector<MachineProblem> problems = find_problems(machine);
    return problems.empty() ? std::string() : problems.front().text();
  };
  EXPECT_EQ(problem([](Machine&) {}), "");
  EXPECT_THAT(problem([](Machine& m) { m.states[0].loads[0].carried_by = 0; }),
              HasSubstr("state.shoulder.load: is not carried by B1 or by an axis that B1 carries"));
  EXPECT_THAT(problem([](Machine& m) { m.states[0].loads.clear(); }), HasSubstr("needs at least one load"));
  EXPECT_THAT(problem([](Machine& m) { m.states[0].loads[0].mass_kg = 0; }), HasSubstr("no mass above 0 kg"));
  EXPECT_THAT(problem([](Machine& m) { m.states[1].name = "shoulder"; }), HasSubstr("is used twice"));
  EXPECT_THAT(problem([](Machine& m) { m.states[1].name = "B1"; }), HasSubstr("is the name of an axis"));
  EXPECT_THAT(problem([](Machine& m) { m.states[1].name = "time"; }), HasSubstr("is the name of a column"));
  EXPECT_THAT(problem([](Machine& m) { m.states[1].name = "a b"; }), HasSubstr("must be letters"));
  EXPECT_THAT(problem([](Machine& m) { m.states.push_back({.name = "t", .unit = "F"}); }),
              HasSubstr("'F' is not a unit of states"));
  EXPECT_THAT(problem([](Machine& m) {
                m.states.push_back({.name = "core", .kind = StateKind::lag, .unit = "K", .first = 0});
              }),
              HasSubstr("state.core.of: is not a measured state"));
  EXPECT_THAT(problem([](Machine& m) { m.states.push_back({.name = "p", .kind = StateKind::product}); }),
              HasSubstr("two states that are not products"));
  EXPECT_THAT(problem([](Machine& m) {
                for (int i = 0; i < 17; ++i) m.states.push_back({.name = "s" + std::to_string(i), .unit = "K"});
              }),
              HasSubstr("more than 16 states"));
}

}  // namespace
}  // namespace abbe
