#pragma once

// Internal to study: what is found of one piece of a scan, and how a process tells it to another one.
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"

namespace abbe {

/// Which points of a piece count, and what is wanted of them.
struct PieceQuestion {
  double largest_mm = 0;                                 ///< points farther away do not count; 0: all do
  std::span<const std::uint32_t> face_of_triangle = {};  ///< empty: no faces
  bool with_points = false;                              ///< for files and a picture, too
};

/// The points of one piece that count, in the order of the scan.
struct PieceDeviations {
  std::array<std::uint64_t, 4> counts{};  ///< points, not finite, beyond the border, too far
  std::vector<double> deviation_mm;       ///< [n]
  std::vector<std::uint32_t> faces;       ///< [n], or empty
  // With points only:
  std::vector<double> points, feet;      ///< [3 n] mm, and on the part
  std::vector<double> normals;           ///< [3 k] of the part there: few of them are different
  std::vector<std::uint32_t> normal_of;  ///< [n]
  std::string rows;                      ///< of deviation.csv

  /// Room for about so many points, so that nothing is copied as they come.
  void reserve(std::size_t about, const PieceQuestion& question);
  /// @param points   [3, m] mm, frame of the part @param closest  [m] on the part
  void add(const Eigen::Matrix3Xd& points, std::span<const SurfacePoint> closest, const PieceQuestion& question);

  /// As bytes: the counts and deviations, and what else there is.
  void pack(std::vector<std::byte>& bytes) const;
  /// @throws WorkError if the bytes are not of a piece
  void unpack(std::span<const std::byte> bytes);

 private:
  std::uint32_t number_of_normal(const Eigen::Vector3d& normal);

  std::vector<std::uint32_t> recent_normals_{};  // by some of their bits
};

}  // namespace abbe
