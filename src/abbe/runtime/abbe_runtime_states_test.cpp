#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/runtime/allocations_for_test.h"
#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_states_for_test.h"

namespace abbe {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Values of ambient, column and payload, as the C interface has them and as the library has them.
struct SomeStates {
  std::array<double, 2> channels;
  std::array<double, 1> lags;
  std::vector<double> given;
};

SomeStates some_states(const Machine& machine, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(0, 1);
  SomeStates states{{15 + 15 * uniform(generator), 2 * uniform(generator)}, {15 + 15 * uniform(generator)}, {}};
  states.given.assign(machine.states.size(), kNone);
  states.given[0] = states.channels[0];
  states.given[1] = states.lags[0];
  states.given[2] = states.channels[1];
  return states;
}

/// Commands that the library finds for many poses at once.
struct LibraryBatch {
  std::vector<std::vector<double>> axis, state;
  std::vector<CorrectionStatus> status;
};

LibraryBatch corrected_by_library(const Machine& machine, const ErrorSet& errors,
                                  const std::vector<std::vector<double>>& nominal,
                                  const std::vector<SomeStates>& states) {
  LibraryBatch batch;
  batch.axis.resize(machine.axes.size());
  batch.state.resize(machine.states.size());
  batch.status.resize(nominal.size());
  for (std::size_t k = 0; k < nominal.size(); ++k) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) batch.axis[i].push_back(nominal[k][i]);
    for (std::size_t j = 0; j < machine.states.size(); ++j) batch.state[j].push_back(states[k].given[j]);
  }
  CorrectionOptions options;
  options.position_tolerance = 5e-11;
  options.orientation_tolerance = 3e-13;
  const CompensatedInverse inverse(machine, errors, options);
  EXPECT_EQ(inverse.problem(), "");
  std::vector<const double*> in, given;
  std::vector<double*> out;
  for (std::vector<double>& values : batch.axis) {
    in.push_back(values.data());
    out.push_back(values.data());
  }
  for (std::vector<double>& values : batch.state) given.push_back(values.data());
  inverse.correct({in, nominal.size(), given}, {out, batch.status.data()});
  return batch;
}

TEST(RuntimeStates, CorrectAsTheLibraryDoesAtEveryState) {
  const Machine machine = test::mill_with_states();
  const ErrorSet errors = test::errors_with_states(machine);
  const FrozenCompensation frozen = test::frozen_with_states(machine, errors);
  EXPECT_EQ(frozen.format, 3);
  EXPECT_LT(frozen.accuracy, 2e-11);
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  const test::StatesPointer states = test::states_of(runtime.get());
  const abbe_runtime* const present = abbe_runtime_at_states(states.get());
  std::mt19937_64 generator(71);
  std::vector<std::vector<double>> nominal;
  std::vector<SomeStates> given;
  for (int k = 0; k < 500; ++k) {
    nominal.push_back(test::inner_commands(machine, generator));
    given.push_back(some_states(machine, generator));
  }
  const LibraryBatch library = corrected_by_library(machine, errors, nominal, given);
  int compared = 0;
  double moved_by_states = 0;
  for (std::size_t k = 0; k < nominal.size(); ++k) {
    std::vector<double> joints(5), back(5);
    ASSERT_EQ(abbe_runtime_states_set(states.get(), given[k].channels.data(), given[k].lags.data()), ABBE_OK);
    const int result = abbe_runtime_correct(present, nullptr, nominal[k].data(), nullptr, 1, joints.data());
    ASSERT_GE(result, 0);
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal[k]);
    const RigidTransform there = actual_workpiece_from_tool(machine, errors, joints, given[k].given);
    EXPECT_LE((there.translation - wanted.translation).norm(), 5e-12) << k;
    moved_by_states = std::max(
        moved_by_states,
        (actual_workpiece_from_tool(machine, errors, joints, given[0].given).translation - wanted.translation).norm());
    ASSERT_GE(abbe_runtime_uncorrect(present, nullptr, joints.data(), nullptr, 1, back.data()), 0);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(back[i], nominal[k][i], 1e-10);
    if (library.status[k] != CorrectionStatus::reached || (result & ABBE_RESULT_MASK) != ABBE_OK) continue;
    ++compared;
    for (std::size_t i = 0; i < 5; ++i) {
      const bool rotary = machine.axes[i].kind == AxisKind::rotary;
      EXPECT_NEAR(joints[i], library.axis[i][k], rotary ? 1e-10 : 2e-9) << k << " " << machine.axes[i].name;
    }
  }
  EXPECT_GT(compared, 400);
  EXPECT_GT(moved_by_states, 0.02) << "states that do nothing prove nothing";
}

TEST(RuntimeStates, TheResultDependsOnTheStatesAndNotOnTheWayThere) {
  const Machine machine = test::mill_with_states();
  const FrozenCompensation frozen = test::frozen_with_states(machine, test::errors_with_states(machine));
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  const test::StatesPointer one = test::states_of(runtime.get()), other = test::states_of(runtime.get());
  std::mt19937_64 generator(5);
  const std::vector<double> nominal = test::inner_commands(machine, generator);
  for (int k = 0; k < 50; ++k) {
    const SomeStates there = some_states(machine, generator), between = some_states(machine, generator);
    std::array<double, 5> a{}, b{};
    abbe_runtime_states_set(one.get(), between.channels.data(), between.lags.data());
    abbe_runtime_states_set(one.get(), there.channels.data(), there.lags.data());
    abbe_runtime_states_set(other.get(), there.channels.data(), there.lags.data());
    abbe_runtime_correct(abbe_runtime_at_states(one.get()), nullptr, nominal.data(), nullptr, 1, a.data());
    abbe_runtime_correct(abbe_runtime_at_states(other.get()), nullptr, nominal.data(), nullptr, 1, b.data());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof a), 0);
  }
}

TEST(RuntimeStates, WithoutThemNothingIsCompensatedAndNothingIsTakenForZero) {
  const test::RuntimePointer runtime = test::loaded(test::frozen_warm_mill().bytes);
  const std::array<double, 3> nominal{100, 100, -100};
  std::array<double, 3> joints{7, 7, 7}, point{};
  EXPECT_EQ(abbe_runtime_correct(runtime.get(), nullptr, nominal.data(), nullptr, 1, joints.data()),
            ABBE_STATES_NOT_GIVEN);
  EXPECT_EQ(abbe_runtime_uncorrect(runtime.get(), nullptr, nominal.data(), nullptr, 0.5, joints.data()),
            ABBE_STATES_NOT_GIVEN);
  EXPECT_EQ(abbe_runtime_inverse(runtime.get(), nullptr, nominal.data(), nominal.data(), nullptr, 1, joints.data()),
            ABBE_STATES_NOT_GIVEN);
  EXPECT_EQ(joints, (std::array<double, 3>{7, 7, 7}));
  EXPECT_GE(abbe_runtime_nominal_forward(runtime.get(), nominal.data(), nullptr, point.data(), joints.data()), 0);
  EXPECT_NE(std::string(abbe_runtime_text(ABBE_STATES_NOT_GIVEN)), "unknown");
}

TEST(RuntimeStates, WhatIsComputedFromCommandsNeedsNoChannels) {
  Machine machine = test::mill_with_states();
  ErrorSet errors = test::errors_with_states(machine);
  std::erase_if(errors.motions, [&](const ErrorMotion& motion) {
    return motion.state != kNoState && machine.states[motion.state].name != "ram" &&
           machine.states[motion.state].name != "torque";
  });
  std::erase_if(errors.locations, [&](const LocationError& location) {
    return location.state != kNoState && machine.states[location.state].name != "torque";
  });
  const FrozenCompensation frozen = test::frozen_with_states(machine, errors);
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  EXPECT_EQ(abbe_runtime_channels(runtime.get()), 0);
  std::mt19937_64 generator(3);
  const std::vector<double> given(machine.states.size(), kNone);
  double moved = 0;
  for (int k = 0; k < 100; ++k) {
    const std::vector<double> nominal = test::inner_commands(machine, generator);
    std::vector<double> joints(5);
    ASSERT_GE(abbe_runtime_correct(runtime.get(), nullptr, nominal.data(), nullptr, 1, joints.data()), 0);
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal);
    EXPECT_LE((actual_workpiece_from_tool(machine, errors, joints, given).translation - wanted.translation).norm(),
              5e-12);
    ErrorSet constant = errors;
    std::erase_if(constant.motions, [](const ErrorMotion& motion) { return motion.state != kNoState; });
    std::erase_if(constant.locations, [](const LocationError& location) { return location.state != kNoState; });
    moved = std::max(moved,
                     (actual_workpiece_from_tool(machine, constant, joints).translation - wanted.translation).norm());
  }
  EXPECT_GT(moved, 0.005);
}

TEST(RuntimeStates, FilesWithoutThemStayAsTheyWere) {
  const Machine machine = test::trunnion_mill();
  const FrozenCompensation plain = test::quickly_frozen(machine, test::tens_of_micrometres(machine, 5));
  EXPECT_EQ(plain.format, 2);
  EXPECT_EQ(plain.bytes[frozen::kFormatAt], 2);
  const FrozenCompensation unused = freeze(test::mill_with_states(), test::tens_of_micrometres(machine, 5),
                                           test::options_with_states(test::mill_with_states()));
  EXPECT_EQ(unused.format, 2) << "states that no error has are no matter";
  const test::RuntimePointer runtime = test::loaded(plain.bytes);
  EXPECT_EQ(abbe_runtime_channels(runtime.get()), 0);
  EXPECT_EQ(abbe_runtime_lags(runtime.get()), 0);
  const test::StatesPointer states = test::states_of(runtime.get());
  EXPECT_EQ(abbe_runtime_states_advance(states.get(), nullptr, 1), ABBE_NULL);
  const double none = 0;
  EXPECT_EQ(abbe_runtime_states_advance(states.get(), &none, 1), ABBE_OK);
  std::array<double, 5> pose{0.3, -0.5, 10, 20, -50}, one{}, other{};
  abbe_runtime_correct(runtime.get(), nullptr, pose.data(), nullptr, 1, one.data());
  abbe_runtime_correct(abbe_runtime_at_states(states.get()), nullptr, pose.data(), nullptr, 1, other.data());
  EXPECT_EQ(one, other);
}

TEST(RuntimeStates, TheFileNamesItsChannels) {
  const Machine machine = test::mill_with_states();
  const FrozenCompensation frozen = test::frozen_with_states(machine, test::errors_with_states(machine));
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  ASSERT_EQ(abbe_runtime_channels(runtime.get()), 2);
  ASSERT_EQ(abbe_runtime_lags(runtime.get()), 1);
  abbe_runtime_channel channel;
  ASSERT_EQ(abbe_runtime_describe_channel(runtime.get(), 0, &channel), ABBE_OK);
  EXPECT_STREQ(channel.name, "ambient");
  EXPECT_STREQ(channel.unit, "degC");
  EXPECT_EQ(channel.reference, 20);
  EXPECT_EQ(channel.range_min, 15);
  EXPECT_EQ(channel.range_max, 30);
  ASSERT_EQ(abbe_runtime_describe_channel(runtime.get(), 1, &channel), ABBE_OK);
  EXPECT_STREQ(channel.name, "payload");
  EXPECT_STREQ(channel.unit, "kg");
  abbe_runtime_lag lag;
  ASSERT_EQ(abbe_runtime_describe_lag(runtime.get(), 0, &lag), ABBE_OK);
  EXPECT_STREQ(lag.name, "column");
  EXPECT_EQ(lag.channel, 0);
  EXPECT_EQ(lag.time_constant_s, 1800);
  EXPECT_EQ(abbe_runtime_describe_channel(runtime.get(), 2, &channel), ABBE_NULL);
  EXPECT_EQ(abbe_runtime_describe_lag(runtime.get(), -1, &lag), ABBE_NULL);
  ASSERT_EQ(frozen.channels.size(), 2U);
  EXPECT_GT(frozen.channels[0].largest, 0.02);
}

TEST(RuntimeStates, WhatCannotBeFrozenIsSaid) {
  Machine machine = test::mill_with_states();
  machine.states.push_back({.name = "side", .kind = StateKind::approach, .axis = 2});
  ErrorSet errors;
  const Basis line{.kind = BasisKind::legendre, .order = 0, .from = -300, .to = 300};
  errors.motions.push_back({machine.find_axis("X"), Component::X, line, {1e-3}, {}, machine.states.size() - 1});
  EXPECT_EQ(freeze(machine, errors, {}).problem,
            "EXX*side depends on the side from which an axis came: a frozen compensation knows positions only");
  errors.motions[0].state = find_state(machine, "payload");
  EXPECT_EQ(freeze(machine, errors, {}).problem,
            "the range of the state payload is not given: --state-range payload_kg=FROM:TO");
  errors.motions[0].state = find_state(machine, "ambient");
  FreezeOptions options = test::options_with_states(machine);
  options.state_ranges[0] = {};
  const FrozenCompensation usual = freeze(machine, errors, options);
  EXPECT_EQ(usual.problem, "");
  EXPECT_EQ(usual.channels.at(0).range.from, 15);
  EXPECT_EQ(usual.channels.at(0).range.to, 30);
  options.state_ranges[0] = {30, 15};
  EXPECT_EQ(freeze(machine, errors, options).problem, "the range of the state ambient is empty or beyond 1e6");
  machine.states[0].name = std::string(33, 'a');
  options.state_ranges[0] = {15, 30};
  EXPECT_NE(freeze(machine, errors, options).problem.find("longer than 32 letters"), std::string::npos);
}

TEST(RuntimeStates, DamagedFilesAreRefused) {
  const Machine machine = test::mill_with_states();
  const std::vector<unsigned char> sound = test::frozen_with_states(machine, test::errors_with_states(machine)).bytes;
  const auto load = [](const std::vector<unsigned char>& bytes) {
    abbe_runtime* runtime = nullptr;
    const int result = abbe_runtime_load(bytes.data(), bytes.size(), nullptr, 0, &runtime);
    const test::RuntimePointer owned(runtime);
    if (runtime == nullptr) return result;
    // What is taken can be used.
    const test::StatesPointer states = test::states_of(runtime);
    std::array<double, ABBE_RUNTIME_STATES> values{};
    std::array<double, ABBE_RUNTIME_AXES> joints{};
    abbe_runtime_states_advance(states.get(), values.data(), 1);
    abbe_runtime_correct(abbe_runtime_at_states(states.get()), nullptr, joints.data(), nullptr, 1, joints.data());
    return result;
  };
  ASSERT_EQ(load(sound), ABBE_OK);
  std::vector<unsigned char> other = sound;
  other[frozen::kFormatAt] = 2;
  EXPECT_EQ(load(other), ABBE_FILE_CHECKSUM) << "a file of another version is not read as this one";
  // Every value in turn replaced, with a checksum that is right: refused, or of use.
  int refused = 0;
  const double wrong[] = {-1, 0.5, 17, 1e9, kNone};
  for (std::size_t place = frozen::kHeaderBytes; place < sound.size(); place += 8) {
    other = sound;
    std::memcpy(other.data() + place, &wrong[place / 8 % 5], 8);
    const std::uint64_t sum = frozen::checksum(other.data(), other.size());
    std::memcpy(other.data() + frozen::kChecksumAt, &sum, sizeof sum);
    if (load(other) != ABBE_OK) ++refused;
  }
  EXPECT_GT(refused, 100);
}

TEST(RuntimeStates, CallsDoNotAllocate) {
  const Machine machine = test::mill_with_states();
  const FrozenCompensation frozen = test::frozen_with_states(machine, test::errors_with_states(machine));
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  const test::StatesPointer states = test::states_of(runtime.get());
  std::array<double, 5> nominal{0.1, -0.2, 3, 4, -50}, joints{};
  std::array<double, 2> channels{20, 1}, used{};
  std::array<double, 1> lags{};
  std::array<int, 2> flags{};
  const long before = test::allocations();
  for (int k = 0; k < 100; ++k) {
    channels[0] = k % 10 == 0 ? kNone : 20 + 0.01 * k;
    abbe_runtime_states_advance(states.get(), channels.data(), 0.001);
    abbe_runtime_states_get(states.get(), used.data(), lags.data(), flags.data(), nullptr);
    abbe_runtime_correct(abbe_runtime_at_states(states.get()), nullptr, nominal.data(), nullptr, 1, joints.data());
  }
  EXPECT_EQ(test::allocations(), before);
}

TEST(RuntimeStates, TheUncertaintyIsTheLargestOfAllStates) {
  const Machine machine = test::warm_mill();
  const ErrorSet errors = test::warm_errors(machine);
  FreezeOptions options = test::options_with_states(machine);
  const auto count = static_cast<Eigen::Index>(errors.parameter_count());
  options.covariance = 1e-8 * Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (parameters_are_angles(machine, errors)[static_cast<std::size_t>(k)]) options.covariance(k, k) = 1e-14;
  }
  const FrozenCompensation frozen = freeze(machine, errors, options);
  ASSERT_EQ(frozen.problem, "");
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  const Axis& x = machine.axes[0];
  // At a node of the lattice, with the tool that is one.
  std::vector<double> corner{x.travel_min, machine.axes[1].travel_min, machine.axes[2].travel_min};
  const double none[3] = {0, 0, 0};
  double stated = 0, largest = 0;
  ASSERT_GE(abbe_runtime_uncertainty(runtime.get(), corner.data(), none, &stated), 0);
  Machine bare = machine;
  bare.tool_offset.setZero();
  for (const double ambient : {15.0, 20.0, 30.0}) {
    for (const double column : {15.0, 20.0, 30.0}) {
      Deviation deviation;
      Eigen::MatrixXd by;
      const std::array<double, 2> given{ambient, column};
      tool_deviation(bare, errors, corner, deviation, &by, nullptr, given);
      const Eigen::Matrix3d spread = by.topRows<3>() * options.covariance * by.topRows<3>().transpose();
      largest = std::max(largest, std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues()[2]));
    }
  }
  EXPECT_NEAR(stated, largest, 1e-9);
  EXPECT_GT(stated, 1e-4);
}

}  // namespace
}  // namespace abbe
