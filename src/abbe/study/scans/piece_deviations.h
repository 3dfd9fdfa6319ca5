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
#include "abbe/report/drawings/drawn_readings.h"
#include "abbe/verify/parts/averaged_places.h"

namespace abbe {

/// Which points of a piece count, and what is wanted of them.
struct PieceQuestion {
  double largest_mm = 0;                                 ///< points farther away do not count; 0: all do
  std::span<const std::uint32_t> face_of_triangle = {};  ///< empty: no faces
  /// For files and a picture: the places of its colours; null: there are none. They outlive the question.
  const AveragedPlaces* places = nullptr;
  std::size_t measured = 0;  ///< points of the scan, about
};

/// The points of one piece that count, in the order of the scan.
struct PieceDeviations {
  std::array<std::uint64_t, 4> counts{};  ///< points, not finite, beyond the border, too far
  std::vector<double> deviation_mm;       ///< [n]
  std::vector<std::uint32_t> faces;       ///< [n], or empty
  // For files and a picture only:
  std::vector<double> points;             ///< [3 n] mm
  std::string rows;                       ///< of deviation.csv
  std::vector<PlaceSums::Entry> colours;  ///< sums of the places
  std::vector<DrawnReading> drawn;        ///< numbers within the piece

  /// As bytes: the counts and deviations, and what else there is.
  void pack(std::vector<std::byte>& bytes) const;
  /// @throws WorkError if the bytes are not of a piece
  void unpack(std::span<const std::byte> bytes);
};

/// Finds them, from blocks of points in their order.
class PieceComparison {
 public:
  /// @param about  number of the points
  PieceComparison(const PieceQuestion& question, std::size_t about);

  /// @param points   [3, m] mm, frame of the part @param closest  [m] on the part
  void add(const Eigen::Matrix3Xd& points, std::span<const SurfacePoint> closest);
  void add_not_finite(std::size_t count) { found_.counts[1] += count; }
  /// Ends the piece.
  PieceDeviations taken();

 private:
  const PieceQuestion& question_;
  PieceDeviations found_;
  PlaceSums sums_;
  DrawnReadings drawn_;
};

}  // namespace abbe
