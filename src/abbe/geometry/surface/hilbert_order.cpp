#include "abbe/geometry/surface/hilbert_order.h"

#include <algorithm>
#include <array>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

constexpr int kBits = 10;  ///< of one axis, and of one pass of the sort
constexpr std::uint32_t kCells = 1u << kBits;
constexpr std::size_t kPointsOfBlock = 16384;
constexpr std::size_t kSome = 128;  ///< points whose places are computed together, in registers

/// Two empty bits behind each of ten bits.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | bits << 16) & 0x030000ffu;
  bits = (bits | bits << 8) & 0x0300f00fu;
  bits = (bits | bits << 4) & 0x030c30c3u;
  return (bits | bits << 2) & 0x09249249u;
}

/// Places on the curve of some cells, by Skilling's algorithm without branches.
void places(std::array<std::array<std::uint32_t, kSome>, 3>* cells, std::uint32_t* place) {
  // Not as a structured binding, which clang 14 does not capture.
  std::array<std::uint32_t, kSome>&x = (*cells)[0], &y = (*cells)[1], &z = (*cells)[2];
  const auto turn = [&](std::array<std::uint32_t, kSome>& axis, int bit) {
    const std::uint32_t low = (1u << bit) - 1;
    for (std::size_t i = 0; i < kSome; ++i) {
      const std::uint32_t set = 0u - (axis[i] >> bit & 1u), exchanged = (x[i] ^ axis[i]) & low & ~set;
      x[i] ^= exchanged ^ (low & set);
      axis[i] ^= exchanged;
    }
  };
  for (int bit = kBits - 1; bit > 0; --bit) {
    for (std::size_t i = 0; i < kSome; ++i) x[i] ^= ((1u << bit) - 1) & (0u - (x[i] >> bit & 1u));
    turn(y, bit);
    turn(z, bit);
  }
  for (std::size_t i = 0; i < kSome; ++i) {
    y[i] ^= x[i];
    z[i] ^= y[i];
    std::uint32_t gray = 0;
    for (int bit = kBits - 1; bit > 0; --bit) gray ^= ((1u << bit) - 1) & (0u - (z[i] >> bit & 1u));
    place[i] = spread(x[i] ^ gray) << 2 | spread(y[i] ^ gray) << 1 | spread(z[i] ^ gray);
  }
}

/// Place on the curve, and point.
using Entry = std::uint64_t;

/// Sorts entries whose places agree in the topmost bits, keeping the order of equal ones.
/// @param scratch  as many
void sort_bucket(Entry* entries, std::size_t count, Entry* scratch) {
  if (count < 256) {  // as the number of the point is part of an entry, no two are equal
    std::sort(entries, entries + count);
    return;
  }
  for (const int shift : {32, 32 + kBits}) {
    std::array<std::uint32_t, kCells + 1> begin{};
    for (std::size_t i = 0; i < count; ++i) ++begin[(entries[i] >> shift & (kCells - 1)) + 1];
    for (std::size_t k = 0; k < kCells; ++k) begin[k + 1] += begin[k];
    for (std::size_t i = 0; i < count; ++i) scratch[begin[entries[i] >> shift & (kCells - 1)]++] = entries[i];
    std::swap(entries, scratch);
  }
}

}  // namespace

std::vector<std::uint32_t> hilbert_order(const Eigen::Ref<const Eigen::Matrix3Xd>& points, const Eigen::Vector3d& low,
                                         const Eigen::Vector3d& high, int threads) {
  const std::size_t count = static_cast<std::size_t>(points.cols()),
                    blocks = (count + kPointsOfBlock - 1) / kPointsOfBlock;
  // One step for all axes, so that cells are cubes.
  const double extent = (high - low).maxCoeff(), scale = extent > 0 ? kCells / extent : 0;
  std::vector<std::uint32_t> place(blocks * kPointsOfBlock);
  std::vector<std::array<std::uint32_t, kCells>> next(blocks);
  for_each_block(blocks, threads, [&](std::size_t block) {
    std::array<std::array<std::uint32_t, kSome>, 3> cells{};
    next[block].fill(0);
    for (std::size_t from = block * kPointsOfBlock; from < std::min(count, (block + 1) * kPointsOfBlock);
         from += kSome) {
      const std::size_t some = std::min(kSome, count - from);
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < some; ++i) {
          const Eigen::Index axis = static_cast<Eigen::Index>(k);
          const double cell = (points(axis, static_cast<Eigen::Index>(from + i)) - low[axis]) * scale;
          cells[k][i] = static_cast<std::uint32_t>(std::min(std::max(0.0, cell), kCells - 1.0));
        }
      }
      places(&cells, place.data() + from);
      for (std::size_t i = from; i < from + some; ++i) ++next[block][place[i] >> 2 * kBits];
    }
  });
  // Where each block's share of each bucket begins.
  std::array<std::size_t, kCells + 1> begin{};
  std::size_t sum = 0;
  for (std::size_t bucket = 0; bucket < kCells; ++bucket) {
    begin[bucket] = sum;
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::uint32_t size = next[block][bucket];
      next[block][bucket] = static_cast<std::uint32_t>(sum);
      sum += size;
    }
  }
  begin[kCells] = sum;
  std::vector<Entry> entries(count), scratch(count);
  for_each_block(blocks, threads, [&](std::size_t block) {
    for (std::size_t i = block * kPointsOfBlock; i < std::min(count, (block + 1) * kPointsOfBlock); ++i) {
      entries[next[block][place[i] >> 2 * kBits]++] = static_cast<Entry>(place[i]) << 32 | i;
    }
  });
  std::vector<std::uint32_t> order(count);
  for_each_block(kCells, threads, [&](std::size_t bucket) {
    sort_bucket(entries.data() + begin[bucket], begin[bucket + 1] - begin[bucket], scratch.data() + begin[bucket]);
    for (std::size_t i = begin[bucket]; i < begin[bucket + 1]; ++i) order[i] = static_cast<std::uint32_t>(entries[i]);
  });
  return order;
}

}  // namespace abbe
