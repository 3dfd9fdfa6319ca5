// Kernels beside what the processor and its memory can do at most, measured in the same run.
//
//   roofline [--avx2]
//
// Operations are multiplications and additions of the formulas, not of the instructions; bytes are those that have to
// come from memory or go there. The bound is the longer one of both times at the peak. Nothing is judged: how near a
// kernel comes to its bound says what there is left to gain.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <numeric>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/surface/closest_point.h"
#include "abbe/identify/normal_equations.h"
#include "five_axis_case.h"
#include "identification_case.h"
#include "identification_timing.h"
#include "instruction_set.h"
#include "machine_peak.h"
#include "scan_case.h"
#include "tracker_csv.h"

namespace abbe::benchmarks {
namespace {

/// Shortest time of some repetitions, s.
double fastest(int repetitions, const std::function<void()>& work) {
  double best = 1e300;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const double start = seconds();
    work();
    best = std::min(best, seconds() - start);
  }
  return best;
}

/// What the machine can do with one thread and with two.
struct Peak {
  double operations[2] = {peak_operations(1), peak_operations(2)};
  double bandwidth[2] = {memory_bandwidth(1), memory_bandwidth(2)};
};

/// A line of the table; counts and time are per item.
struct Kernel {
  std::string name;
  int threads = 1;
  double time = 0;                   ///< s
  double operations = 0, bytes = 0;  ///< 0: not counted
  double bandwidth = 0;              ///< of the bytes, bytes per s; 0: of the memory
};

void print(const Peak& peak, const Kernel& kernel) {
  const double bandwidth = kernel.bandwidth > 0 ? kernel.bandwidth : peak.bandwidth[kernel.threads - 1];
  const double computing = kernel.operations / peak.operations[kernel.threads - 1], moving = kernel.bytes / bandwidth;
  fmt::print("{:<46} {:>2} {:>10.1f}", kernel.name, kernel.threads, 1e9 * kernel.time);
  const auto rate = [&](double count) {
    fmt::print("{}", count > 0 ? fmt::format(" {:>9.1f}", 1e-9 * count / kernel.time) : "         -");
  };
  rate(kernel.operations);
  rate(kernel.bytes);
  if (std::max(computing, moving) > 0) {
    fmt::print("  {:>4.0f} % of {}", 100 * std::max(computing, moving) / kernel.time,
               computing > moving     ? "the operations"
               : kernel.bandwidth > 0 ? "the cache"
                                      : "the memory");
  }
  fmt::print("\n");
}

/// Operations of one pose with rotation, by axis: the error motions, sine and cosine of three small angles, three turns
/// of three vectors by the errors, the motion of the axis, the location errors as one constant motion; and the third
/// column.
double pose_operations(const FiveAxisCase& five_axis) {
  constexpr double kSmallAngle = 7, kTurn = 6, kSineAndCosine = 34, kHarmonic = 6, kMotion = 15;
  double count = 9;
  for (std::size_t i = 0; i < five_axis.machine.axes.size(); ++i) {
    const bool rotary = five_axis.machine.axes[i].kind == AxisKind::rotary;
    double harmonics = 0;
    for (const ErrorMotion& motion : five_axis.errors.motions) {
      if (motion.axis != i) continue;
      count += 2 * static_cast<double>(motion.basis.size() - 1);
      if (rotary) harmonics = static_cast<double>(motion.basis.order);
    }
    count += 3 * kSmallAngle + 9 * kTurn + 3;
    count += rotary ? kSineAndCosine + kHarmonic * (harmonics - 1) + 3 * kTurn : 1;
    const bool is_located = std::any_of(five_axis.errors.locations.begin(), five_axis.errors.locations.end(),
                                        [&](const LocationError& location) { return location.axis == i; });
    if (is_located) count += 3 * kMotion + 3;
  }
  return count;
}

struct PoseArrays {
  static constexpr std::size_t kPoses = std::size_t{1} << 18;
  explicit PoseArrays(const FiveAxisCase& five_axis)
      : plan(five_axis.machine, five_axis.errors, Body::tool, Body::workpiece), commands(five_axis.machine, kPoses) {
    std::fill_n(start[2], kPoses, five_axis.machine.tool_offset.z());
  }
  void transform(std::size_t first, std::size_t count) {
    std::array<const double*, 5> axis{};
    for (std::size_t i = 0; i < 5; ++i) axis[i] = commands.pointers[i] + first;
    RotationArrays arrays;
    for (int i = 0; i < 9; ++i) arrays.r[i] = rotation[static_cast<std::size_t>(i)] + first;
    plan.transform({axis, count}, {&start[0][first], &start[1][first], &start[2][first]},
                   {&seen[0][first], &seen[1][first], &seen[2][first]}, arrays);
  }
  ChainPlan plan;
  Commands commands;
  Arrays start{3, kPoses}, seen{3, kPoses}, rotation{9, kPoses};
};

void print_poses(const Peak& peak, const FiveAxisCase& five_axis) {
  PoseArrays poses(five_axis);
  constexpr std::size_t kCached = 1024, kTask = 4096;
  const double operations = pose_operations(five_axis);
  Kernel cached{"pose with errors, in the cache", 1, 0, operations};
  cached.time = fastest(200, [&] { poses.transform(0, kCached); }) / kCached;
  print(peak, cached);
  Kernel streamed{"pose with errors, from memory", 2, 0, operations, 160};
  streamed.time = fastest(20,
                          [&] {
                            for_each_block(PoseArrays::kPoses / kTask, 2,
                                           [&](std::size_t block) { poses.transform(block * kTask, kTask); });
                          }) /
                  PoseArrays::kPoses;
  print(peak, streamed);

  constexpr std::size_t n = ChainPlan::kBlockSize;
  std::vector<std::size_t> parameters(five_axis.errors.parameter_count());
  std::iota(parameters.begin(), parameters.end(), std::size_t{0});
  const CoordinateRows coordinates;
  std::vector<double> jacobian(parameters.size() * 3 * n);
  poses.transform(0, n);
  const double elements = 3.0 * static_cast<double>(parameters.size());
  // An element is one product; it is written once, to the second-level cache.
  Kernel derivatives{"Jacobian, 3 rows by 212 parameters", 1, 0, elements, 8 * elements};
  derivatives.bandwidth = store_bandwidth(jacobian.size() * sizeof(double));
  derivatives.time = fastest(200,
                             [&] {
                               poses.plan.differentiate({poses.commands.pointers, n}, {},
                                                        {poses.seen[0], poses.seen[1], poses.seen[2]},
                                                        coordinates.rows(), parameters, jacobian.data(), 3 * n);
                             }) /
                     n;
  print(peak, derivatives);
}

void print_inverse(const Peak& peak, const FiveAxisCase& five_axis) {
  constexpr std::size_t kPoses = 4096;
  const CompensatedInverse inverse(five_axis.machine, five_axis.errors);
  const std::array<std::vector<double>, 5> commands = commands_to_correct(five_axis, kPoses);
  std::array<std::vector<double>, 5> corrected;
  std::array<const double*, 5> in{};
  std::array<double*, 5> out{};
  for (std::size_t i = 0; i < 5; ++i) {
    corrected[i].resize(kPoses);
    in[i] = commands[i].data();
    out[i] = corrected[i].data();
  }
  std::vector<CorrectionStatus> status(kPoses);
  Kernel kernel{"compensated inverse, to 1e-9 mm", 1};
  kernel.time = fastest(30, [&] { inverse.correct({in, kPoses}, {out, status.data(), nullptr, nullptr}); }) / kPoses;
  print(peak, kernel);
}

void print_identification(const Peak& peak) {
  constexpr std::size_t kReadings = 10000;
  const benchmark_case::XcfzCase data(kReadings);
  const auto observed = data.observations();
  const Problem problem = data.problem(*observed);
  const Eigen::VectorXd start = present_values(problem);
  const ReadingStream stream(problem, kThreads);
  const auto parameters = static_cast<double>(start.size());
  // A symmetric matrix takes a multiplication and an addition for each of its distinct elements and each row; residuals
  // and their derivatives come on top and are not counted.
  Kernel kernel{"normal equations, 60 parameters, per reading", kThreads, 0, 3 * parameters * (parameters + 1)};
  kernel.time = fastest(30, [&] { stream.sums(start, {}, Wanted::normal); }) / kReadings;
  print(peak, kernel);
}

void print_closest_point(const Peak& peak) {
  const ScanCase scan(1000, 500, 1'000'000, 0.01, 0);
  const ClosestPointFinder finder(scan.mesh);
  Kernel kernel{"closest point, 1e6 triangles, scan order", 2};
  kernel.time = fastest(3, [&] { finder.signed_distances(scan.scan, 2); }) / static_cast<double>(scan.scan.cols());
  print(peak, kernel);
}

void print_csv(const Peak& peak) {
  constexpr int kRows = 500'000;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("abbe_roofline_{}.csv", static_cast<long>(seconds() * 1e6));
  write_tracker_csv(path.string(), kRows);
  const Machine machine = machine_of_tracker_csv();
  MeasurementOptions options;
  options.threads = 2;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  Kernel kernel{"CSV of a tracker, per row", 2, 0, 0, bytes / kRows};
  kernel.time = fastest(5, [&] { read_measurements(path, machine, options); }) / kRows;
  std::filesystem::remove(path);
  print(peak, kernel);
}

}  // namespace

int run(int argc, char** argv) {
  take_avx2(argc, argv);
  const Peak peak;
  fmt::print("operations at most: {:.1f} and {:.1f} thousand million per second with one and two threads\n",
             1e-9 * peak.operations[0], 1e-9 * peak.operations[1]);
  fmt::print("memory at most: {:.1f} and {:.1f} GB/s\n\n", 1e-9 * peak.bandwidth[0], 1e-9 * peak.bandwidth[1]);
  fmt::print("{:<46} {:>2} {:>10} {:>9} {:>9}  {}\n", "kernel, threads", "", "ns", "Gop/s", "GB/s", "of the bound");
  const FiveAxisCase five_axis;
  print_poses(peak, five_axis);
  print_identification(peak);
  print_inverse(peak, five_axis);
  print_closest_point(peak);
  print_csv(peak);
  return 0;
}

}  // namespace abbe::benchmarks

int main(int argc, char** argv) { return abbe::benchmarks::run(argc, argv); }
