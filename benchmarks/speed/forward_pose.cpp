/// Speed of the compiled chain against the same model written with Eigen, in one run. Ratios are printed at the end;
/// the exit code is 1 if a target of docs/performance.md is missed.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <tuple>

#include "abbe/geometry/parallel_blocks.h"
#include "eigen_chain.h"
#include "fastest.h"
#include "grinding_poses.h"
#include "instruction_set.h"
#include "trunnion_kernel.h"

namespace abbe::benchmarks {
namespace {

constexpr std::size_t kPoses = 1 << 18;
/// 160 bytes each, so that those of a task stay in a second-level cache of 512 KiB.
constexpr std::size_t kPosesPerTask = 2048;

struct Setting {
  FiveAxisCase five_axis;
  ChainPlan plan{five_axis.machine, five_axis.errors, Body::tool, Body::workpiece};
  EigenChain baseline{five_axis.machine, five_axis.errors};
  TrunnionNumbers trunnion{five_axis};
  Commands commands{five_axis.machine, kPoses};
  Arrays start{3, kPoses}, seen{3, kPoses}, rotation{9, kPoses};
  Arrays states{1, kPoses};  ///< degC
  FiveAxisCase with_states = case_with_states();
  ChainPlan plan_with_states{with_states.machine, with_states.errors, Body::tool, Body::workpiece};

  /// Scales that grow with the temperature, and a cradle that gives way to the weight of its table.
  static FiveAxisCase case_with_states() {
    FiveAxisCase c;
    c.machine.states.push_back({.name = "ambient", .unit = "degC", .reference = 20});
    MachineState torque{.name = "torque", .kind = StateKind::gravity, .axis = 1};
    torque.loads = {{0, 40, {0, 10, -250}}, {1, 60, {0, 120, -200}}};
    c.machine.states.push_back(torque);
    for (std::size_t axis = 2; axis < 5; ++axis) {
      const Axis& of = c.machine.axes[axis];
      Basis line{.kind = BasisKind::legendre, .order = 1, .from = of.travel_min, .to = of.travel_max};
      c.errors.motions.push_back({axis, static_cast<Component>(axis - 2), line, {1e-4, 3e-3}, {}, 0});
    }
    Basis even{.kind = BasisKind::legendre, .order = 0, .from = -1.5, .to = 1.5};
    c.errors.motions.push_back({1, Component::A, even, {1e-6}, {}, 1});
    return c;
  }

  void transform_with_states(std::size_t first, std::size_t count) {
    std::array<const double*, 5> axis{};
    for (std::size_t i = 0; i < 5; ++i) axis[i] = commands.pointers[i] + first;
    const std::array<const double*, 2> state{states[0] + first, nullptr};
    RotationArrays arrays;
    for (int i = 0; i < 9; ++i) arrays.r[i] = rotation[static_cast<std::size_t>(i)] + first;
    plan_with_states.transform({axis, count, state}, {&start[0][first], &start[1][first], &start[2][first]},
                               {&seen[0][first], &seen[1][first], &seen[2][first]}, arrays);
  }

  Setting() {
    for (std::size_t k = 0; k < kPoses; ++k) states[0][k] = 20 + 1e-5 * static_cast<double>(k);
    std::fill_n(start[2], kPoses, five_axis.machine.tool_offset.z());
  }

  void transform(std::size_t first, std::size_t count, bool with_rotation) {
    std::array<const double*, 5> axis{};
    for (std::size_t i = 0; i < 5; ++i) axis[i] = commands.pointers[i] + first;
    RotationArrays arrays;
    for (int i = 0; with_rotation && i < 9; ++i) arrays.r[i] = rotation[static_cast<std::size_t>(i)] + first;
    plan.transform({axis, count}, {&start[0][first], &start[1][first], &start[2][first]},
                   {&seen[0][first], &seen[1][first], &seen[2][first]}, arrays);
  }

  void transform_by_hand(std::size_t first, std::size_t count) {
    std::array<const double*, 5> axis{};
    std::array<const double*, 3> from{};
    std::array<double*, 12> to{};
    for (std::size_t i = 0; i < 5; ++i) axis[i] = commands.pointers[i] + first;
    for (std::size_t i = 0; i < 3; ++i) from[i] = start[i] + first;
    for (std::size_t i = 0; i < 12; ++i) to[i] = (i < 3 ? seen[i] : rotation[i - 3]) + first;
    transform_trunnion(trunnion, axis.data(), from.data(), to.data(), count);
  }

  /// Largest difference of the present results to the baseline, mm and rad times 100 mm.
  double disagreement() {
    double largest = 0;
    for (std::size_t k = 0; k < kPoses; k += 17) {
      double q[5];
      for (std::size_t i = 0; i < 5; ++i) q[i] = commands.values[i][k];
      const Eigen::Matrix4d expected = baseline.workpiece_from_tool(q);
      const Eigen::Vector4d point = expected * Eigen::Vector4d(start[0][k], start[1][k], start[2][k], 1);
      for (int i = 0; i < 3; ++i) {
        largest = std::max(largest, std::abs(point[i] - seen[static_cast<std::size_t>(i)][k]));
        for (int j = 0; j < 3; ++j)
          largest =
              std::max(largest, 100 * std::abs(expected(i, j) - rotation[static_cast<std::size_t>(3 * i + j)][k]));
      }
    }
    return largest;
  }
};

Setting& setting() {
  static Setting instance;
  return instance;
}

void count_poses(benchmark::State& state, std::size_t poses) {
  state.SetItemsProcessed(static_cast<std::int64_t>(poses) * state.iterations());
}

void eigen_4x4_chain(benchmark::State& state) {
  Setting& s = setting();
  constexpr std::size_t kSome = 2048;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kSome; ++k) {
      double q[5];
      for (std::size_t i = 0; i < 5; ++i) q[i] = s.commands.values[i][k];
      const Eigen::Matrix4d pose = s.baseline.workpiece_from_tool(q);
      benchmark::DoNotOptimize(pose.data());
      benchmark::ClobberMemory();
    }
  }
  count_poses(state, kSome);
}

void full_pose_one_core(benchmark::State& state) {
  for (auto _ : state) setting().transform(0, kPosesPerTask, true);
  count_poses(state, kPosesPerTask);
}

void full_pose_with_states(benchmark::State& state) {
  for (auto _ : state) setting().transform_with_states(0, kPosesPerTask);
  count_poses(state, kPosesPerTask);
}

void by_hand_one_core(benchmark::State& state) {
  for (auto _ : state) setting().transform_by_hand(0, kPosesPerTask);
  count_poses(state, kPosesPerTask);
}

void point_only_one_core(benchmark::State& state) {
  for (auto _ : state) setting().transform(0, kPosesPerTask, false);
  count_poses(state, kPosesPerTask);
}

/// Every task passes its poses several times, so that the second level cache and not the memory feeds the cores.
void cached_poses(benchmark::State& state, int threads) {
  constexpr std::size_t kTasks = 16, kPasses = 16;
  for (auto _ : state) {
    for_each_block(kTasks, threads, [](std::size_t task) {
      for (std::size_t pass = 0; pass < kPasses; ++pass) {
        setting().transform(task * kPosesPerTask, kPosesPerTask, true);
      }
    });
  }
  count_poses(state, kTasks * kPasses * kPosesPerTask);
}
void cached_poses_one_core(benchmark::State& state) { cached_poses(state, 1); }
void cached_poses_two_cores(benchmark::State& state) { cached_poses(state, 2); }

/// 160 bytes per pose from and to memory.
void streamed_poses_two_cores(benchmark::State& state) {
  for (auto _ : state) {
    for_each_block(kPoses / kPosesPerTask, 2,
                   [](std::size_t block) { setting().transform(block * kPosesPerTask, kPosesPerTask, true); });
  }
  count_poses(state, kPoses);
}

void one_pose_per_call(benchmark::State& state) {
  std::size_t k = 0;
  for (auto _ : state) setting().transform(k++ % kPoses, 1, true);
  count_poses(state, 1);
}

/// Angles as printed by Wang (about a degree, beyond the short series) and in thousandths of that.
void all_grinding_poses(benchmark::State& state, double largest_angle) {
  const GrindingPoses poses(largest_angle);
  for (auto _ : state) benchmark::DoNotOptimize(poses.evaluate(2));
  count_poses(state, GrindingPoses::kPoses);
}
void grinder_12_6_degrees(benchmark::State& state) { all_grinding_poses(state, 0.02); }
void grinder_12_6_millidegrees(benchmark::State& state) { all_grinding_poses(state, 2e-5); }

/// Three rows (x, y, z of the seen point) by all parameters.
void jacobian_one_core(benchmark::State& state) {
  Setting& s = setting();
  constexpr std::size_t n = ChainPlan::kBlockSize;
  std::vector<std::size_t> parameters(s.five_axis.errors.parameter_count());
  std::iota(parameters.begin(), parameters.end(), std::size_t{0});
  const CoordinateRows coordinates;
  std::vector<double> jacobian(parameters.size() * 3 * n);
  s.transform(0, n, true);
  for (auto _ : state) {
    s.plan.differentiate({s.commands.pointers, n}, {}, {s.seen[0], s.seen[1], s.seen[2]}, coordinates.rows(),
                         parameters, jacobian.data(), 3 * n);
    benchmark::DoNotOptimize(jacobian.data());
    benchmark::ClobberMemory();
  }
  state.counters["parameters"] = static_cast<double>(parameters.size());
  count_poses(state, n);
}

}  // namespace

int run(int argc, char** argv) {
  take_avx2(argc, argv);
  initialize(argc, argv);
  for (const auto& [name, function, real_time] : {std::tuple{"eigen_4x4_chain", &eigen_4x4_chain, false},
                                                  {"full_pose_one_core", &full_pose_one_core, false},
                                                  {"full_pose_with_states", &full_pose_with_states, false},
                                                  {"by_hand_one_core", &by_hand_one_core, false},
                                                  {"point_only_one_core", &point_only_one_core, false},
                                                  {"cached_poses_one_core", &cached_poses_one_core, true},
                                                  {"cached_poses_two_cores", &cached_poses_two_cores, true},
                                                  {"streamed_poses_two_cores", &streamed_poses_two_cores, true},
                                                  {"one_pose_per_call", &one_pose_per_call, false},
                                                  {"jacobian_one_core", &jacobian_one_core, false},
                                                  {"grinder_12_6_degrees", &grinder_12_6_degrees, true},
                                                  {"grinder_12_6_millidegrees", &grinder_12_6_millidegrees, true}}) {
    auto* registered = benchmark::RegisterBenchmark(name, function);
    registered->Repetitions(9)->MinTime(0.1);
    if (real_time) registered->UseRealTime();
  }
  setting().transform_by_hand(0, kPoses);
  double disagreement = setting().disagreement();
  setting().transform(0, kPoses, true);
  disagreement = std::max(disagreement, setting().disagreement());
  FastestReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  std::printf("\nlargest difference to the baseline: %.2e mm\n", disagreement);
  const auto ns = [&](const char* name) { return 1e9 * reporter.fastest[name]; };
  for (const auto& [name, seconds] : reporter.fastest)
    std::printf("%-28s %9.2f ns per pose\n", name.c_str(), 1e9 * seconds);
  if (reporter.fastest.size() < 12) return 0;
  bool met = disagreement < 1e-9;
  met &= report("full pose, one core: poses per second of the baseline",
                ns("eigen_4x4_chain") / ns("full_pose_one_core"), 30);
  met &= report("point only, one core", ns("eigen_4x4_chain") / ns("point_only_one_core"), 30);
  std::printf("%-58s %7.2f\n", "generality: time against a kernel written for this machine",
              ns("full_pose_one_core") / ns("by_hand_one_core"));
  met &= report("poses per second with states, of those without",
                ns("full_pose_one_core") / ns("full_pose_with_states"), 1 / 1.5);
  met &= report("two cores against one", ns("cached_poses_one_core") / ns("cached_poses_two_cores"), 1.7);
  const double all = static_cast<double>(GrindingPoses::kPoses) * 1e-9;
  met &= report("all 12^6 poses of the grinder, two cores: per second",
                1 / (all * std::max(ns("grinder_12_6_degrees"), ns("grinder_12_6_millidegrees"))), 2);
  return met ? 0 : 1;
}

}  // namespace abbe::benchmarks

int main(int argc, char** argv) { return abbe::benchmarks::run(argc, argv); }
