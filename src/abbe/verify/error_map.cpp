#include "abbe/verify/error_map.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "abbe/geometry/best_fit_transform.h"
#include "abbe/verify/map_bytes.h"
#include "abbe/verify/map_uncertainty.h"
#include "abbe/verify/parts/deviation_block.h"

namespace abbe {
namespace {

void pack_matrix(const Eigen::Ref<const Eigen::MatrixXd>& matrix, std::vector<std::byte>& bytes) {
  pack_numbers({matrix.data(), static_cast<std::size_t>(matrix.size())}, bytes);
}

/// @param matrix  of its size; its columns without a gap
template <typename Matrix>
void unpack_matrix(std::span<const std::byte>& bytes, Matrix& matrix) {
  unpack_numbers(bytes, {matrix.data(), static_cast<std::size_t>(matrix.size())});
}

/// What a best-fit motion needs of one block.
struct FitSums {
  double count = 0;
  Eigen::Vector3d actual = Eigen::Vector3d::Zero(), reference = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  MapUncertainty::Sums uncertainty;
};

void pack_sums(const FitSums& sums, std::vector<std::byte>& bytes) {
  pack_numbers({&sums.count, 1}, bytes);
  pack_matrix(sums.actual, bytes);
  pack_matrix(sums.reference, bytes);
  pack_matrix(sums.products, bytes);
  pack_matrix(sums.uncertainty.normal, bytes);
  pack_matrix(sums.uncertainty.mixed, bytes);
}

void unpack_sums(std::span<const std::byte> bytes, FitSums& sums) {
  unpack_numbers(bytes, {&sums.count, 1});
  unpack_matrix(bytes, sums.actual);
  unpack_matrix(bytes, sums.reference);
  unpack_matrix(bytes, sums.products);
  unpack_matrix(bytes, sums.uncertainty.normal);
  unpack_matrix(bytes, sums.uncertainty.mixed);
  require_unpacked(bytes);
}

/// @param origin  near the points, so that their products keep their digits
FitSums fit_sums(const DeviationBlock& block, const Eigen::Vector3d& origin) {
  FitSums sums;
  for (std::size_t k = 0; k < block.count; ++k) {
    if (!block.covered[k]) continue;
    const Eigen::Vector3d a = Eigen::Vector3d(block.seen[0][k], block.seen[1][k], block.seen[2][k]) - origin;
    const Eigen::Vector3d r = Eigen::Vector3d(block.point[0][k], block.point[1][k], block.point[2][k]) - origin;
    sums.count += 1;
    sums.actual += a;
    sums.reference += r;
    sums.products += r * a.transpose();
  }
  return sums;
}

/// Tells the fingerprint of the first pass over the poses from that of the second.
constexpr std::uint64_t kFirstPass = 0x5bd1e9955bd1e995U;

class Progress {
 public:
  Progress(const ErrorMapOptions& options, std::size_t total) : report_(options.progress), total_(total) {}
  void add(std::size_t poses) {
    if (!report_) return;
    const std::lock_guard lock(mutex_);
    done_ += poses;
    report_(done_, total_);
  }

 private:
  const std::function<void(std::size_t, std::size_t)>& report_;
  std::size_t total_, done_ = 0;
  std::mutex mutex_;
};

DeviationBlock& thread_block() {
  thread_local DeviationBlock block;
  return block;
}

struct RigidPart {
  RigidTransform datum;
  std::optional<MapUncertainty> uncertainty;
};

/// First pass: the rigid motion to take out, and its share of the uncertainty.
void find_rigid_part(const DeviationModel& model, const PoseSource& poses, const WorkDriver& driver, NumberedWork work,
                     Progress& progress, RigidPart& part) {
  const std::size_t blocks = block_count(poses);
  if (blocks == 0) return;
  Eigen::Vector3d origin;
  {
    DeviationBlock& block = thread_block();
    load_block(poses, 0, block);
    model.evaluate(block, {});
    origin = {block.point[0][0], block.point[1][0], block.point[2][0]};
  }
  std::vector<FitSums> sums(blocks);
  work.name = "best fit of the workpiece datum";
  work.for_all = true;
  work.fingerprint = [of_map = work.fingerprint] { return of_map() ^ kFirstPass; };
  work.pack = [&](std::size_t index, std::vector<std::byte>& bytes) { pack_sums(sums[index], bytes); };
  work.unpack = [&](std::size_t index, std::span<const std::byte> bytes) {
    if (part.uncertainty) sums[index].uncertainty = part.uncertainty->no_sums();
    unpack_sums(bytes, sums[index]);
    progress.add(std::min(DeviationBlock::kSize, poses.count - index * DeviationBlock::kSize));
  };
  work.compute = [&](std::size_t index) {
    DeviationBlock& block = thread_block();
    load_block(poses, index, block);
    model.evaluate(block, {});
    sums[index] = fit_sums(block, origin);
    if (part.uncertainty) sums[index].uncertainty = part.uncertainty->sums(model, block);
    progress.add(block.count);
  };
  do_work(driver, work);
  FitSums total = sums[0];
  for (std::size_t i = 1; i < blocks; ++i) {
    total.count += sums[i].count;
    total.actual += sums[i].actual;
    total.reference += sums[i].reference;
    total.products += sums[i].products;
    if (part.uncertainty) {
      total.uncertainty.normal += sums[i].uncertainty.normal;
      total.uncertainty.mixed += sums[i].uncertainty.mixed;
    }
  }
  if (total.count < 3) return;
  const Eigen::Vector3d actual = total.actual / total.count, reference = total.reference / total.count;
  const Eigen::Matrix3d correlation = total.products - total.count * reference * actual.transpose();
  part.datum.rotation = rotation_from_correlation(correlation);
  part.datum.translation = origin + reference - part.datum.rotation * (origin + actual);
  if (part.uncertainty) part.uncertainty->remove_rigid_motion(total.uncertainty);
}

void check(const Machine& machine, const PoseSource& poses) {
  if (poses.axes != machine.axes.size()) throw std::invalid_argument("error map: poses do not fit the machine's axes");
}

SampleStatistics visit_map(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference,
                           const PoseSource& poses, const ErrorMapOptions& options, RigidTransform& removed,
                           const std::function<void(const ErrorMapBlock&)>& visit, const MapBytes& bytes = {}) {
  check(machine, poses);
  const DeviationModel model(machine, actual, reference, options.orientation);
  RigidPart part;
  if (options.covariance) {
    part.uncertainty.emplace(*options.covariance, actual.parameter_count(), options.orientation);
  }
  Progress progress(options, poses.count * (options.remove_rigid_motion ? 2 : 1));
  NumberedWork work;
  work.name = "map";
  work.blocks = block_count(poses);
  work.threads = options.threads;
  work.fingerprint = [&] { return map_fingerprint(machine, actual, reference, poses, options); };
  const WorkDriver driver = bytes.map != nullptr ? options.work : WorkDriver();
  if (options.remove_rigid_motion) find_rigid_part(model, poses, driver, work, progress, part);
  removed = part.datum;

  std::vector<double> norms(poses.count);
  std::vector<std::uint8_t> covered(poses.count);
  const auto count_of = [&](std::size_t index) {
    return std::min(DeviationBlock::kSize, poses.count - index * DeviationBlock::kSize);
  };
  work.pack = [&](std::size_t index, std::vector<std::byte>& to) {
    const std::size_t first = index * DeviationBlock::kSize, count = count_of(index);
    pack_numbers({norms.data() + first, count}, to);
    const std::span<const std::byte> flags = std::as_bytes(std::span(covered.data() + first, count));
    to.insert(to.end(), flags.begin(), flags.end());
    bytes.pack(first, count, to);
  };
  work.unpack = [&](std::size_t index, std::span<const std::byte> from) {
    const std::size_t first = index * DeviationBlock::kSize, count = count_of(index);
    unpack_numbers(from, {norms.data() + first, count});
    if (from.size() < count) throw WorkError("results of a block are cut off");
    std::memcpy(covered.data() + first, from.data(), count);
    from = from.subspan(count);
    bytes.unpack(first, count, from);
    require_unpacked(from);
    progress.add(count);
  };
  work.compute = [&](std::size_t index) {
    DeviationBlock& block = thread_block();
    load_block(poses, index, block);
    model.evaluate(block, part.datum);
    std::copy_n(block.norm.begin(), block.count, norms.begin() + static_cast<std::ptrdiff_t>(block.first));
    std::copy_n(block.covered.begin(), block.count, covered.begin() + static_cast<std::ptrdiff_t>(block.first));
    std::array<std::vector<double>, 6> uncertainty;
    std::vector<double> norm_uncertainty;
    const double* uncertainty_arrays[6] = {};
    if (part.uncertainty) {
      part.uncertainty->evaluate(model, block, uncertainty, norm_uncertainty);
      for (std::size_t c = 0; c < 6; ++c)
        uncertainty_arrays[c] = uncertainty[c].empty() ? nullptr : uncertainty[c].data();
    }
    if (visit) {
      const auto arrays = [](const std::array<std::vector<double>, 3>& p) {
        return ConstPointArrays{p[0].data(), p[1].data(), p[2].data()};
      };
      ErrorMapBlock seen;
      seen.first = block.first;
      seen.count = block.count;
      seen.axis = block.axis.data();
      seen.point = arrays(block.point);
      seen.displacement = arrays(block.displacement);
      if (options.orientation) seen.rotation = arrays(block.rotation);
      seen.norm = block.norm.data();
      if (part.uncertainty) {
        seen.uncertainty = uncertainty_arrays;
        seen.norm_uncertainty = norm_uncertainty.data();
      }
      seen.covered = block.covered.data();
      visit(seen);
    }
    progress.add(block.count);
  };
  do_work(driver, work);
  const SampleStatistics statistics = sample_statistics(norms, covered);
  if (bytes.map != nullptr) {
    bytes.map->norm = std::move(norms);
    bytes.map->covered = std::move(covered);
  }
  return statistics;
}

}  // namespace

SampleStatistics stream_error_map(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference,
                                  const PoseSource& poses, const ErrorMapOptions& options,
                                  const std::function<void(const ErrorMapBlock&)>& visit) {
  RigidTransform removed;
  return visit_map(machine, actual, reference, poses, options, removed, visit);
}

ErrorMap error_map(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference, const PoseSource& poses,
                   const ErrorMapOptions& options) {
  ErrorMap map;
  const std::size_t n = poses.count;
  for (std::size_t c = 0; c < 3; ++c) {
    map.point[c].resize(n);
    map.displacement[c].resize(n);
    if (options.orientation) map.rotation[c].resize(n);
  }
  if (options.covariance) {
    for (std::size_t c = 0; c < (options.orientation ? 6u : 3u); ++c) map.uncertainty[c].resize(n);
    map.norm_uncertainty.resize(n);
  }
  const auto keep = [&](const ErrorMapBlock& block) {
    const auto copy = [&](const double* from, std::vector<double>& to) {
      if (from && !to.empty()) std::copy_n(from, block.count, to.begin() + static_cast<std::ptrdiff_t>(block.first));
    };
    const auto copy_points = [&](const ConstPointArrays& from, std::array<std::vector<double>, 3>& to) {
      copy(from.x, to[0]);
      copy(from.y, to[1]);
      copy(from.z, to[2]);
    };
    copy_points(block.point, map.point);
    copy_points(block.displacement, map.displacement);
    copy_points(block.rotation, map.rotation);
    copy(block.norm_uncertainty, map.norm_uncertainty);
    for (std::size_t c = 0; block.uncertainty && c < 6; ++c) copy(block.uncertainty[c], map.uncertainty[c]);
  };
  map.statistics = visit_map(machine, actual, reference, poses, options, map.removed, keep, bytes_of(map));
  return map;
}

}  // namespace abbe
