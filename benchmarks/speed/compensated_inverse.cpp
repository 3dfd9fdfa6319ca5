#include "abbe/compensate/compensated_inverse.h"

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/parallel_blocks.h"
#include "eigen_chain.h"
#include "fastest.h"
#include "instruction_set.h"

namespace abbe::benchmarks {
namespace {

constexpr std::size_t kPoses = 1 << 15;
constexpr std::size_t kPiece = 4096;  // poses of one thread at a time

/// Poses of a five-axis mill away from the tilt at which its axes are parallel, and where the tool is wanted at them.
struct Setting {
  Setting() : inverse(five_axis.machine, five_axis.errors), baseline(five_axis.machine, five_axis.errors) {
    for (std::vector<double>& of_axis : corrected) of_axis.resize(kPoses);
    status.resize(kPoses);
  }
  void correct(std::size_t first, std::size_t count) {
    std::array<const double*, 5> in;
    std::array<double*, 5> out;
    for (std::size_t i = 0; i < 5; ++i) {
      in[i] = commands[i].data() + first;
      out[i] = corrected[i].data() + first;
    }
    inverse.correct({in, count}, {out, status.data() + first, nullptr, nullptr});
  }
  FiveAxisCase five_axis;
  CompensatedInverse inverse;
  EigenChain baseline;
  std::array<std::vector<double>, 5> commands = commands_to_correct(five_axis, kPoses), corrected;
  std::vector<CorrectionStatus> status;
};

Setting& setting() {
  static Setting the_setting;
  return the_setting;
}

/// The same as one writes it with Eigen: Newton with the derivative by differences of the chain with errors.
Eigen::Matrix<double, 5, 1> by_newton(const Setting& s, std::size_t pose) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  const Machine& machine = s.five_axis.machine;
  Vector5 q;
  std::vector<double> nominal(5);
  for (std::size_t i = 0; i < 5; ++i) q[static_cast<Eigen::Index>(i)] = nominal[i] = s.commands[i][pose];
  const RigidTransform goal = nominal_workpiece_from_tool(machine, nominal);
  const Eigen::Vector3d direction = goal.rotation * machine.tool_direction;
  const Eigen::Vector3d first = direction.unitOrthogonal(), second = direction.cross(first);
  const Eigen::Vector3d tool = machine.tool_offset + s.five_axis.errors.tool_offset_error;
  const auto missing = [&](const Vector5& at) {
    const Eigen::Matrix4d t = s.baseline.workpiece_from_tool(at.data());
    Vector5 r;
    r.head<3>() = goal.translation - (t.topLeftCorner<3, 3>() * tool + t.topRightCorner<3, 1>());
    const Eigen::Vector3d turn = (t.topLeftCorner<3, 3>() * machine.tool_direction).cross(direction);
    r[3] = turn.dot(first);
    r[4] = turn.dot(second);
    return r;
  };
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Vector5 r = missing(q);
    if (r.head<3>().norm() <= 1e-9 && r.tail<2>().norm() <= 1e-11) break;
    Eigen::Matrix<double, 5, 5> jacobian;
    for (int i = 0; i < 5; ++i) {
      Vector5 moved = q;
      const double step = i < 2 ? 1e-6 : 1e-3;
      moved[i] += step;
      jacobian.col(i) = (r - missing(moved)) / step;
    }
    q += jacobian.partialPivLu().solve(r);
  }
  return q;
}

void eigen_newton(benchmark::State& state) {
  Setting& s = setting();
  std::size_t pose = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(by_newton(s, pose));
    pose = (pose + 1) % kPoses;
  }
  state.SetItemsProcessed(state.iterations());
}

void correct_one_core(benchmark::State& state) {
  for (auto _ : state) setting().correct(0, kPoses);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoses));
}

void correct_two_cores(benchmark::State& state) {
  for (auto _ : state) {
    for_each_block(kPoses / kPiece, 2, [](std::size_t i) { setting().correct(i * kPiece, kPiece); });
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoses));
}

}  // namespace

int run(int argc, char** argv) {
  take_avx2(argc, argv);
  initialize(argc, argv);
  benchmark::RegisterBenchmark("eigen_newton", &eigen_newton)->Repetitions(9)->MinTime(0.05);
  benchmark::RegisterBenchmark("correct_one_core", &correct_one_core)->Repetitions(9)->MinTime(0.05);
  benchmark::RegisterBenchmark("correct_two_cores", &correct_two_cores)->Repetitions(9)->MinTime(0.05)->UseRealTime();
  Setting& s = setting();
  s.correct(0, kPoses);
  double largest = 0;
  bool reached = true;
  for (std::size_t k = 0; k < kPoses; ++k) {
    reached = reached && s.status[k] == CorrectionStatus::reached;
    if (k % 16 != 0) continue;
    const Eigen::Matrix<double, 5, 1> other = by_newton(s, k);
    for (std::size_t i = 0; i < 5; ++i)
      largest = std::max(largest, std::abs(other[static_cast<Eigen::Index>(i)] - s.corrected[i][k]));
  }
  FastestReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  if (reporter.fastest.size() < 3) return 0;
  for (const auto& [name, seconds] : reporter.fastest)
    std::printf("%-28s %9.2f ns per pose\n", name.c_str(), 1e9 * seconds);
  std::printf("largest difference of a command: %.2e (rad, mm); every pose reached: %s\n", largest,
              reached ? "yes" : "no");
  bool met = reached && largest < 5e-9;
  met &= report("poses per second against Newton with Eigen, one core",
                reporter.fastest["eigen_newton"] / reporter.fastest["correct_one_core"], 10);
  met &= report("million poses per second, two cores", 1e-6 / reporter.fastest["correct_two_cores"], 4);
  return met ? 0 : 1;
}

}  // namespace abbe::benchmarks

int main(int argc, char** argv) { return abbe::benchmarks::run(argc, argv); }
