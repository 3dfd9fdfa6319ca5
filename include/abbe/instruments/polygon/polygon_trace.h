#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/instruments/polygon/polygon.h"

namespace abbe {

/// Positions of the table, structure of arrays; every pointer to [count] values.
struct PolygonPositions {
  std::size_t count = 0;
  const double* angle = nullptr;          ///< commanded, rad
  std::array<const double*, 6> motion{};  ///< eps_x, eps_y, eps_z (rad), delta_x, delta_y, delta_z (mm); null: zero
  const std::uint16_t* face_x = nullptr;  ///< face seen along x
  const std::uint16_t* face_y = nullptr;  ///< face seen along y
};

/// Where the readings go, in the order of PolygonReading; null pointers are skipped.
using PolygonTraces = std::array<double*, kPolygonReadings>;

/// The same readings as polygon_reading(), for many positions at once: millions per second.
///
/// Prism, mount and instruments are compiled once. Positions are taken in blocks as structure of arrays, so that the
/// compiler works on several at a time; a result does not depend on the positions traced with it.
class PolygonTrace {
 public:
  /// @throws std::invalid_argument as validate()
  PolygonTrace(const Polygon& polygon, const PolygonMount& mount, const PolygonBench& bench);
  /// NaN where a beam does not meet its face. Face indices must be valid. Thread-safe, allocates nothing.
  void trace(const PolygonPositions& positions, const PolygonTraces& traces) const;

 private:
  static constexpr std::size_t kBlock = 128;
  struct Block;
  struct Plane {
    double normal[3], offset;  ///< in the table frame
  };
  struct Sensor {
    double axes[3][3];  ///< of the sensor in the world
    double start[3];    ///< where the beam leaves, world, mm
    double origin = 0;  ///< coordinate of the exit along the beam, mm
  };
  void trace_block(const PolygonPositions& positions, std::size_t first, std::size_t count,
                   const PolygonTraces& traces) const;

  std::vector<Plane> faces_x_, faces_y_;  ///< as seen along x and along y (they differ in the paper's order)
  Plane top_{};
  std::array<Sensor, 5> sensors_{};
};

}  // namespace abbe
