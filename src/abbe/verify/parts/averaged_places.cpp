#include "abbe/verify/parts/averaged_places.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/bounding_box.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kMultiplesPerMm = 0x1p60, kMostMultiples = 0x1p90;  // of which there is room for 2^32
constexpr double kSameSide = 0.5;                                    // cosine of 60 degrees
constexpr std::uint64_t kSpread = 0x9e3779b97f4a7c15U;
constexpr std::size_t kBitsOfSlot = 4;
constexpr double kMostCubes = 1e6;  // along an edge: three numbers of 21 bits are one of 63

/// Cubes are counted from 16 in front of the first one, so that no number is negative.
constexpr std::int64_t kInFront = 16;

/// Number of a cube along one axis; a cast rounds to zero, and floor() would be a call.
std::int64_t cube_along(double cubes) {
  return static_cast<std::int64_t>(std::clamp(cubes + static_cast<double>(kInFront), 0.0, 1.1e6));
}

/// Never 0.
std::uint64_t key_of(const std::array<std::int64_t, 3>& cube) {
  std::uint64_t key = 1;
  for (const std::int64_t number : cube) key = (key << 21U) | static_cast<std::uint64_t>(number);
  return key;
}

/// Squared distance of a number from an interval of length one.
double squared_gap(double at, double begin) {
  const double gap = std::max({begin - at, at - (begin + 1), 0.0});
  return gap * gap;
}

}  // namespace

void PlaceSums::add(std::size_t place, double deviation_mm) {
  const double multiples = deviation_mm * kMultiplesPerMm;
  Sum& sum = sums_[place];
  ++sum.count;
  // Nearly all are small enough for the quicker conversion.
  if (std::abs(multiples) < 0x1p62) {
    sum.multiples += static_cast<std::int64_t>(multiples);
  } else {
    sum.multiples += static_cast<Wide>(std::clamp(multiples, -kMostMultiples, kMostMultiples));
  }
}

void PlaceSums::add(const PlaceSums& others) {
  if (others.sums_.size() != sums_.size()) throw std::invalid_argument("sums are of other places");
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    sums_[i].multiples += others.sums_[i].multiples;
    sums_[i].count += others.sums_[i].count;
  }
}

void PlaceSums::add(std::span<const Entry> others) {
  for (const Entry& entry : others) {
    if (entry.place >= sums_.size()) throw std::invalid_argument("a sum is of a place that does not exist");
    sums_[entry.place].multiples +=
        static_cast<Wide>(static_cast<std::int64_t>(entry.high)) * (Wide{1} << 64) + static_cast<Wide>(entry.low);
    sums_[entry.place].count += entry.count;
  }
}

std::vector<PlaceSums::Entry> PlaceSums::entries() const {
  std::vector<Entry> result;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sum& sum = sums_[i];
    if (sum.count == 0) continue;
    result.push_back({.place = static_cast<std::uint32_t>(i),
                      .count = sum.count,
                      .low = static_cast<std::uint64_t>(sum.multiples),
                      .high = static_cast<std::uint64_t>(sum.multiples >> 64)});
  }
  return result;
}

SurfaceAverage PlaceSums::average() const {
  SurfaceAverage result;
  for (const Sum& sum : sums_) {
    result.count.push_back(sum.count);
    result.mean_mm.push_back(sum.count == 0 ? 0.0 : static_cast<double>(sum.multiples) / kMultiplesPerMm / sum.count);
  }
  return result;
}

AveragedPlaces::AveragedPlaces(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& normals, double radius_mm)
    : radius_(radius_mm), count_(static_cast<std::size_t>(places.cols())) {
  if (count_ == 0 || !(radius_mm > 0)) return;
  for (Index i = 0; i < places.cols(); ++i) {
    places_.push_back({places.col(i), normals.col(i), normals.col(i).squaredNorm() > 0 ? kSameSide : -2.0});
  }
  const Eigen::AlignedBox3d box = bounding_box(places);
  lower_ = box.min();
  cubes_per_mm_ = 1 / std::max(2 * radius_mm, box.sizes().maxCoeff() / kMostCubes);
  const std::vector<Entry> entries = places_of_cubes();
  slots_.resize(std::bit_ceil(2 * entries.size()));
  is_taken_.resize(std::max<std::size_t>(1, slots_.size() * kBitsOfSlot / 64));
  near_.reserve(entries.size());
  for (const auto& [key, number] : entries) {
    Slot& slot = slots_[slot_of(key)];
    const auto end = static_cast<std::uint32_t>(near_.size());
    if (slot.key == 0) {
      slot = {key, end, end};
      const std::uint64_t bit = bit_of(key);
      is_taken_[bit / 64] |= std::uint64_t{1} << bit % 64;
    }
    ++slot.end;
    near_.push_back(number);
  }
}

std::vector<AveragedPlaces::Entry> AveragedPlaces::places_of_cubes() const {
  // Every cube that has a point within the radius of the place; a little more, for what is rounded.
  const double reach = 1.0001 * radius_ * cubes_per_mm_;
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Vector3d at = (places_[i].at - lower_) * cubes_per_mm_;
    std::array<std::int64_t, 3> first{}, last{}, cube{};
    for (std::size_t k = 0; k < 3; ++k) {
      first[k] = cube_along(at[static_cast<Index>(k)] - reach);
      last[k] = cube_along(at[static_cast<Index>(k)] + reach);
    }
    const auto gap = [&](std::size_t k) {
      return squared_gap(at[static_cast<Index>(k)], static_cast<double>(cube[k] - kInFront));
    };
    for (cube[0] = first[0]; cube[0] <= last[0]; ++cube[0]) {
      for (cube[1] = first[1]; cube[1] <= last[1]; ++cube[1]) {
        for (cube[2] = first[2]; cube[2] <= last[2]; ++cube[2]) {
          if (gap(0) + gap(1) + gap(2) > reach * reach) continue;
          entries.emplace_back(key_of(cube), static_cast<std::uint32_t>(i));
        }
      }
    }
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::uint64_t AveragedPlaces::cube_of(const Vector3d& point) const {
  const Vector3d at = (point - lower_) * cubes_per_mm_;
  return key_of({cube_along(at.x()), cube_along(at.y()), cube_along(at.z())});
}

std::uint64_t AveragedPlaces::bit_of(std::uint64_t key) const {
  return (key * kSpread) >> 24U & (64 * is_taken_.size() - 1);
}

std::size_t AveragedPlaces::slot_of(std::uint64_t key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = (key * kSpread) >> 32U & mask;
  while (slots_[at].key != 0 && slots_[at].key != key) at = (at + 1) & mask;
  return at;
}

void AveragedPlaces::add(const Vector3d& foot, const Vector3d& normal, double deviation_mm, PlaceSums& sums) const {
  if (slots_.empty()) return;
  const std::uint64_t cube = cube_of(foot), bit = bit_of(cube);
  if ((is_taken_[bit / 64] >> bit % 64 & 1U) == 0) return;
  const Slot& slot = slots_[slot_of(cube)];
  for (std::uint32_t i = slot.begin; i < slot.end; ++i) {
    const Place& place = places_[near_[i]];
    if ((foot - place.at).squaredNorm() > radius_ * radius_ || normal.dot(place.normal) < place.towards) continue;
    sums.add(near_[i], deviation_mm);
  }
}

PlaceSums sums_of_readings(const AveragedPlaces& places, const SurfaceReadings& readings, int threads) {
  constexpr Index kShareReadings = Index{1} << 20;
  const Index n = readings.foot.cols();
  std::vector<PlaceSums> shares(static_cast<std::size_t>((n + kShareReadings - 1) / kShareReadings),
                                PlaceSums(places.count()));
  for_each_block(shares.size(), threads, [&](std::size_t share) {
    const Index first = static_cast<Index>(share) * kShareReadings;
    for (Index i = first; i < std::min(n, first + kShareReadings); ++i) {
      places.add(readings.foot.col(i), readings.normal.col(i), readings.deviation_mm[static_cast<std::size_t>(i)],
                 shares[share]);
    }
  });
  PlaceSums all(places.count());
  for (const PlaceSums& share : shares) all.add(share);
  return all;
}

}  // namespace abbe
