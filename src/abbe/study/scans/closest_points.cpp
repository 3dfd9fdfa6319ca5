#include "abbe/study/scans/closest_points.h"

#include <algorithm>
#include <bit>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"

namespace abbe {
namespace {

/// So many that most neighbours of a point are in its block, and so few that no process waits long for another.
constexpr std::size_t kPointsOfBlock = 32768;
/// So few that they stay in the cache of a processor.
constexpr std::size_t kSearchedTogether = 8192;
/// Two vectors, the distance and the rest.
constexpr std::size_t kNumbersOfPoint = 8;

void pack_surface_point(const SurfacePoint& found, double* numbers) {
  std::copy_n(found.point.data(), 3, numbers);
  std::copy_n(found.normal.data(), 3, numbers + 3);
  numbers[6] = found.distance;
  const std::uint64_t rest = std::uint64_t{found.triangle} << 16U | static_cast<std::uint64_t>(found.feature) << 8U |
                             (found.on_border ? 1U : 0U);
  numbers[7] = std::bit_cast<double>(rest);
}

SurfacePoint unpacked_surface_point(const double* numbers) {
  SurfacePoint found;
  std::copy_n(numbers, 3, found.point.data());
  std::copy_n(numbers + 3, 3, found.normal.data());
  found.distance = numbers[6];
  const auto rest = std::bit_cast<std::uint64_t>(numbers[7]);
  found.triangle = static_cast<std::uint32_t>(rest >> 16U);
  found.feature = static_cast<SurfaceFeature>(rest >> 8U & 0xffU);
  found.on_border = (rest & 1U) != 0;
  return found;
}

}  // namespace

std::uint64_t fingerprint_of_mesh(const TriangleMesh& mesh) {
  Digest digest;
  for (const double value : mesh.vertices.reshaped()) digest.add_number(value);
  for (const std::uint32_t vertex : mesh.triangles.reshaped()) digest.add(vertex);
  return digest.value();
}

WorkDriver with_mesh(const WorkDriver& driver, const TriangleMesh& mesh) {
  if (!driver) return {};
  return [driver, of_mesh = fingerprint_of_mesh(mesh)](const NumberedWork& work) {
    NumberedWork here = work;
    here.fingerprint = [&work, of_mesh] {
      Digest digest;
      digest.add(of_mesh);
      digest.add(work.fingerprint());
      return digest.value();
    };
    driver(here);
  };
}

std::optional<std::vector<SurfacePoint>> closest_points(const ClosestPointFinder& surface, const TriangleMesh& mesh,
                                                        const Eigen::Matrix3Xd& points, int threads,
                                                        const JobOptions& job) {
  // One process is quicker with all points at a time, in an order of their own.
  if (!job.work) return surface.closest(points, threads, job.stop);
  const auto all = static_cast<std::size_t>(points.cols());
  std::vector<SurfacePoint> found(all);
  NumberedWork work{.name = "comparison", .blocks = (all + kPointsOfBlock - 1) / kPointsOfBlock, .threads = threads};
  work.is_kept = false;
  std::vector<std::uint8_t> has(work.blocks, 0);
  const auto first_of = [](std::size_t block) { return block * kPointsOfBlock; };
  const auto count_of = [&](std::size_t block) { return std::min(kPointsOfBlock, all - first_of(block)); };
  work.fingerprint = [&] {
    Digest digest;
    digest.add_text("closest points");
    digest.add_text(vector_instructions());
    digest.add(fingerprint_of_mesh(mesh));
    digest.add_numbers({points.data(), static_cast<std::size_t>(points.size())});
    return digest.value();
  };
  work.compute = [&](std::size_t block) {
    for (std::size_t at = 0; at < count_of(block); at += kSearchedTogether) {
      const std::size_t first = first_of(block) + at, count = std::min(kSearchedTogether, count_of(block) - at);
      const std::vector<SurfacePoint> some = surface.closest(
          points.middleCols(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count)), 1, job.stop);
      std::copy(some.begin(), some.end(), found.begin() + static_cast<std::ptrdiff_t>(first));
    }
    has[block] = 1;
  };
  work.pack = [&](std::size_t block, std::vector<std::byte>& bytes) {
    std::vector<double> numbers(kNumbersOfPoint * count_of(block));
    for (std::size_t i = 0; i < count_of(block); ++i) {
      pack_surface_point(found[first_of(block) + i], &numbers[kNumbersOfPoint * i]);
    }
    pack_numbers(numbers, bytes);
  };
  work.unpack = [&](std::size_t block, std::span<const std::byte> bytes) {
    std::vector<double> numbers(kNumbersOfPoint * count_of(block));
    unpack_numbers(bytes, numbers);
    require_unpacked(bytes);
    for (std::size_t i = 0; i < count_of(block); ++i) {
      found[first_of(block) + i] = unpacked_surface_point(&numbers[kNumbersOfPoint * i]);
    }
    has[block] = 1;
  };
  std::size_t done = 0;
  work.finished = [&](std::size_t block) {
    done += count_of(block);
    if (job.progress) job.progress(done, all);
  };
  do_work(job.work, work);
  if (std::find(has.begin(), has.end(), 0) != has.end()) return std::nullopt;
  return found;
}

}  // namespace abbe
