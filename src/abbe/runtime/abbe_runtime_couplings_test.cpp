#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/runtime/frozen_for_test.h"
#include "abbe/runtime/frozen_layout.h"

namespace abbe {
namespace {

using testing::HasSubstr;

std::vector<double> corrected_by(const CompensatedInverse& inverse, const std::vector<double>& nominal,
                                 CorrectionStatus& status) {
  std::vector<double> result(nominal);
  std::vector<const double*> in;
  std::vector<double*> out;
  for (std::size_t i = 0; i < nominal.size(); ++i) {
    in.push_back(&nominal[i]);
    out.push_back(&result[i]);
  }
  inverse.correct({in, 1}, {out, &status, nullptr, nullptr});
  return result;
}

/// With the position of the coupled axis as a state of an error too.
ErrorSet errors_of_coupled(Machine& machine) {
  ErrorSet errors = test::tens_of_micrometres(machine, 3);
  MachineState state{.name = "position", .kind = StateKind::axis};
  state.axis = machine.find_axis("A");
  machine.states.push_back(state);
  errors.locations.push_back(
      {.axis = machine.find_axis("C"), .component = Component::X, .value = 0.02, .state = machine.states.size() - 1});
  return errors;
}

TEST(RuntimeCouplings, CorrectsCommandsAsTheLibraryDoes) {
  Machine machine = test::coupled_fork_head();
  const ErrorSet errors = errors_of_coupled(machine);
  const FrozenCompensation frozen = test::quickly_frozen(machine, errors);
  EXPECT_EQ(frozen.format, 5);
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  CorrectionOptions options;
  options.position_tolerance = 1e-12;
  options.orientation_tolerance = 1e-13;
  options.target = TargetKind::point_and_direction;
  const CompensatedInverse library(machine, errors, options);
  std::mt19937_64 generator(7);
  int compared = 0;
  for (int k = 0; k < 200; ++k) {
    const std::vector<double> nominal = test::inner_commands(machine, generator);
    std::vector<double> joints(nominal), back(nominal);
    const int result = abbe_runtime_correct(runtime.get(), nullptr, nominal.data(), nullptr, 1, joints.data());
    CorrectionStatus status = CorrectionStatus::not_run;
    const std::vector<double> expected = corrected_by(library, nominal, status);
    if (status != CorrectionStatus::reached || (result & ABBE_RESULT_MASK) != ABBE_OK) continue;
    ++compared;
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal);
    const RigidTransform there = actual_workpiece_from_tool(machine, errors, joints);
    EXPECT_LE((there.translation - wanted.translation).norm(), 1e-11) << k;
    if (std::abs(nominal[4] + 0.1 * nominal[3]) > 0.05) {  // far from the singularity
      for (std::size_t i = 0; i < joints.size(); ++i) EXPECT_NEAR(joints[i], expected[i], 2e-8) << k << " " << i;
    }
    ASSERT_GE(abbe_runtime_uncorrect(runtime.get(), nullptr, joints.data(), nullptr, 1, back.data()), 0);
    const RigidTransform again = nominal_workpiece_from_tool(machine, back);
    EXPECT_LE((again.translation - wanted.translation).norm(), 1e-10) << k;
  }
  EXPECT_GE(compared, 150);
}

TEST(RuntimeCouplings, ForwardAndInverseAreInverseToEachOther) {
  const Machine machine = test::coupled_fork_head();
  const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 19));
  abbe_runtime_state state;
  abbe_runtime_start(&state);
  std::mt19937_64 generator(23);
  for (int k = 0; k < 200; ++k) {
    const std::vector<double> nominal = test::inner_commands(machine, generator);
    const Eigen::Vector3d point = nominal_workpiece_from_tool(machine, nominal).translation;
    std::vector<double> joints(nominal), words(nominal), plain(nominal);
    Eigen::Vector3d back;
    ASSERT_GE(abbe_runtime_nominal_inverse(runtime.get(), point.data(), nominal.data(), nullptr, plain.data()), 0);
    for (std::size_t i = 0; i < nominal.size(); ++i) EXPECT_NEAR(plain[i], nominal[i], 1e-9);
    const int there =
        abbe_runtime_inverse(runtime.get(), &state, point.data(), nominal.data(), nullptr, 1, joints.data());
    ASSERT_GE(there, 0);
    for (std::size_t i = 0; i < nominal.size(); ++i)
      EXPECT_NEAR(joints[i] - nominal[i], state.correction[i], 1e-9) << i;
    ASSERT_GE(abbe_runtime_forward(runtime.get(), &state, joints.data(), nullptr, 1, back.data(), words.data()), 0);
    EXPECT_LE((back - point).norm(), 1e-11) << k;
    if ((there & ABBE_RESULT_MASK) != ABBE_OK) continue;
    for (const std::size_t i : {std::size_t{3}, std::size_t{4}}) EXPECT_NEAR(words[i], nominal[i], 1e-11) << k;
  }
}

/// Travels are limits of commands, ranges of errors are limits of positions.
TEST(RuntimeCouplings, FlagsLookAtCommandsAndPositions) {
  Machine machine = test::coupled_fork_head();
  machine.axes[4].travel_min = -1;
  machine.axes[4].travel_max = 1;
  const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 3));
  std::vector<double> nominal{100, 100, -500, 3, 0.95}, joints(nominal);  // A stands at 1.25
  const auto flags = [&] {
    return abbe_runtime_correct(runtime.get(), nullptr, nominal.data(), nullptr, 1, joints.data());
  };
  EXPECT_EQ(flags() & (ABBE_OUTSIDE_TRAVEL | ABBE_OUTSIDE_MAP), 0);
  nominal[4] = 1.02;
  EXPECT_EQ(flags() & (ABBE_OUTSIDE_TRAVEL | ABBE_OUTSIDE_MAP), ABBE_OUTSIDE_TRAVEL);
  nominal[4] = 1.2;  // 1.5: beyond 1 + 0.1 * 200 deg
  EXPECT_EQ(flags() & (ABBE_OUTSIDE_TRAVEL | ABBE_OUTSIDE_MAP), ABBE_OUTSIDE_TRAVEL | ABBE_OUTSIDE_MAP);
}

TEST(RuntimeCouplings, WithoutCouplingsTheFileIsOfTheFormatBefore) {
  const Machine machine = test::gantry_fork_head();
  EXPECT_EQ(test::quickly_frozen(machine, test::tens_of_micrometres(machine, 3)).format, 2);
}

TEST(RuntimeCouplings, DamagedCouplingsAreRefused) {
  const Machine machine = test::coupled_fork_head();
  const FrozenCompensation frozen = test::quickly_frozen(machine, test::tens_of_micrometres(machine, 3));
  EXPECT_EQ(frozen.format, 4);
  const std::size_t at = frozen::kHeaderBytes + 8 * (frozen::kMachineValues + 5 * frozen::kAxisValues);
  const auto load_with = [&](std::size_t place, double value) {
    std::vector<unsigned char> bytes = frozen.bytes;
    std::memcpy(&bytes[at + 8 * place], &value, sizeof value);
    const std::uint64_t sum = frozen::checksum(bytes.data(), bytes.size());
    std::memcpy(&bytes[frozen::kChecksumAt], &sum, sizeof sum);
    abbe_runtime* loaded = nullptr;
    char text[256];
    const int result = abbe_runtime_load(bytes.data(), bytes.size(), text, sizeof text, &loaded);
    abbe_runtime_free(loaded);
    return result == ABBE_OK ? std::string("loaded") : std::string(text);
  };
  double count = 0;
  std::memcpy(&count, &frozen.bytes[at], sizeof count);
  ASSERT_EQ(count, 2);
  EXPECT_EQ(load_with(0, 2), "loaded");
  EXPECT_THAT(load_with(0, 33), HasSubstr("couplings of axes"));
  EXPECT_THAT(load_with(1, 5), HasSubstr("couplings of axes"));             // no such axis
  EXPECT_THAT(load_with(3, std::nan("")), HasSubstr("couplings of axes"));  // no ratio
  EXPECT_THAT(load_with(2, 1e9), HasSubstr("couplings of axes"));           // no such axis
  double axis = 0;
  std::memcpy(&axis, &frozen.bytes[at + 8], sizeof axis);
  EXPECT_THAT(load_with(2, axis), HasSubstr("couplings of axes"));  // to itself
}

TEST(RuntimeCouplings, WhatTheCallsCannotSolveIsRefused) {
  const auto problem = [](const std::vector<AxisCoupling>& couplings) {
    Machine machine = test::coupled_fork_head();
    machine.couplings = couplings;
    FreezeOptions options;
    options.tool = machine.tool_offset;
    options.poses = 10;
    return freeze(machine, test::tens_of_micrometres(machine, 3), options).problem;
  };
  // X 0, Y 1, Z 2, C 3, A 4.
  EXPECT_EQ(problem({{4, 3, 0.1}}), "");
  EXPECT_THAT(problem({{4, 2, 1e-4}}), HasSubstr("A is coupled to Z, which corrects the point"));
}

}  // namespace
}  // namespace abbe
