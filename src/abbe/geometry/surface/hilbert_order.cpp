#include "abbe/geometry/surface/hilbert_order.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

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

/// How the curve runs through a cube: which axis takes each part in Skilling's algorithm, and which of them are counted
/// backwards; and whether the cubes within are.
struct CubeTurn {
  std::array<std::uint32_t, 3> axis{0, 1, 2}, backwards{0, 0, 0};
  std::uint32_t all_backwards = 0;

  std::uint32_t number() const {
    return ((axis[0] * 3 + axis[1]) * 8 + backwards[0] * 4 + backwards[1] * 2 + backwards[2]) * 2 + all_backwards;
  }
};
constexpr std::size_t kTurns = 144;

/// Goes into one of the eight cubes within, which has a bit for each axis. @returns its place on the curve
std::uint32_t enter_cube(CubeTurn& turn, std::uint32_t cube) {
  std::array<std::uint32_t, 3> bit{};
  for (std::size_t k = 0; k < 3; ++k) bit[k] = (cube >> (2 - turn.axis[k]) & 1u) ^ turn.backwards[k];
  const std::uint32_t x = bit[0], y = bit[1] ^ x, z = bit[2] ^ y, all = turn.all_backwards;
  turn.all_backwards ^= z;
  turn.backwards[0] ^= bit[0];
  for (std::size_t k = 1; k < 3; ++k) {
    if (bit[k] != 0) {
      turn.backwards[0] ^= 1u;
    } else {
      std::swap(turn.axis[0], turn.axis[k]);
      std::swap(turn.backwards[0], turn.backwards[k]);
    }
  }
  return (x ^ all) << 2 | (y ^ all) << 1 | (z ^ all);
}

/// For each turn and each cube within a cube within: its place on the curve, six bits, and before them its turn.
using CurveTable = std::array<std::uint16_t, kTurns * 64>;

CurveTable curve_table() {
  CurveTable table{};
  CubeTurn turn;
  for (turn.axis[0] = 0; turn.axis[0] < 3; ++turn.axis[0]) {
    for (turn.axis[1] = 0; turn.axis[1] < 3; ++turn.axis[1]) {
      if (turn.axis[1] == turn.axis[0]) continue;
      turn.axis[2] = 3 - turn.axis[0] - turn.axis[1];
      for (std::uint32_t bits = 0; bits < 16; ++bits) {
        turn.backwards = {bits >> 3, bits >> 2 & 1u, bits >> 1 & 1u};
        turn.all_backwards = bits & 1u;
        for (std::uint32_t cube = 0; cube < 64; ++cube) {
          CubeTurn within = turn;
          const std::uint32_t outer = enter_cube(within, cube >> 3), inner = enter_cube(within, cube & 7u);
          table[turn.number() * 64 + cube] = static_cast<std::uint16_t>(within.number() << 6 | outer << 3 | inner);
        }
      }
    }
  }
  return table;
}

using Coordinates = Eigen::Matrix<double, 3, kSome>;
using Cells = std::array<std::int32_t, 3 * kSome>;  ///< axes of a point side by side

/// Places on the curve of some cells: Skilling's algorithm as a table of two steps at a time.
void places(const Cells& cells, std::uint32_t* place) {
  static const CurveTable table = curve_table();
  static const std::uint32_t begin = CubeTurn{}.number();
  std::array<std::uint32_t, 3 * kSome> bits;
  for (std::size_t i = 0; i < 3 * kSome; ++i) bits[i] = spread(static_cast<std::uint32_t>(cells[i]));
  std::array<std::uint32_t, kSome> cubes;
  for (std::size_t i = 0; i < kSome; ++i) cubes[i] = bits[3 * i] << 2 | bits[3 * i + 1] << 1 | bits[3 * i + 2];
  for (std::size_t i = 0; i < kSome; ++i) {
    std::uint32_t turn = begin, at = 0;
    for (int shift = 3 * (kBits - 2); shift >= 0; shift -= 6) {
      const std::uint32_t entry = table[turn * 64 + (cubes[i] >> shift & 63u)];
      at = at << 6 | (entry & 63u);
      turn = entry >> 6;
    }
    place[i] = at;
  }
}

/// Place on the curve, and point.
using Entry = std::uint64_t;

/// Sorts entries whose places agree in the topmost bits, keeping the order of equal ones.
void sort_bucket(Entry* entries, std::size_t count) {
  if (count < 256) {  // as the number of the point is part of an entry, no two are equal
    std::sort(entries, entries + count);
    return;
  }
  const auto memory = std::make_unique_for_overwrite<Entry[]>(count);
  Entry* scratch = memory.get();
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
  const Eigen::Array<double, 3, Eigen::Dynamic> first = low.array().replicate(1, kSome);
  for_each_block(blocks, threads, [&](std::size_t block) {
    Coordinates coordinates;
    Cells cells{};
    next[block].fill(0);
    for (std::size_t from = block * kPointsOfBlock; from < std::min(count, (block + 1) * kPointsOfBlock);
         from += kSome) {
      const std::size_t some = std::min(kSome, count - from);
      coordinates.leftCols(static_cast<Eigen::Index>(some)) =
          points.middleCols(static_cast<Eigen::Index>(from), static_cast<Eigen::Index>(some));
      for (std::size_t i = 0; i < 3 * some; ++i) {
        const double cell = (coordinates.data()[i] - first.data()[i]) * scale;
        cells[i] = static_cast<std::int32_t>(std::min(std::max(0.0, cell), kCells - 1.0));
      }
      places(cells, place.data() + from);
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
  const auto entries = std::make_unique_for_overwrite<Entry[]>(count);
  for_each_block(blocks, threads, [&](std::size_t block) {
    for (std::size_t i = block * kPointsOfBlock; i < std::min(count, (block + 1) * kPointsOfBlock); ++i) {
      entries[next[block][place[i] >> 2 * kBits]++] = static_cast<Entry>(place[i]) << 32 | i;
    }
  });
  // New memory is not free: the kernel clears it. The places are not needed any more.
  std::vector<std::uint32_t>& order = place;
  order.resize(count);
  for_each_block(kCells, threads, [&](std::size_t bucket) {
    sort_bucket(entries.get() + begin[bucket], begin[bucket + 1] - begin[bucket]);
    for (std::size_t i = begin[bucket]; i < begin[bucket + 1]; ++i) order[i] = static_cast<std::uint32_t>(entries[i]);
  });
  return place;
}

}  // namespace abbe
