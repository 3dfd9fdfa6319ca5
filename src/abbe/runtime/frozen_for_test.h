#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "abbe/compensate/program/errors_for_test.h"
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

}  // namespace abbe::test
