// One call of the runtime per servo cycle: how long it takes, as a distribution, beside LinuxCNC's own five-axis
// kinematics without errors where they are installed.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "abbe/runtime/abbe_runtime.h"
#include "abbe/runtime/freeze.h"
#include "speed/five_axis_case.h"
#include "speed/linuxcnc_kinematics.h"

namespace abbe::benchmarks {
namespace {

constexpr std::size_t kCalls = 200000;
constexpr int kRepetitions = 5;

struct Pose {
  std::array<double, 3> point;
  std::array<double, 5> words, joints;
};

/// A way through the working space in steps of a servo cycle (up to 5 m/min and 20 degrees per second), tilted enough
/// or through the singular pose.
std::vector<Pose> way(const Machine& machine, const abbe_runtime* runtime, bool singular) {
  std::vector<Pose> poses(kCalls);
  for (std::size_t k = 0; k < kCalls; ++k) {
    Pose& pose = poses[k];
    const double t = 1e-3 * static_cast<double>(k);
    for (std::size_t i = 0; i < 5; ++i) {
      const Axis& axis = machine.axes[i];
      const double phase = 0.35 * t / (1 + 0.3 * static_cast<double>(i)) + static_cast<double>(i);
      pose.joints[i] = axis.kind == AxisKind::rotary ? 0.9 * std::sin(phase) : 220 * std::sin(phase);
      if (axis.name == "A") pose.joints[i] = singular ? 0.02 * std::sin(3 * t) : 0.6 + 0.4 * std::sin(phase);
    }
    abbe_runtime_nominal_forward(runtime, pose.joints.data(), nullptr, pose.point.data(), pose.words.data());
  }
  return poses;
}

double nanoseconds() {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What looking at the clock costs, ns.
double clock_cost() {
  std::vector<double> costs;
  for (int k = 0; k < 20000; ++k) {
    const double start = nanoseconds();
    costs.push_back(nanoseconds() - start);
  }
  std::nth_element(costs.begin(), costs.begin() + 10000, costs.end());
  return costs[10000];
}

struct Distribution {
  double median, most, nearly_all, largest;
};

/// Shortest time of each call over the repetitions, so that what others do on the machine is not counted as the call's.
template <typename Call>
Distribution distribution(const char* name, const Call& call) {
  static const double clock = clock_cost();
  std::vector<double> times(kCalls, 1e9);
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    for (std::size_t k = 0; k < kCalls; ++k) {
      const double start = nanoseconds();
      call(k);
      times[k] = std::min(times[k], nanoseconds() - start - clock);
    }
  }
  std::sort(times.begin(), times.end());
  const auto part = [&](double share) { return times[static_cast<std::size_t>(share * (kCalls - 1))]; };
  const Distribution found{part(0.5), part(0.99), part(0.999), times.back()};
  std::printf("%-34s median %6.0f   99 %% %6.0f   99.9 %% %6.0f   largest %6.0f ns\n", name, found.median, found.most,
              found.nearly_all, found.largest);
  return found;
}

bool met(const char* what, double value, double limit) {
  std::printf("%-58s %7.0f   at most %5.0f   %s\n", what, value, limit, value <= limit ? "met" : "MISSED");
  return value <= limit;
}

}  // namespace

int run() {
  FiveAxisCase five_axis;
  FreezeOptions options;
  options.tool = five_axis.machine.tool_offset;
  options.world_zero_at_joints = false;
  const FrozenCompensation frozen = freeze(five_axis.machine, five_axis.errors, options);
  abbe_runtime* runtime = nullptr;
  if (abbe_runtime_load(frozen.bytes.data(), frozen.bytes.size(), nullptr, 0, &runtime) != ABBE_OK) return 1;
  std::printf("trunnion mill, 30 error motions (210 coefficients), 11 location errors; %zu calls, best of %d\n", kCalls,
              kRepetitions);
  std::printf("worst iterations over %zu poses: %d; accuracy %.1e mm\n", frozen.poses, frozen.worst_iterations,
              frozen.accuracy);
  double worst = 0, typical = 0;
  for (const bool singular : {false, true}) {
    const std::vector<Pose> poses = way(five_axis.machine, runtime, singular);
    std::printf(singular ? "-- through the singular pose\n" : "-- a five-axis way\n");
    std::array<double, 5> out{};
    std::array<double, 3> point{};
    abbe_runtime_state state;
    int iterations = 0;
    abbe_runtime_start(&state);
    const Distribution inverse = distribution("inverse", [&](std::size_t k) {
      abbe_runtime_inverse(runtime, &state, poses[k].point.data(), poses[k].words.data(), nullptr, 1, out.data());
      iterations = std::max(iterations, state.iterations);
    });
    abbe_runtime_start(&state);
    const Distribution forward = distribution("forward", [&](std::size_t k) {
      abbe_runtime_forward(runtime, &state, poses[k].joints.data(), nullptr, 1, point.data(), out.data());
      iterations = std::max(iterations, state.iterations);
    });
    const Distribution cold = distribution("inverse, without a state", [&](std::size_t k) {
      abbe_runtime_inverse(runtime, nullptr, poses[k].point.data(), poses[k].words.data(), nullptr, 1, out.data());
    });
    distribution("inverse, nominal", [&](std::size_t k) {
      abbe_runtime_nominal_inverse(runtime, poses[k].point.data(), poses[k].words.data(), nullptr, out.data());
    });
    distribution("forward, nominal", [&](std::size_t k) {
      abbe_runtime_nominal_forward(runtime, poses[k].joints.data(), nullptr, point.data(), out.data());
    });
    std::printf("most iterations of a call: %d\n", iterations);
    if (!singular) typical = std::max(inverse.median, forward.median);
    worst = std::max({worst, inverse.nearly_all, forward.nearly_all, cold.nearly_all});
    if (singular) continue;
    LinuxcncKinematics kinematics;
    if (!kinematics.problem().empty()) {
      std::printf("SKIPPED: LinuxCNC's xyzac-trt-kins: %s\n", kinematics.problem().c_str());
      continue;
    }
    std::array<double, 9> joints{};
    LinuxcncPose world{};
    const auto load = [&](std::size_t k) {
      const Pose& pose = poses[k];
      constexpr double kDegrees = 180 / std::numbers::pi;
      world = {
          pose.point[0], pose.point[1], pose.point[2], pose.words[1] * kDegrees, 0, pose.words[0] * kDegrees, 0, 0, 0};
    };
    distribution("xyzac-trt-kins inverse, no errors", [&](std::size_t k) {
      load(k);
      kinematics.inverse(world, joints.data());
    });
    distribution("xyzac-trt-kins forward, no errors", [&](std::size_t k) {
      joints = {poses[k].joints[2], poses[k].joints[3], poses[k].joints[4], poses[k].joints[1], poses[k].joints[0]};
      kinematics.forward(joints.data(), world);
    });
  }
  abbe_runtime_free(runtime);
  bool all = met("typical call, ns", typical, 1000);
  all &= met("99.9 % of calls on both ways, with and without state, ns", worst, 5000);
  return all ? 0 : 1;
}

}  // namespace abbe::benchmarks

int main() { return abbe::benchmarks::run(); }
