#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/machine/state.h"

namespace abbe::test {

/// States of all kinds that follow from commands: of every axis, a torque about every rotary one, products.
inline Machine with_states(Machine machine, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  const std::size_t side = machine.workpiece_axis_count();
  for (std::size_t i = 0; i < machine.axes.size() && machine.states.size() < 8; ++i) {
    machine.states.push_back(
        {.name = "at" + std::to_string(i), .kind = StateKind::axis, .reference = 0.1 * normal(generator), .axis = i});
  }
  for (std::size_t i = 0; i < machine.axes.size() && machine.states.size() < 12; ++i) {
    if (machine.axes[i].kind != AxisKind::rotary) continue;
    MachineState torque{.name = "torque" + std::to_string(i), .kind = StateKind::gravity, .axis = i};
    const std::size_t end = i < side ? 0 : machine.axes.size() - 1;
    const Eigen::Vector3d away(60 * normal(generator), 60 * normal(generator), 60 * normal(generator));
    torque.loads.push_back({i, 40, machine.axes[i].point + away});
    torque.loads.push_back({end, 15, machine.axes[end].point - 2 * away});
    machine.states.push_back(torque);
  }
  const std::size_t simple = machine.states.size();
  for (std::size_t k = 0; k < 2; ++k) {
    machine.states.push_back({.name = "product" + std::to_string(k),
                              .kind = StateKind::product,
                              .first = generator() % simple,
                              .second = generator() % simple});
  }
  return machine;
}

/// Sides of approach of linear axes besides, one of them times another state.
inline Machine with_sides(Machine machine) {
  const std::size_t other = machine.states.empty() ? 1 : 0;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind != AxisKind::linear) continue;
    machine.states.push_back({.name = "side" + std::to_string(i), .kind = StateKind::approach, .axis = i});
  }
  const std::size_t last = machine.states.size() - 1;
  machine.states.push_back({.name = "sided", .kind = StateKind::product, .first = other, .second = last});
  return machine;
}

/// Largest factor of a state at places within the travel: of the order of what it becomes.
inline double usual_factor(const Machine& machine, const WordAxes& words, std::size_t state,
                           std::mt19937_64& generator) {
  double largest = machine.states[state].kind == StateKind::axis ? 1e-6 : 1;
  for (int k = 0; k < 20; ++k) {
    const WordValues place = random_axis_words(machine, words, generator);
    const std::vector<double> axes = commanded_axes(machine, words, ProgramCoordinates::axes, place);
    const std::vector<double> sides(machine.states.size(), 1.0);
    largest = std::max(largest, std::abs(state_factor(machine, state, axes, sides)));
  }
  return largest;
}

/// Most errors get a state, and become as large with it as they were.
inline ErrorSet errors_with_states(const Machine& machine, const WordAxes& words, std::mt19937_64& generator) {
  ErrorSet errors = mixed_errors(machine, generator());
  std::vector<double> usual;
  for (std::size_t j = 0; j < machine.states.size(); ++j) usual.push_back(usual_factor(machine, words, j, generator));
  const auto choose = [&] { return generator() % 4 == 0 ? kNoState : generator() % machine.states.size(); };
  for (ErrorMotion& motion : errors.motions) {
    motion.state = choose();
    if (motion.state == kNoState) continue;
    for (double& coefficient : motion.coefficients) coefficient /= usual[motion.state];
  }
  for (LocationError& location : errors.locations) {
    location.state = choose();
    if (location.state != kNoState) location.value /= usual[location.state];
  }
  return errors;
}

}  // namespace abbe::test
