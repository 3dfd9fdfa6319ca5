#pragma once

// Internal to study: whether measured points are in a right-handed or in a left-handed frame.
#include <algorithm>
#include <cstddef>

#include "abbe/formats/readings/measurement_file.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// How well readings fit the nominal machine; root mean square distances, mm. Both are zero where nothing is known.
struct FrameSense {
  double right_mm = 0;       ///< points as they are
  double left_mm = 0;        ///< with y reversed
  double extent_mm = 0;      ///< of the points, from their mean
  std::size_t readings = 0;  ///< that were used

  /// One of them fits ten times as well as the other.
  bool is_right() const { return 10 * right_mm < left_mm; }
  bool is_left() const { return 10 * left_mm < right_mm; }
  /// One of them is so good that commands and points must be what they are taken for, in their order and their units.
  /// Pose and offset of a reflector are nine unknowns, and a few readings may fit by chance.
  bool is_proof() const {
    return readings >= 6 && (is_right() || is_left()) && 200 * std::min(right_mm, left_mm) < extent_mm;
  }
};

/// Fits the points of the first station to where the nominal machine carries the tool, seen from the bed or from the
/// workpiece, as they are and mirrored. The offsets of the reflectors are unknowns. Points in one plane fit equally
/// well both ways.
FrameSense frame_sense(const Machine& machine, const MeasurementTable& table);

}  // namespace abbe
