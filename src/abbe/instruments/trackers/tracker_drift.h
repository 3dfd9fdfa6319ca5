#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "abbe/instruments/observations.h"
#include "abbe/instruments/setup_drift.h"

namespace abbe {

/// Columns of the Jacobian that belong to unknowns of a set-up.
struct DriftColumns {
  std::span<const std::size_t> unknowns;  ///< wanted ones
  std::size_t first = 0;                  ///< those before belong to the instrument
  double* target = nullptr;               ///< target[column * stride + row * members + k]
  std::size_t stride = 0;
};

/// Reflectors as stations see them that have moved.
/// @param at       readings of a block, from `first` on
/// @param seen     in and out, mm
/// @param unmoved  out: as they were
void move_reflectors(const ReadingDrift& drift, std::size_t first, std::span<const std::uint16_t> at,
                     double (*seen)[Observations::kBlockSize], double (*unmoved)[Observations::kBlockSize]);

/// Fills the columns of the drift, and turns forces back into the frame of the body.
/// @param seen   by the moved station
/// @param force  [row][direction], in and out
void take_tracker_drift(const ReadingDrift& drift, std::size_t first, std::span<const std::uint16_t> at,
                        const double (*seen)[Observations::kBlockSize], const DriftColumns& columns,
                        double (*force)[3][Observations::kBlockSize]);

}  // namespace abbe
