#include "abbe/geometry/registration/registration_pass.h"

#include <algorithm>
#include <array>
#include <vector>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

/// Blocks that are handed out together: few of few, so that every process gets some.
constexpr std::size_t kMostTogether = 8, kGroups = 128;

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

void pack_distances(const BlockDistances& distances, std::vector<std::byte>& bytes) {
  for (const std::size_t count : {distances.below, distances.all, distances.within.size()}) {
    const auto number = static_cast<double>(count);
    pack_numbers({&number, 1}, bytes);
  }
  pack_numbers(distances.within, bytes);
}

void unpack_distances(std::span<const std::byte>& bytes, BlockDistances& distances) {
  std::array<double, 3> counts{};
  unpack_numbers(bytes, counts);
  distances.below = static_cast<std::size_t>(counts[0]);
  distances.all = static_cast<std::size_t>(counts[1]);
  const std::size_t most = bytes.size() / sizeof(double);
  if (!(counts[2] >= 0 && counts[2] <= static_cast<double>(most))) {
    throw WorkError("distances of a block are cut off");
  }
  distances.within.resize(static_cast<std::size_t>(counts[2]));
  unpack_numbers(bytes, distances.within);
}

}  // namespace

std::optional<double> median_distance(std::span<const BlockDistances> blocks) {
  std::size_t all = 0, below = 0;
  std::vector<double> within;
  for (const BlockDistances& block : blocks) {
    all += block.all;
    below += block.below;
    within.insert(within.end(), block.within.begin(), block.within.end());
  }
  if (all == 0) return 0.0;
  const std::size_t middle = all / 2;
  if (middle < below || middle - below >= within.size()) return std::nullopt;
  const auto at = within.begin() + static_cast<std::ptrdiff_t>(middle - below);
  std::nth_element(within.begin(), at, within.end());
  return *at;
}

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
  const std::size_t blocks = pass.sums.size();
  if (!driver || pass.points < kLeastSharedPoints) return for_each_block(blocks, threads, pass.compute);
  const std::size_t together = std::clamp<std::size_t>(blocks / kGroups, 1, kMostTogether);
  NumberedWork work{.name = "registration", .blocks = (blocks + together - 1) / together, .threads = threads};
  work.for_all = true;
  work.is_kept = false;
  work.in_ranges = true;
  work.fingerprint = pass.fingerprint;
  const auto for_blocks_of = [&](std::size_t group, const auto& visit) {
    for (std::size_t block = group * together; block < std::min(blocks, (group + 1) * together); ++block) visit(block);
  };
  work.compute = [&](std::size_t group) { for_blocks_of(group, pass.compute); };
  work.pack = [&](std::size_t group, std::vector<std::byte>& bytes) {
    for_blocks_of(group, [&](std::size_t block) {
      for_numbers_of(pass.sums[block], [&](std::span<double> numbers) { pack_numbers(numbers, bytes); });
      pack_distances(pass.distances[block], bytes);
    });
  };
  work.unpack = [&](std::size_t group, std::span<const std::byte> bytes) {
    for_blocks_of(group, [&](std::size_t block) {
      for_numbers_of(pass.sums[block], [&](std::span<double> numbers) { unpack_numbers(bytes, numbers); });
      unpack_distances(bytes, pass.distances[block]);
    });
    require_unpacked(bytes);
  };
  do_work(driver, work);
}

}  // namespace abbe
