#include "abbe/geometry/registration/registration_pass.h"

#include <algorithm>
#include <vector>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

/// Blocks that are handed out together.
constexpr std::size_t kBlocksTogether = 8;
constexpr std::size_t kLeastShared = 100000;  ///< points

/// Calls with the numbers of which the sums consist, in place.
template <typename Take>
void for_numbers_of(WeightedSums& sums, const Take& take) {
  for (Matrix6d* const matrix : {&sums.hessian, &sums.slope, &sums.square}) take({matrix->data(), 36});
  take({sums.gradient.data(), 6});
  take({&sums.weighted_square, 1});
  take({&sums.weight, 1});
  for (Eigen::Index* const count : {&sums.used, &sums.beyond_border}) {
    auto number = static_cast<double>(*count);
    take({&number, 1});
    *count = static_cast<Eigen::Index>(number);
  }
}

}  // namespace

void WeightedSums::operator+=(const WeightedSums& other) {
  hessian += other.hessian;
  slope += other.slope;
  square += other.square;
  gradient += other.gradient;
  weighted_square += other.weighted_square;
  weight += other.weight;
  used += other.used;
  beyond_border += other.beyond_border;
}

void do_pass(const RegistrationPass& pass, const WorkDriver& driver, int threads) {
  const std::size_t blocks = pass.sums.size(), points = pass.distances.size();
  if (!driver || points < kLeastShared) return for_each_block(blocks, threads, pass.compute);
  NumberedWork work{
      .name = "registration", .blocks = (blocks + kBlocksTogether - 1) / kBlocksTogether, .threads = threads};
  work.for_all = true;
  work.is_kept = false;
  work.fingerprint = pass.fingerprint;
  const auto sums_of = [&](std::size_t group) {
    const std::size_t first = group * kBlocksTogether;
    return pass.sums.subspan(first, std::min(kBlocksTogether, blocks - first));
  };
  const auto distances_of = [&](std::size_t group) {
    const std::size_t together = kBlocksTogether * pass.block_points, first = group * together;
    return pass.distances.subspan(first, std::min(together, points - first));
  };
  work.compute = [&](std::size_t group) {
    const std::size_t first = group * kBlocksTogether;
    for (std::size_t block = first; block < std::min(blocks, first + kBlocksTogether); ++block) pass.compute(block);
  };
  work.pack = [&](std::size_t group, std::vector<std::byte>& bytes) {
    for (WeightedSums& sums : sums_of(group)) {
      for_numbers_of(sums, [&](std::span<double> numbers) { pack_numbers(numbers, bytes); });
    }
    pack_numbers(distances_of(group), bytes);
  };
  work.unpack = [&](std::size_t group, std::span<const std::byte> bytes) {
    for (WeightedSums& sums : sums_of(group)) {
      for_numbers_of(sums, [&](std::span<double> numbers) { unpack_numbers(bytes, numbers); });
    }
    unpack_numbers(bytes, distances_of(group));
    require_unpacked(bytes);
  };
  do_work(driver, work);
}

}  // namespace abbe
