#include "abbe/geometry/surface/vertex_welder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <stdexcept>

namespace abbe {
namespace {

constexpr std::uint32_t kFree = 0xffffffffU;
// Corners looked up together, so that their places in memory are fetched at the same time.
constexpr std::size_t kTogether = 32;

std::uint64_t hash_of(const double* corner) {
  // Adding zero makes minus zero zero.
  const auto x = std::bit_cast<std::uint64_t>(corner[0] + 0.0);
  const auto y = std::bit_cast<std::uint64_t>(corner[1] + 0.0);
  const auto z = std::bit_cast<std::uint64_t>(corner[2] + 0.0);
  std::uint64_t hash = x * 0x9e3779b97f4a7c15U;
  hash = (std::rotl(hash, 23) ^ y) * 0xbf58476d1ce4e5b9U;
  hash = (std::rotl(hash, 23) ^ z) * 0x94d049bb133111ebU;
  hash ^= hash >> 32;
  return hash * 0x9e3779b97f4a7c15U;
}

}  // namespace

VertexWelder::VertexWelder(std::size_t expected, std::size_t corners) : corners_(corners) {
  rehash(std::bit_ceil(std::max<std::size_t>(2 * expected, 64)));
  coordinates_.reserve(3 * expected);
}

void VertexWelder::rehash(std::size_t slots) {
  slots_.assign(slots, kFree);
  shift_ = 64 - std::countr_zero(slots);
  const std::size_t mask = slots - 1;
  for (std::size_t vertex = 0; vertex < size(); ++vertex) {
    std::size_t slot = static_cast<std::size_t>(hash_of(&coordinates_[3 * vertex]) >> shift_);
    while (slots_[slot] != kFree) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<std::uint32_t>(vertex);
  }
}

void VertexWelder::make_room() {
  const std::size_t most = size() + kTogether, room = slots_.size() / 3 * 2;
  if (most <= room && 3 * most <= coordinates_.capacity()) return;
  // As many new ones among the corners to come as among those so far.
  std::size_t likely = 2 * most;
  if (corners_ > added_ && added_ > 0) {
    const double share = static_cast<double>(size()) / static_cast<double>(added_);
    likely = std::clamp(static_cast<std::size_t>(share * static_cast<double>(corners_)), most + most / 4, 8 * most);
  }
  if (3 * most > coordinates_.capacity()) coordinates_.reserve(3 * likely);
  if (most > room) rehash(std::max(2 * slots_.size(), std::bit_ceil(likely + likely / 2)));
}

void VertexWelder::add(std::span<const double> corners, std::uint32_t* indices) {
  assert(corners.size() % 3 == 0);
  std::array<std::uint64_t, kTogether> hashes{};
  const std::size_t count = corners.size() / 3;
  for (std::size_t begin = 0; begin < count; begin += kTogether) {
    const std::size_t end = std::min(begin + kTogether, count);
    // At most two thirds full afterwards, whatever is new.
    make_room();
    added_ += end - begin;
    if (size() + kTogether >= kFree) throw std::length_error("more than 2^32 - 2 vertices");
    for (std::size_t i = begin; i < end; ++i) {
      hashes[i - begin] = hash_of(&corners[3 * i]);
      __builtin_prefetch(&slots_[static_cast<std::size_t>(hashes[i - begin] >> shift_)]);
    }
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t i = begin; i < end; ++i) {
      const double* const corner = &corners[3 * i];
      std::size_t slot = static_cast<std::size_t>(hashes[i - begin] >> shift_);
      while (true) {
        const std::uint32_t vertex = slots_[slot];
        if (vertex == kFree) {
          slots_[slot] = indices[i] = static_cast<std::uint32_t>(size());
          for (std::size_t k = 0; k < 3; ++k) coordinates_.push_back(corner[k] + 0.0);
          break;
        }
        const double* const known = &coordinates_[3 * static_cast<std::size_t>(vertex)];
        if (known[0] == corner[0] && known[1] == corner[1] && known[2] == corner[2]) {
          indices[i] = vertex;
          break;
        }
        slot = (slot + 1) & mask;
      }
    }
  }
}

Eigen::Map<const Eigen::Matrix3Xd> VertexWelder::vertices() const {
  return {coordinates_.data(), 3, static_cast<Eigen::Index>(size())};
}

}  // namespace abbe
