#pragma once

#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "abbe/runtime/abbe_runtime_states.h"
#include "abbe/runtime/frozen_for_test.h"

namespace abbe::test {

struct FreeStatesOfRuntime {
  void operator()(abbe_runtime_states* states) const { abbe_runtime_states_free(states); }
};
using StatesPointer = std::unique_ptr<abbe_runtime_states, FreeStatesOfRuntime>;

inline StatesPointer states_of(const abbe_runtime* runtime, const abbe_runtime_policy* policy = nullptr) {
  abbe_runtime_states* states = nullptr;
  EXPECT_EQ(abbe_runtime_states_make(runtime, policy, &states), ABBE_OK);
  return StatesPointer(states);
}

/// The trunnion mill, with states of every kind that can be frozen.
inline Machine mill_with_states() {
  Machine mill = trunnion_mill();
  const std::size_t a = mill.find_axis("A"), z = mill.find_axis("Z"), c = mill.find_axis("C");
  mill.states = {
      {.name = "ambient", .unit = "degC", .reference = 20},
      {.name = "column", .kind = StateKind::lag, .unit = "degC", .reference = 20, .first = 0, .time_constant = 1800},
      {.name = "payload", .unit = "kg"},
      {.name = "ram", .kind = StateKind::axis, .reference = -200, .axis = z},
      {.name = "torque",
       .kind = StateKind::gravity,
       .axis = a,
       .loads = {{a, 40, {10, 150, 60}}, {c, 5, {80, -20, 120}}}},
      {.name = "loaded", .kind = StateKind::product, .first = 2, .second = 4},
      {.name = "warm_ram", .kind = StateKind::product, .first = 1, .second = 3},
      {.name = "heavy_and_warm", .kind = StateKind::product, .first = 0, .second = 2},
      {.name = "ram_squared", .kind = StateKind::product, .first = 3, .second = 3},
  };
  return mill;
}

/// Errors without states and with all of them; motions over other functions too, and moving lines.
inline ErrorSet errors_with_states(const Machine& mill) {
  ErrorSet errors = tens_of_micrometres(mill, 5);
  const auto state = [&](const char* name) { return find_state(mill, name); };
  const auto axis = [&](const char* name) { return mill.find_axis(name); };
  const std::vector<ErrorMotion> plain = errors.motions;
  for (std::size_t k = 0; k < plain.size(); ++k) {
    // Over the same functions as without a state.
    if (k % 3 != 0) continue;
    ErrorMotion motion = plain[k];
    motion.state = state(k % 2 == 0 ? "ambient" : "column");
    for (double& coefficient : motion.coefficients) coefficient *= 0.05;
    errors.motions.push_back(motion);
  }
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = -510, .to = 0};
  errors.motions.push_back({axis("Z"), Component::Y, line, {0.002, 0.003}, {}, state("column")});
  errors.motions.push_back({axis("Z"), Component::A, line, {1e-7, 2e-7}, {}, state("ram")});
  errors.motions.push_back({axis("Z"), Component::B, line, {1e-8, 3e-8}, {}, state("warm_ram")});
  errors.motions.push_back({axis("Z"), Component::X, line, {4e-8, 3e-8}, {}, state("ram_squared")});
  const Basis table{.kind = BasisKind::table_linear, .from = -300, .to = 300, .nodes = {-300, -50, 100, 300}};
  errors.motions.push_back({axis("X"), Component::Z, table, {1e-3, -2e-3, 1e-3, 3e-3}, {}, state("heavy_and_warm")});
  const Basis constant{.kind = BasisKind::monomial, .order = 0, .from = -120 * kDegree, .to = 30 * kDegree};
  errors.motions.push_back({axis("A"), Component::A, constant, {1e-6}, {}, state("torque")});
  errors.motions.push_back({axis("A"), Component::Z, constant, {1e-5}, {}, state("loaded")});
  errors.locations.push_back({axis("Z"), Component::A, 4e-6, 0, state("ambient")});
  errors.locations.push_back({axis("X"), Component::C, 3e-6, 0, state("column")});
  errors.locations.push_back({axis("C"), Component::Y, 1e-3, 0, state("ambient")});
  errors.locations.push_back({axis("A"), Component::B, 2e-7, 0, state("torque")});
  errors.locations.push_back({axis("A"), Component::C, 1e-8, 0, state("warm_ram")});
  return errors;
}

inline FreezeOptions options_with_states(const Machine& mill) {
  FreezeOptions options;
  options.tool = mill.tool_offset;
  options.poses = 30;
  options.version = "0.0.test";
  options.state_ranges.resize(mill.states.size());
  options.state_ranges[0] = {15, 30};
  if (mill.states.size() > 2) options.state_ranges[2] = {0, 2};
  return options;
}

inline FrozenCompensation frozen_with_states(const Machine& mill, const ErrorSet& errors) {
  FrozenCompensation frozen = freeze(mill, errors, options_with_states(mill));
  EXPECT_EQ(frozen.problem, "");
  return frozen;
}

/// Three axes whose squareness, pitch and screw follow temperatures: quick, and never near a singularity.
inline Machine warm_mill() {
  Machine mill = three_axis_mill();
  mill.states = {
      {.name = "ambient", .unit = "degC", .reference = 20},
      {.name = "column", .kind = StateKind::lag, .unit = "degC", .reference = 20, .first = 0, .time_constant = 900}};
  return mill;
}

inline ErrorSet warm_errors(const Machine& mill) {
  ErrorSet errors = tens_of_micrometres(mill, 9);
  const Axis& axis = mill.axes[0];
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = axis.travel_min, .to = axis.travel_max};
  errors.motions.push_back({0, Component::X, line, {0.001, 0.003}, {}, 0});
  errors.motions.push_back({0, Component::B, line, {2e-6, 1e-6}, {}, 1});
  return errors;
}

inline FrozenCompensation frozen_warm_mill() {
  const Machine mill = warm_mill();
  return frozen_with_states(mill, warm_errors(mill));
}

}  // namespace abbe::test
