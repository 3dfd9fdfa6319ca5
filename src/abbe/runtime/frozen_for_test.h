#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "abbe/errors/random_errors.h"
#include "abbe/machine/machines_for_test.h"
#include "abbe/runtime/abbe_runtime.h"
#include "abbe/runtime/freeze.h"

namespace abbe::test {

struct FreeRuntime {
  void operator()(abbe_runtime* runtime) const { abbe_runtime_free(runtime); }
};
using RuntimePointer = std::unique_ptr<abbe_runtime, FreeRuntime>;

inline RuntimePointer loaded(const std::vector<unsigned char>& bytes) {
  abbe_runtime* runtime = nullptr;
  char text[256];
  EXPECT_EQ(abbe_runtime_load(bytes.data(), bytes.size(), text, sizeof text, &runtime), ABBE_OK) << text;
  return RuntimePointer(runtime);
}

/// A compensation that is tried at few poses only.
inline FrozenCompensation quickly_frozen(const Machine& machine, const ErrorSet& errors, bool world_at_joints = false) {
  FreezeOptions options;
  options.tool = machine.tool_offset;
  options.world_zero_at_joints = world_at_joints;
  options.poses = 30;
  options.version = "0.0.test";
  FrozenCompensation frozen = freeze(machine, errors, options);
  EXPECT_EQ(frozen.problem, "");
  return frozen;
}

inline RuntimePointer runtime_of(const Machine& machine, const ErrorSet& errors, bool world_at_joints = false) {
  return loaded(quickly_frozen(machine, errors, world_at_joints).bytes);
}

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
