/// Speed of the polygon's ray tracing against rays traced one by one with Eigen, in one run; the exit code is 1 if a
/// target of docs/performance.md is missed.

#include "abbe/instruments/polygon/polygon_trace.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "abbe/instruments/polygon/polygon_for_test.h"
#include "fastest.h"

namespace abbe::benchmarks {
namespace {

constexpr std::size_t kPositions = 4096;

/// Turns of a table with a prism, everything wrong by a little.
struct Setting {
  test::PolygonCase prism = test::random_polygon(12, 5e-4, 0.1, 1);
  PolygonTrace tracer{prism.polygon, prism.mount, prism.bench};
  std::vector<PolygonPosition> positions;
  std::vector<TableMotion> motions;
  std::vector<double> angle;
  std::vector<std::uint16_t> face_x, face_y;
  std::array<std::vector<double>, 6> motion;
  std::array<std::vector<double>, kPolygonReadings> traced;

  Setting() {
    RandomStream random(2);
    for (std::size_t k = 0; k < kPositions; ++k) {
      positions.push_back(regular_position(12, k));
      motions.push_back(test::random_motion(random, 5e-4, 0.1));
      angle.push_back(positions[k].angle);
      face_x.push_back(static_cast<std::uint16_t>(positions[k].face_x));
      face_y.push_back(static_cast<std::uint16_t>(positions[k].face_y));
      for (std::size_t i = 0; i < 3; ++i) {
        motion[i].push_back(motions[k].angles[static_cast<int>(i)]);
        motion[3 + i].push_back(motions[k].displacement[static_cast<int>(i)]);
      }
    }
    for (std::vector<double>& values : traced) values.resize(kPositions);
  }

  void trace() {
    PolygonPositions in{kPositions, angle.data(), {}, face_x.data(), face_y.data()};
    PolygonTraces out{};
    for (std::size_t i = 0; i < 6; ++i) in.motion[i] = motion[i].data();
    for (std::size_t i = 0; i < kPolygonReadings; ++i) out[i] = traced[i].data();
    tracer.trace(in, out);
  }

  double disagreement() {
    trace();
    double largest = 0;
    for (std::size_t k = 0; k < kPositions; k += 7)
      for (std::size_t i = 0; i < kPolygonReadings; ++i) {
        const double ray = test::traced_ray(static_cast<PolygonReading>(i), prism, positions[k], motions[k]);
        largest = std::max(largest, std::abs(traced[i][k] - ray));
      }
    return largest;
  }
};

Setting& setting() {
  static Setting instance;
  return instance;
}

void count_readings(benchmark::State& state, std::size_t positions) {
  state.SetItemsProcessed(static_cast<std::int64_t>(positions * kPolygonReadings) * state.iterations());
}

void rays_one_by_one(benchmark::State& state) {
  const Setting& s = setting();
  constexpr std::size_t kSome = 256;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kSome; ++k)
      for (std::size_t i = 0; i < kPolygonReadings; ++i) {
        benchmark::DoNotOptimize(
            test::traced_ray(static_cast<PolygonReading>(i), s.prism, s.positions[k], s.motions[k]));
      }
  }
  count_readings(state, kSome);
}

void traced_together(benchmark::State& state) {
  for (auto _ : state) {
    setting().trace();
    benchmark::ClobberMemory();
  }
  count_readings(state, kPositions);
}

/// One reading with its 24 derivatives.
void gradients(benchmark::State& state) {
  const Setting& s = setting();
  constexpr std::size_t kSome = 256;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kSome; ++k)
      for (std::size_t i = 0; i < kPolygonReadings; ++i) {
        PolygonGradient gradient;
        benchmark::DoNotOptimize(polygon_reading(static_cast<PolygonReading>(i), s.prism.polygon, s.prism.mount,
                                                 s.prism.bench, s.positions[k], s.motions[k], &gradient));
        benchmark::DoNotOptimize(gradient.data());
      }
  }
  count_readings(state, kSome);
}

}  // namespace

int run(int argc, char** argv) {
  initialize(argc, argv);
  benchmark::RegisterBenchmark("rays_one_by_one", &rays_one_by_one)->Repetitions(7)->MinTime(0.05);
  benchmark::RegisterBenchmark("traced_together", &traced_together)->Repetitions(7)->MinTime(0.05);
  benchmark::RegisterBenchmark("gradients", &gradients)->Repetitions(7)->MinTime(0.05);
  const double disagreement = setting().disagreement();
  FastestReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  std::printf("\nlargest difference to the baseline: %.2e (rad, mm)\n", disagreement);
  for (const auto& [name, seconds] : reporter.fastest) {
    std::printf("%-28s %9.2f ns per reading\n", name.c_str(), 1e9 * seconds);
  }
  if (reporter.fastest.size() < 3) return 0;
  bool met = disagreement < 1e-11;
  met &= report("readings per second against rays one by one",
                reporter.fastest["rays_one_by_one"] / reporter.fastest["traced_together"], 10);
  met &= report("million readings per second, one core", 1e-6 / reporter.fastest["traced_together"], 2);
  return met ? 0 : 1;
}

}  // namespace abbe::benchmarks

int main(int argc, char** argv) { return abbe::benchmarks::run(argc, argv); }
