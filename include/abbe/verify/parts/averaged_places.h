#pragma once

// Means of the readings about places of a surface, in pieces.
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "abbe/verify/parts/surface_average.h"

namespace abbe {

/// Sums of deviations about places. They are exact to 2^-60 mm, so neither the order of the readings nor how they are
/// grouped changes a bit.
class PlaceSums {
 public:
  /// Sum of one place, for messages: multiples of 2^-60 mm as a whole number of 128 bits.
  struct Entry {
    std::uint32_t place = 0, count = 0;
    std::uint64_t low = 0, high = 0;
    bool operator==(const Entry&) const = default;
  };

  PlaceSums() = default;
  explicit PlaceSums(std::size_t places) : sums_(places) {}

  /// @param deviation_mm  amounts above 2^30 mm count as that
  void add(std::size_t place, double deviation_mm);
  void add(const PlaceSums& others);
  /// @throws std::invalid_argument  a place that does not exist
  void add(std::span<const Entry> others);

  std::vector<Entry> entries() const;  ///< of the places with readings, ascending
  SurfaceAverage average() const;

 private:
  // With `using`, compilers warn that there is no such type in the standard.
  __extension__ typedef __int128 Wide;  // NOLINT(modernize-use-using)
  struct Sum {
    Wide multiples = 0;
    std::uint32_t count = 0;
  };
  std::vector<Sum> sums_;  // [places]
};

/// Places of a surface, and for each the readings about it: those whose feet lie within the radius and on the same side
/// of the part (normals within 60 degrees).
class AveragedPlaces {
 public:
  AveragedPlaces() = default;
  /// @param places   [3, m] mm, on the surface
  /// @param normals  [3, m] unit, or zero: either side counts
  AveragedPlaces(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& normals, double radius_mm);

  std::size_t count() const { return count_; }
  double radius_mm() const { return radius_; }
  /// Adds a reading to the sums of the places that it lies about. Several threads may call it with sums of their own.
  void add(const Eigen::Vector3d& foot, const Eigen::Vector3d& normal, double deviation_mm, PlaceSums& sums) const;

 private:
  struct Place {
    Eigen::Vector3d at, normal;
    double towards = 0;  // least product of the normals
  };
  /// Places that are near some point of a cube.
  struct Slot {
    std::uint64_t key = 0;  // 0: free
    std::uint32_t begin = 0, end = 0;
  };
  using Entry = std::pair<std::uint64_t, std::uint32_t>;  // cube, place

  std::vector<Entry> places_of_cubes() const;  // ascending
  std::uint64_t cube_of(const Eigen::Vector3d& point) const;
  std::uint64_t bit_of(std::uint64_t key) const;
  std::size_t slot_of(std::uint64_t key) const;  // where the key is, or would be

  double radius_ = 0, cubes_per_mm_ = 0;
  std::size_t count_ = 0;
  Eigen::Vector3d lower_ = Eigen::Vector3d::Zero();
  std::vector<Place> places_;
  std::vector<std::uint32_t> near_;  // places, cube by cube
  std::vector<Slot> slots_;          // a power of two of them, at least twice as many as cubes
  // A bit for some numbers of cubes, set if one of these is there. Most readings are about no place if there are many:
  // these bits stay in the cache of a processor and say so.
  std::vector<std::uint64_t> is_taken_;
};

/// Sums of many readings. @param threads  0: all; the result does not depend on it
PlaceSums sums_of_readings(const AveragedPlaces& places, const SurfaceReadings& readings, int threads = 0);

}  // namespace abbe
