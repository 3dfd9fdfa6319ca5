// Points of a scan from axis positions and indications: the kernel against one pose at a time with Eigen, and the file
// route (CSV in, CSV or PLY out) against std::ifstream, std::stod and std::ofstream in the same run. Exit code 1 if a
// target is missed: 10,000,000 points per second and core in the kernel.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/scan_file.h"
#include "abbe/geometry/parallel_blocks.h"
#include "speed/fastest.h"

namespace {

using namespace abbe;

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::size_t kPoints = 1'000'000;

Machine scanner() {
  return parse_machine(
      "name = \"scanner\"\nchain = \"w C A X' Y' b Z t\"\n[axis.C]\ndirection = [0, 1, 0]\nendless = true\n[axis.A]\n"
      "endless = true\n[axis.X]\ntravel_mm = [-100, 100]\n[axis.Y]\ntravel_mm = [-100, 100]\n[axis.Z]\n"
      "travel_mm = [-100, 100]\n[tool]\nreference_mm = [0, 0, 10.05]\n",
      "scanner");
}

/// Calibrated lines of both stages, directions of the linear axes.
ErrorSet calibrated(const Machine& machine) {
  using enum Component;
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C"), y = machine.find_axis("Y"),
                    z = machine.find_axis("Z");
  ErrorSet errors;
  errors.locations = {{a, B, -0.0060, 0}, {a, C, 0.0013, 0},  {a, Y, -0.0012, 0}, {a, Z, 0.0177, 0},
                      {c, A, -0.0148, 0}, {c, C, -0.0088, 0}, {c, X, 0.2906, 0},  {c, Z, 0.6875, 0},
                      {y, C, 20e-6, 0},   {z, A, -15e-6, 0},  {z, B, 12e-6, 0}};
  return errors;
}

/// Commands and indications of a rotary scan: chain order C, A, X, Y, Z, then the indication.
/// @param first  number of the first of them
std::vector<std::vector<double>> readings(std::size_t count, std::size_t first = 0) {
  std::vector<std::vector<double>> columns(6, std::vector<double>(count));
  for (std::size_t k = 0; k < count; ++k) {
    RandomStream random(3, k);
    columns[0][k] = 0.7 * kDegree * static_cast<double>((first + k) % 100000);
    columns[1][k] = 20 * kDegree * std::sin(1e-5 * static_cast<double>(first + k));
    for (std::size_t i = 2; i < 5; ++i) columns[i][k] = random.uniform(-12, 12);
    columns[5][k] = random.uniform(-0.2, 0.2);
  }
  return columns;
}

void one_by_one(benchmark::State& state) {
  constexpr std::size_t kCount = 20'000;
  const Machine machine = scanner();
  const ErrorSet errors = calibrated(machine);
  const auto columns = readings(kCount);
  std::vector<double> pose(5);
  for (auto _ : state) {
    for (std::size_t k = 0; k < kCount; ++k) {
      for (std::size_t i = 0; i < 5; ++i) pose[i] = columns[i][k];
      const Eigen::Vector3d point =
          actual_workpiece_from_tool(machine, errors, pose) * Eigen::Vector3d(0, 0, -columns[5][k]);
      benchmark::DoNotOptimize(point.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
}

/// @param threads  each with its share of the points, evenly
void kernel(benchmark::State& state, int threads, std::size_t first = 0) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const Machine machine = scanner();
  const PointScan scan(machine, calibrated(machine), {});
  const auto columns = readings(count, first);
  std::vector<const double*> axis;
  for (std::size_t i = 0; i < 5; ++i) axis.push_back(columns[i].data());
  std::vector<double> x(count), y(count), z(count);
  const std::size_t share = count / static_cast<std::size_t>(threads);
  for (auto _ : state) {
    for_each_block(static_cast<std::size_t>(threads), threads, [&](std::size_t i) {
      std::vector<const double*> from;
      for (const double* column : axis) from.push_back(column + i * share);
      scan.points({from, share}, columns[5].data() + i * share,
                  {x.data() + i * share, y.data() + i * share, z.data() + i * share});
    });
    benchmark::DoNotOptimize(x.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}
void kernel_in_cache(benchmark::State& state) { kernel(state, 1); }
/// C after 140 turns: what the sine of a large angle costs.
void kernel_in_cache_many_turns(benchmark::State& state) { kernel(state, 1, 72'000); }
void kernel_from_memory(benchmark::State& state) { kernel(state, 1); }
void kernel_from_memory_two_threads(benchmark::State& state) { kernel(state, 2); }

/// What the memory allows: six columns are read and three written, and nothing is computed that takes time.
void memory_limit(benchmark::State& state, int threads) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const auto columns = readings(count);
  std::vector<double> x(count), y(count), z(count);
  const std::size_t share = count / static_cast<std::size_t>(threads);
  for (auto _ : state) {
    for_each_block(static_cast<std::size_t>(threads), threads, [&](std::size_t i) {
      for (std::size_t k = i * share; k < (i + 1) * share; ++k) {
        x[k] = columns[0][k] + columns[1][k];
        y[k] = columns[2][k] + columns[3][k];
        z[k] = columns[4][k] + columns[5][k];
      }
    });
    benchmark::DoNotOptimize(x.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}
void memory_limit_one_thread(benchmark::State& state) { memory_limit(state, 1); }
void memory_limit_two_threads(benchmark::State& state) { memory_limit(state, 2); }

std::filesystem::path folder() { return std::filesystem::temp_directory_path(); }

const std::string& readings_file() {
  static const std::string path = [] {
    const std::string name = (folder() / "abbe_scan_points.csv").string();
    const auto columns = readings(kPoints);
    std::FILE* file = std::fopen(name.c_str(), "w");
    std::fputs("C_deg,A_deg,X_mm,Y_mm,Z_mm,indication_um\n", file);
    for (std::size_t k = 0; k < kPoints; ++k) {
      fmt::print(file, "{:.5f},{:.5f},{:.6f},{:.6f},{:.6f},{:.3f}\n", columns[0][k] / kDegree, columns[1][k] / kDegree,
                 columns[2][k], columns[3][k], columns[4][k], 1e3 * columns[5][k]);
    }
    std::fclose(file);
    return name;
  }();
  return path;
}

void plain_streams(benchmark::State& state) {
  const Machine machine = scanner();
  const ErrorSet errors = calibrated(machine);
  for (auto _ : state) {
    std::ifstream in(readings_file());
    std::ofstream out(folder() / "abbe_scan_points_out.csv");
    out << "x_mm,y_mm,z_mm\n" << std::fixed;
    out.precision(9);
    std::string line, field;
    std::getline(in, line);
    std::vector<double> pose(5);
    while (std::getline(in, line)) {
      std::istringstream fields(line);
      double value[6];
      for (double& v : value) {
        std::getline(fields, field, ',');
        v = std::stod(field);
      }
      for (std::size_t i = 0; i < 5; ++i) pose[i] = i < 2 ? value[i] * kDegree : value[i];
      const Eigen::Vector3d p =
          actual_workpiece_from_tool(machine, errors, pose) * Eigen::Vector3d(0, 0, -1e-3 * value[5]);
      out << p.x() << ',' << p.y() << ',' << p.z() << '\n';
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoints));
}

void file_route(benchmark::State& state, const char* output, int threads) {
  const Machine machine = scanner();
  const PointScan scan(machine, calibrated(machine), {});
  ScanOptions options;
  options.threads = threads;
  for (auto _ : state) {
    const ScanSummary summary = scan_points(readings_file(), machine, scan, folder() / output, options);
    if (summary.points != kPoints) state.SkipWithError("points lost");
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoints));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(std::filesystem::file_size(readings_file())));
}
/// The text of the readings becomes that of the points, which is thrown away: no file is read or written.
void text_route(benchmark::State& state, ScanFormat format, int threads) {
  const Machine machine = scanner();
  const PointScan scan(machine, calibrated(machine), {});
  ScanOptions options;
  options.threads = threads;
  std::ifstream file(readings_file(), std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (auto _ : state) {
    std::size_t bytes = 0;
    const ScanSummary summary = scan_points(
        text, "readings.csv", machine, scan, format, options, [&](std::string_view part) { bytes += part.size(); },
        [](std::size_t) {});
    if (summary.points != kPoints) state.SkipWithError("points lost");
    benchmark::DoNotOptimize(bytes);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoints));
}
void text_to_csv_one_thread(benchmark::State& state) { text_route(state, ScanFormat::csv, 1); }
void text_to_csv_two_threads(benchmark::State& state) { text_route(state, ScanFormat::csv, 2); }
void text_to_ply_one_thread(benchmark::State& state) { text_route(state, ScanFormat::ply, 1); }
void text_to_ply_two_threads(benchmark::State& state) { text_route(state, ScanFormat::ply, 2); }
void csv_to_csv_one_thread(benchmark::State& state) { file_route(state, "abbe_scan_points_out.csv", 1); }
void csv_to_csv(benchmark::State& state) { file_route(state, "abbe_scan_points_out.csv", 2); }
void csv_to_ply_one_thread(benchmark::State& state) { file_route(state, "abbe_scan_points_out.ply", 1); }
void csv_to_ply(benchmark::State& state) { file_route(state, "abbe_scan_points_out.ply", 2); }

}  // namespace

BENCHMARK(one_by_one)->Repetitions(5);
BENCHMARK(kernel_in_cache)->Arg(4096)->Repetitions(9);
BENCHMARK(kernel_in_cache_many_turns)->Arg(4096)->Repetitions(9);
BENCHMARK(kernel_from_memory)->Arg(4'000'000)->MeasureProcessCPUTime()->UseRealTime()->Repetitions(5);
BENCHMARK(kernel_from_memory_two_threads)->Arg(4'000'000)->MeasureProcessCPUTime()->UseRealTime()->Repetitions(5);
BENCHMARK(memory_limit_one_thread)->Arg(4'000'000)->MeasureProcessCPUTime()->UseRealTime()->Repetitions(5);
BENCHMARK(memory_limit_two_threads)->Arg(4'000'000)->MeasureProcessCPUTime()->UseRealTime()->Repetitions(5);
BENCHMARK(text_to_csv_one_thread)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Repetitions(5);
BENCHMARK(text_to_csv_two_threads)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Repetitions(5);
BENCHMARK(text_to_ply_one_thread)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Repetitions(5);
BENCHMARK(text_to_ply_two_threads)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Repetitions(5);
BENCHMARK(plain_streams)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(2);
BENCHMARK(csv_to_csv_one_thread)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime()->Repetitions(3);
BENCHMARK(csv_to_csv)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime()->Repetitions(3);
BENCHMARK(csv_to_ply_one_thread)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime()->Repetitions(3);
BENCHMARK(csv_to_ply)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime()->Repetitions(3);

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  benchmarks::FastestReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  const auto& t = reporter.fastest;
  if (t.count("kernel_in_cache") == 0 || t.count("one_by_one") == 0) return 0;  // a filter was given
  std::printf("\n");
  bool met =
      benchmarks::report("kernel, in cache: million points per second and core", 1e-6 / t.at("kernel_in_cache"), 10);
  met = benchmarks::report("kernel, from memory: million points per second", 1e-6 / t.at("kernel_from_memory"), 10) &&
        met;
  met = benchmarks::report("kernel against one pose at a time", t.at("one_by_one") / t.at("kernel_in_cache"), 5) && met;
  if (t.count("csv_to_csv") != 0 && t.count("plain_streams") != 0) {
    met = benchmarks::report("CSV to CSV against plain streams", t.at("plain_streams") / t.at("csv_to_csv"), 5) && met;
  }
  const auto seconds = [&](const char* name) { return t.count(name) != 0 ? t.at(name) : 0; };
  for (const auto& [name, threads] : {std::pair{"kernel_from_memory", 1},
                                      {"kernel_from_memory_two_threads", 2},
                                      {"memory_limit_one_thread", 1},
                                      {"memory_limit_two_threads", 2},
                                      {"text_to_csv_one_thread", 1},
                                      {"text_to_csv_two_threads", 2},
                                      {"text_to_ply_one_thread", 1},
                                      {"text_to_ply_two_threads", 2},
                                      {"csv_to_csv_one_thread", 1},
                                      {"csv_to_csv", 2},
                                      {"csv_to_ply_one_thread", 1},
                                      {"csv_to_ply", 2}}) {
    if (!(seconds(name) > 0)) continue;
    std::printf("%-32s %d thread%s %8.2f million/s, %8.2f per second of the processor\n", name, threads,
                threads == 1 ? " " : "s", 1e-6 / seconds(name), 1e-6 / reporter.processor.at(name));
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("peak memory %ld MiB\n", usage.ru_maxrss / 1024);
  return met ? 0 : 1;
}
