// What a controller relies on: statuses, bounds, continuity, no allocation.
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/runtime/allocations_for_test.h"
#include "abbe/runtime/frozen_for_test.h"

namespace abbe {
namespace {

static_assert(noexcept(abbe_runtime_inverse(nullptr, nullptr, nullptr, nullptr, nullptr, 1, nullptr)));
static_assert(noexcept(abbe_runtime_load(nullptr, 0, nullptr, 0, nullptr)));

/// Every kind of functions, on one machine.
ErrorSet every_basis(const Machine& machine) {
  ErrorSet errors;
  std::mt19937_64 generator(31);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto add = [&](const char* axis_name, Component component, const Basis& basis) {
    const std::size_t axis = machine.find_axis(axis_name);
    std::vector<double> coefficients(basis.size());
    for (double& value : coefficients) value = uniform(generator) * (is_rotation(component) ? 3e-5 : 0.02);
    errors.motions.push_back({axis, component, basis, coefficients, {}});
  };
  const double turn = 2 * std::numbers::pi;
  add("X", Component::X, {.kind = BasisKind::bspline, .order = 7, .from = -300, .to = 300});
  add("X", Component::Y, {.kind = BasisKind::monomial, .order = 5, .from = -300, .to = 300});
  add("X", Component::B, {.kind = BasisKind::chebyshev, .order = 6, .from = -300, .to = 300});
  add("X", Component::X, {.kind = BasisKind::fourier, .order = 2, .from = -300, .to = 300, .period = 37});
  add("Y", Component::Y,
      {.kind = BasisKind::table_linear, .from = -255, .to = 255, .nodes = {-255, -100, 0, 30, 200, 255}});
  add("Y", Component::Z,
      {.kind = BasisKind::table_monotone, .from = -255, .to = 255, .nodes = {-255, -120, 10, 90, 255}});
  add("Z", Component::X, {.kind = BasisKind::legendre, .order = 9, .from = -510, .to = 0});
  add("Z", Component::A, {.kind = BasisKind::legendre, .order = 3, .from = -510, .to = 0});
  add("C", Component::X,
      {.kind = BasisKind::bspline, .order = 9, .from = 0, .to = turn, .period = turn, .periodic = true});
  add("C", Component::C, {.kind = BasisKind::fourier, .order = 5, .from = 0, .to = turn, .period = turn});
  add("C", Component::Y,
      {.kind = BasisKind::table_linear, .from = 0, .to = 5, .period = turn, .periodic = true, .nodes = {0, 1, 2, 5}});
  add("A", Component::B,
      {.kind = BasisKind::fourier, .order = 3, .from = -120 * kDegree, .to = 30 * kDegree, .period = turn});
  return errors;
}

TEST(RuntimeUse, EveryKindOfFunctionsGivesTheErrorsOfTheFullModel) {
  const Machine machine = test::trunnion_mill();
  for (const ErrorOrder order : {ErrorOrder::iso, ErrorOrder::after_motion, ErrorOrder::before_motion}) {
    ErrorSet errors = every_basis(machine);
    errors.composition.order = order;
    const FrozenCompensation frozen = test::quickly_frozen(machine, errors);
    EXPECT_LT(frozen.accuracy, 2e-12);
    EXPECT_LT(frozen.accuracy_turn, 1e-14);
    const test::RuntimePointer runtime = test::loaded(frozen.bytes);
    std::mt19937_64 generator(37);
    for (int k = 0; k < 300; ++k) {
      const std::vector<double> nominal = test::inner_commands(machine, generator);
      std::vector<double> joints(nominal), back(nominal);
      ASSERT_GE(abbe_runtime_correct(runtime.get(), nullptr, nominal.data(), nullptr, 1, joints.data()), 0);
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal);
      EXPECT_LE((actual_workpiece_from_tool(machine, errors, joints).translation - wanted.translation).norm(), 2e-12);
      ASSERT_GE(abbe_runtime_uncorrect(runtime.get(), nullptr, joints.data(), nullptr, 1, back.data()), 0);
      for (std::size_t i = 0; i < nominal.size(); ++i) EXPECT_NEAR(back[i], nominal[i], 1e-11);
    }
  }
}

TEST(RuntimeUse, TheToolIsAnArgument) {
  Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::tens_of_micrometres(machine, 5);
  const test::RuntimePointer runtime = test::runtime_of(machine, errors);
  std::mt19937_64 generator(41);
  for (const Eigen::Vector3d& tool : {Eigen::Vector3d(0, 0, -60), Eigen::Vector3d(1, -2, -290)}) {
    machine.tool_offset = tool;
    for (int k = 0; k < 50; ++k) {
      const std::vector<double> nominal = test::inner_commands(machine, generator);
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal);
      std::vector<double> joints(nominal);
      const int result = abbe_runtime_inverse(runtime.get(), nullptr, wanted.translation.data(), nominal.data(),
                                              tool.data(), 1, joints.data());
      ASSERT_GE(result, 0);
      EXPECT_EQ(result & ABBE_OUTSIDE_TOOL, 0);
      EXPECT_LE((actual_workpiece_from_tool(machine, errors, joints).translation - wanted.translation).norm(), 2e-12);
    }
  }
  const double too_long[3] = {0, 0, -301};
  std::vector<double> pose(5, -1.0);
  const int result = abbe_runtime_correct(runtime.get(), nullptr, pose.data(), too_long, 1, pose.data());
  EXPECT_EQ(result & ABBE_OUTSIDE_TOOL, ABBE_OUTSIDE_TOOL);
  // A length offset of 100 along Z: the functional point lies 100 below the gauge point.
  const double offset[3] = {0, 0, 100};
  double tool[3];
  abbe_runtime_tool_of_offset(runtime.get(), offset, tool);
  EXPECT_EQ(tool[2], -100);
}

TEST(RuntimeUse, EveryStatusIsGivenWhereItBelongs) {
  const Machine machine = test::trunnion_mill();
  const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 5));
  const std::size_t a = machine.find_axis("A"), x = machine.find_axis("X");
  std::vector<double> pose(5, 0.0), joints(5);
  pose[machine.find_axis("Z")] = -100;
  pose[a] = -0.7;
  const auto correct = [&] {
    return abbe_runtime_correct(runtime.get(), nullptr, pose.data(), nullptr, 1, joints.data());
  };
  EXPECT_EQ(correct(), ABBE_OK);
  pose[a] = 1e-5;
  EXPECT_EQ(correct(), ABBE_TURN_LIMITED);
  EXPECT_LE(std::hypot(joints[a] - pose[a], joints[0] - pose[0]), 0.0100001);
  pose[a] = -0.7;
  pose[x] = 299.9999;
  pose[machine.find_axis("Y")] = 254.9999;
  EXPECT_EQ(correct() & ABBE_RESULT_MASK, ABBE_OK);
  pose[x] = 310;
  EXPECT_EQ(correct(), ABBE_OUTSIDE_MAP | ABBE_OUTSIDE_TRAVEL);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e300}) {
    pose[x] = bad;
    joints.assign(5, 7.0);
    EXPECT_EQ(correct(), ABBE_NOT_FINITE);
    EXPECT_EQ(joints, std::vector<double>(5, 7.0));
    pose[x] = 0;
    EXPECT_EQ(abbe_runtime_correct(runtime.get(), nullptr, pose.data(), nullptr, bad, joints.data()), ABBE_NOT_FINITE);
  }
  EXPECT_EQ(abbe_runtime_correct(nullptr, nullptr, pose.data(), nullptr, 1, joints.data()), ABBE_NULL);
  EXPECT_EQ(abbe_runtime_forward(runtime.get(), nullptr, pose.data(), nullptr, 1, nullptr, joints.data()), ABBE_NULL);
  EXPECT_EQ(abbe_runtime_inverse(runtime.get(), nullptr, pose.data(), nullptr, nullptr, 1, joints.data()), ABBE_NULL);

  // A lathe has no axis for every direction of its error.
  const Machine lathe = test::lathe();
  const test::RuntimePointer of_lathe = test::runtime_of(lathe, test::tens_of_micrometres(lathe, 5));
  std::vector<double> turning(3, 50.0);
  EXPECT_EQ(abbe_runtime_correct(of_lathe.get(), nullptr, turning.data(), nullptr, 1, joints.data()) & ABBE_RESULT_MASK,
            ABBE_POSITION_LEFT);
  const Machine three = test::three_axis_mill();
  const test::RuntimePointer of_three = test::runtime_of(three, test::tens_of_micrometres(three, 5));
  std::vector<double> middle{300, 200, -200};
  EXPECT_EQ(abbe_runtime_correct(of_three.get(), nullptr, middle.data(), nullptr, 1, joints.data()), ABBE_OK);

  // The head of Wang's grinder at 90 degrees brings Y along Z: no point beside that plane can be had.
  const Machine grinder = test::wang_grinder();
  const test::RuntimePointer of_grinder = test::runtime_of(grinder, {});
  std::vector<double> words(6, 0.0), out(6);
  words[grinder.find_axis("A")] = std::numbers::pi / 2;
  const double point[3] = {1, 2, 3};
  EXPECT_EQ(abbe_runtime_nominal_inverse(of_grinder.get(), point, words.data(), nullptr, out.data()), ABBE_SINGULAR);
  for (int result = -20; result < 0x800; ++result) EXPECT_GT(std::string(abbe_runtime_text(result)).size(), 1U);
}

TEST(RuntimeUse, ATurnedTableThatOnlyTiltsLeavesOrientation) {
  const Machine machine = test::single_axis("w X' Y' b Z B t");
  const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 5));
  std::vector<double> pose{10, 20, 30, 0.4}, joints(4), back(4);
  EXPECT_EQ(abbe_runtime_correct(runtime.get(), nullptr, pose.data(), nullptr, 1, joints.data()),
            ABBE_ORIENTATION_LEFT);
  EXPECT_EQ(abbe_runtime_uncorrect(runtime.get(), nullptr, joints.data(), nullptr, 1, back.data()),
            ABBE_ORIENTATION_LEFT);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(back[i], pose[i], 1e-12);
}

TEST(RuntimeUse, EnableBringsTheCorrectionInWithoutAJump) {
  const Machine machine = test::trunnion_mill();
  const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 5));
  std::mt19937_64 generator(43);
  for (int k = 0; k < 20; ++k) {
    const std::vector<double> pose = test::inner_commands(machine, generator);
    std::vector<double> before(pose), joints(pose);
    double travelled = 0;
    for (int step = 0; step <= 1000; ++step) {
      ASSERT_GE(abbe_runtime_correct(runtime.get(), nullptr, pose.data(), nullptr, step / 1000.0, joints.data()), 0);
      if (step == 0) {
        EXPECT_EQ(joints, pose);
      }
      for (std::size_t i = 2; i < 5; ++i) {
        EXPECT_LE(std::abs(joints[i] - before[i]), 0.01) << step;
        travelled = std::max(travelled, std::abs(joints[i] - pose[i]));
      }
      before = joints;
    }
    EXPECT_GT(travelled, 0.005);
  }
}

TEST(RuntimeUse, BeyondTheMapErrorsStayAsTheyAreAndNothingJumps) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors = test::tens_of_micrometres(machine, 5);
  for (ErrorMotion& motion : errors.motions) {
    if (machine.axes[motion.axis].name == "X") motion.basis.from = -100, motion.basis.to = 100;
  }
  const test::RuntimePointer runtime = test::runtime_of(machine, errors);
  const std::size_t x = machine.find_axis("X");
  std::vector<double> pose{0.3, -0.5, 10, 0, -50}, joints(5), before;
  bool flagged = false;
  abbe_runtime_state state;
  abbe_runtime_start(&state);
  for (int k = 0; k <= 4000; ++k) {
    pose[x] = 90 + 0.005 * k;
    const int result = abbe_runtime_correct(runtime.get(), &state, pose.data(), nullptr, 1, joints.data());
    ASSERT_GE(result, 0);
    EXPECT_EQ((result & ABBE_OUTSIDE_MAP) != 0, pose[x] > 100 + 2e-7) << pose[x];
    flagged = flagged || (result & ABBE_OUTSIDE_MAP) != 0;
    // Steps of 5 um: the correction changes by less than a hundredth of that, at the edge too.
    for (std::size_t i = 2; i < 5 && !before.empty(); ++i) {
      EXPECT_NEAR(joints[i] - before[i], i == x ? 0.005 : 0, 5e-5) << pose[x];
    }
    before = joints;
  }
  EXPECT_TRUE(flagged);
  // Far beyond, errors are those of the edge.
  std::vector<double> edge = pose;
  edge[x] = 100.2;
  std::vector<double> at_edge(5), beyond(5);
  pose[x] = 200;
  abbe_runtime_correct(runtime.get(), nullptr, edge.data(), nullptr, 1, at_edge.data());
  abbe_runtime_correct(runtime.get(), nullptr, pose.data(), nullptr, 1, beyond.data());
  EXPECT_NEAR(beyond[x] - pose[x], at_edge[x] - edge[x], 0.02);
}

TEST(RuntimeUse, IterationsAreFewEvenAtSingularPoses) {
  const Machine machine = test::trunnion_mill();
  const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 5));
  const std::size_t a = machine.find_axis("A");
  std::mt19937_64 generator(47);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int worst = 0, worst_back = 0;
  for (int k = 0; k < 20000; ++k) {
    std::vector<double> pose = test::inner_commands(machine, generator), joints(5), back(5);
    if (k % 2 == 0) pose[a] = std::pow(10.0, -6 + 4 * std::abs(uniform(generator))) * (k % 4 == 0 ? 1 : -1);
    abbe_runtime_state state;
    abbe_runtime_start(&state);
    const int result = abbe_runtime_correct(runtime.get(), &state, pose.data(), nullptr, 1, joints.data());
    ASSERT_GE(result, 0) << k;
    worst = std::max(worst, state.iterations);
    abbe_runtime_start(&state);
    const int back_result = abbe_runtime_uncorrect(runtime.get(), &state, joints.data(), nullptr, 1, back.data());
    ASSERT_GE(back_result, 0) << k;
    worst_back = std::max(worst_back, state.iterations);
    for (std::size_t i = 0; i < 5; ++i) ASSERT_NEAR(back[i], pose[i], 1e-9) << k << " " << pose[a];
  }
  RecordProperty("worst_iterations", worst);
  RecordProperty("worst_iterations_back", worst_back);
  EXPECT_LE(worst, 16);
  EXPECT_LE(worst_back, 16);
}

TEST(RuntimeUse, PathsLeaveSingularPosesWhereThereAreNoErrors) {
  // Location errors do nothing where all axes are at zero, and there A is parallel to the tool: the error of direction
  // is far smaller than what the errors change of its derivative.
  const Machine machine = test::trunnion_mill();
  ErrorSet errors;
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C");
  errors.locations = {{c, Component::A, 45e-6},
                      {c, Component::B, -30e-6},
                      {a, Component::B, 38e-6},
                      {a, Component::C, -52e-6},
                      {c, Component::X, 0.014}};
  const test::RuntimePointer runtime = test::runtime_of(machine, errors);
  for (const double c_by_a : {-1.5, 0.0, 4.0}) {
    abbe_runtime_state there, back_there;
    abbe_runtime_start(&there);
    abbe_runtime_start(&back_there);
    double last_turn = 0;
    for (double tilt = 1e-9; tilt < 0.05; tilt *= 1.01) {
      std::vector<double> pose(5, 0.0), joints(5), back(5);
      pose[a] = -tilt;
      pose[c] = c_by_a * tilt;
      const int result = abbe_runtime_correct(runtime.get(), &there, pose.data(), nullptr, 1, joints.data());
      ASSERT_GE(result, 0) << tilt << " " << c_by_a;
      EXPECT_LE(there.iterations, 20) << tilt << " " << c_by_a;
      ASSERT_GE(abbe_runtime_uncorrect(runtime.get(), &back_there, joints.data(), nullptr, 1, back.data()), 0);
      for (std::size_t i = 0; i < 5; ++i) ASSERT_NEAR(back[i], pose[i], 1e-9) << tilt << " " << c_by_a;
      const double turn = joints[c] - pose[c];
      EXPECT_LT(std::abs(turn - last_turn), 1e-3) << tilt << " " << c_by_a;
      last_turn = turn;
    }
  }
}

TEST(RuntimeUse, CallsDoNotAllocate) {
  const Machine machine = test::trunnion_mill();
  const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 5));
  const Machine lathe = test::lathe();
  const test::RuntimePointer of_lathe = test::runtime_of(lathe, test::tens_of_micrometres(lathe, 5));
  abbe_runtime_state state;
  abbe_runtime_start(&state);
  std::array<double, 5> joints{0.1, 0.2, 3, 4, -50}, words{}, back{};
  std::array<double, 3> point{}, turned{1, 100, 20}, turned_joints{};
  const long before = test::allocations();
  for (int k = 0; k < 100; ++k) {
    joints[1] = 0.01 * k - 0.5;
    abbe_runtime_forward(runtime.get(), &state, joints.data(), nullptr, 1, point.data(), words.data());
    abbe_runtime_inverse(runtime.get(), &state, point.data(), words.data(), nullptr, 0.5, back.data());
    abbe_runtime_correct(of_lathe.get(), &state, turned.data(), nullptr, 1, turned_joints.data());
    abbe_runtime_uncorrect(of_lathe.get(), nullptr, turned_joints.data(), nullptr, 1, turned.data());
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_GT(before, 100);  // the counter counts
}

}  // namespace
}  // namespace abbe
