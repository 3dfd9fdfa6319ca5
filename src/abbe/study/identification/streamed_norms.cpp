#include "abbe/study/identification/streamed_norms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "abbe/formats/readings/reading_shards.h"

namespace abbe {
namespace {

NormTally tally_part(const Observations& observations, double limit, std::size_t first, std::size_t last) {
  constexpr std::size_t kBlock = Observations::kBlockSize;
  const std::size_t rows = static_cast<std::size_t>(observations.rows());
  NormTally own;
  std::vector<double> residuals(rows * kBlock);
  for (; first < last; first += kBlock) {
    const std::size_t n = std::min(kBlock, last - first);
    observations.evaluate(first, n, {}, {}, residuals.data(), nullptr, rows * n);
    for (std::size_t k = 0; k < n; ++k) {
      double square = 0;
      for (std::size_t row = 0; row < rows; ++row) square += residuals[row * n + k] * residuals[row * n + k];
      const double norm = std::sqrt(square);
      if (norm > limit) own.beyond += 1;
      if (norm > own.largest) own.largest = norm, own.reading = static_cast<double>(first + k);
    }
  }
  return own;
}

}  // namespace

NormTally tally_norms(const Observations& observations, double limit, std::uint64_t fingerprint, int threads,
                      const WorkDriver& driver) {
  const std::size_t count = observations.reading_count(),
                    parts = (count + ReadingShards::kTogether - 1) / ReadingShards::kTogether,
                    together = ReadingShards::kTogether * ReadingShards::parts_together(parts);
  std::vector<NormTally> tallies((count + together - 1) / together);
  NumberedWork work{.name = "norms of the residuals", .blocks = tallies.size(), .threads = threads};
  work.is_followed = true;
  work.for_all = true;
  work.is_kept = false;
  work.fingerprint = [&] { return fingerprint; };
  work.compute = [&](std::size_t block) {
    tallies[block] = tally_part(observations, limit, block * together, std::min(count, (block + 1) * together));
  };
  work.pack = [&](std::size_t block, std::vector<std::byte>& bytes) {
    const NormTally& own = tallies[block];
    pack_numbers(std::array{own.beyond, own.largest, own.reading}, bytes);
  };
  work.unpack = [&](std::size_t block, std::span<const std::byte> bytes) {
    std::array<double, 3> numbers{};
    unpack_numbers(bytes, numbers);
    require_unpacked(bytes);
    tallies[block] = {numbers[0], numbers[1], numbers[2]};
  };
  do_work(driver, work);
  NormTally total;
  for (const NormTally& own : tallies) total.take(own);
  return total;
}

}  // namespace abbe
