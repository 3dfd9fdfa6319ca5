// Registration of a scan on a mesh from a start near by: this project, Open3D, PCL, in one run.
//
//   registration [points] [triangles] [share of stray points]     exit code 1 if one of the targets is missed
#include "abbe/geometry/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "abbe/geometry/parallel_blocks.h"
#include "scan_yardsticks.h"

namespace abbe::benchmarks {
namespace {

constexpr double kTarget = 3;
constexpr double kReach_mm = 1.5;  ///< beyond the distance of the start

Outcome own_registration(const ScanCase& data) {
  Outcome outcome;
  double start = now_s();
  RegistrationOptions options;
  options.start = RigidTransform{};
  options.loss = RegistrationLoss::tukey;
  const RegistrationTarget target(data.mesh, options);
  outcome.prepare_s = now_s() - start;
  start = now_s();
  PointCloud scan;
  scan.points = data.moved;
  const Registration found = target.register_scan(scan);
  outcome.run_s = now_s() - start;
  outcome.error_mm = data.error_mm(found.fine.mesh_from_scan);
  std::printf("status %s, %d last iterations, standard uncertainty of the shift %.1e mm\n",
              registration_status_name(found.status), found.fine.iterations,
              std::sqrt(found.fine.covariance.bottomRightCorner<3, 3>().trace()));
  return outcome;
}

void print(const char* name, const Outcome& outcome) {
  std::printf("%-14s prepare %7.3f s   register %8.3f s   largest displacement of a vertex %8.1e mm\n", name,
              outcome.prepare_s, outcome.run_s, outcome.error_mm);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  const Eigen::Index count = argc > 1 ? std::atol(argv[1]) : 1000000;
  const std::size_t triangles = argc > 2 ? static_cast<std::size_t>(std::atol(argv[2])) : 1000000;
  const double outliers = argc > 3 ? std::atof(argv[3]) : 0;
  const std::size_t around = static_cast<std::size_t>(std::sqrt(static_cast<double>(triangles) / 4));
  const ScanCase data(around, triangles / (2 * around), count, 0.005, outliers);
  std::printf("%ld points, %ld triangles, %d threads, %.0f %% stray points, start off by %.3f mm\n",
              static_cast<long>(count), static_cast<long>(data.mesh.size()), default_thread_count(), 100 * outliers,
              data.error_mm({}));
  const Outcome own = own_registration(data);
  print("this project", own);
  bool met = true;
  [[maybe_unused]] const auto compare = [&](const char* name, const Outcome& other) {
    print(name, other);
    const double ratio = other.total_s() / own.total_s();
    const bool good = ratio >= kTarget && own.error_mm <= other.error_mm;
    std::printf("  against %s, whole time: %.2f times   target %.0f   %s\n", name, ratio, kTarget,
                good ? "met" : "MISSED");
    met = met && good;
  };
#ifdef BENCHMARK_OPEN3D
  compare("Open3D", open3d_registration(data, kReach_mm));
#endif
#ifdef BENCHMARK_PCL
  compare("PCL", pcl_registration(data, kReach_mm));
#endif
  return met ? 0 : 1;
}

}  // namespace
}  // namespace abbe::benchmarks

int main(int argc, char** argv) { return abbe::benchmarks::run(argc, argv); }
