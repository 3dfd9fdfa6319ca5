#include "abbe/geometry/surface/distance_grid.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"

namespace abbe {

DistanceGrid::DistanceGrid(const ClosestPointFinder& surface, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                           double margin, int cells, int threads, const WorkDriver& work) {
  const Eigen::Vector3d extent = (high - low).array() + 2 * margin;
  const double step = extent.maxCoeff() / cells;
  inverse_step_ = 1 / step;
  start_ = low.array() - margin;
  for (int k = 0; k < 3; ++k) size_[k] = static_cast<int>(std::ceil(extent[k] * inverse_step_)) + 1;
  Eigen::Matrix3Xd points(3, Eigen::Index{size_[0]} * size_[1] * size_[2]);
  Eigen::Index next = 0;
  for (int x = 0; x < size_[0]; ++x) {
    for (int y = 0; y < size_[1]; ++y) {
      for (int z = 0; z < size_[2]; ++z) points.col(next++) = start_ + step * Eigen::Vector3d(x, y, z);
    }
  }
  if (work) {
    share(surface, points, threads, work);
    return;
  }
  const Eigen::VectorXd distances = surface.signed_distances(points, threads);
  distances_.reserve(static_cast<std::size_t>(distances.size()));
  for (const double d : distances) distances_.push_back(static_cast<float>(std::abs(d)));
}

void DistanceGrid::share(const ClosestPointFinder& surface, const Eigen::Matrix3Xd& points, int threads,
                         const WorkDriver& driver) {
  constexpr std::size_t kTogether = 4096;
  distances_.resize(static_cast<std::size_t>(points.cols()));
  const std::span all(distances_);
  const auto block_of = [&](std::size_t block) {
    return all.subspan(block * kTogether, std::min(kTogether, all.size() - block * kTogether));
  };
  NumberedWork work{
      .name = "grid of distances", .blocks = (all.size() + kTogether - 1) / kTogether, .threads = threads};
  work.for_all = true;
  work.is_kept = false;
  work.fingerprint = [&] {
    Digest digest;
    digest.add_text("grid of distances");
    digest.add_text(vector_instructions());
    digest.add_numbers({points.data(), static_cast<std::size_t>(points.size())});
    return digest.value();
  };
  work.compute = [&](std::size_t block) {
    const auto first = static_cast<Eigen::Index>(block * kTogether);
    const std::span<float> own = block_of(block);
    const Eigen::VectorXd found =
        surface.signed_distances(points.middleCols(first, static_cast<Eigen::Index>(own.size())), 1);
    for (std::size_t i = 0; i < own.size(); ++i) {
      own[i] = static_cast<float>(std::abs(found[static_cast<Eigen::Index>(i)]));
    }
  };
  work.pack = [&](std::size_t block, std::vector<std::byte>& bytes) {
    const auto own = std::as_bytes(block_of(block));
    bytes.insert(bytes.end(), own.begin(), own.end());
  };
  work.unpack = [&](std::size_t block, std::span<const std::byte> bytes) {
    const auto own = std::as_writable_bytes(block_of(block));
    if (bytes.size() != own.size()) throw WorkError("distances of a grid are cut off");
    std::copy(bytes.begin(), bytes.end(), own.begin());
  };
  do_work(driver, work);
}

}  // namespace abbe
