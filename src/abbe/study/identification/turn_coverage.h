#pragma once

// Internal to study.
#include <span>

#include "abbe/errors/basis.h"

namespace abbe {

/// True if positions stand all around a turn, without a gap in which the highest harmonic could hide.
/// @param positions  in any order, rad or mm as the period
/// @param basis      of kind fourier
bool covers_turn(std::span<const double> positions, const Basis& basis);

}  // namespace abbe
