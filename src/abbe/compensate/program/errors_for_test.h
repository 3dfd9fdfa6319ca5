#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "abbe/errors/random_errors.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe::test {

/// Errors of tens of micrometres and microradians, every one the machine can have.
inline ErrorSet tens_of_micrometres(const Machine& machine, std::uint64_t seed) {
  RandomErrorOptions options;
  options.seed = seed;
  options.translation_um = 40;
  options.rotation_urad = 80;
  options.location_um = 60;
  options.location_urad = 150;
  ErrorSet errors = random_errors(machine, options);
  errors.tool_offset_error = {0.01, -0.02, 0.015};
  return errors;
}

/// Commands with room at both ends of travel for corrections.
inline std::vector<double> inner_commands(const Machine& machine, std::mt19937_64& generator) {
  std::vector<double> pose = random_commands(machine, generator);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const Axis& axis = machine.axes[i];
    if (axis.endless) continue;
    const double middle = 0.5 * (axis.travel_min + axis.travel_max);
    pose[i] = middle + 0.98 * (pose[i] - middle);
  }
  return pose;
}

}  // namespace abbe::test
