#pragma once

#include <cstdint>
#include <vector>

#include "abbe/instruments/observations.h"

namespace abbe {

/// Working memory of one thread, grown once and kept.
struct TrackerScratch {
  static constexpr std::size_t kBlock = Observations::kBlockSize;
  std::vector<double> positions;  ///< [axes][kBlock]
  std::vector<const double*> axis;
  std::vector<double> states;  ///< [states that are given][kBlock]
  std::vector<const double*> state;
  std::vector<double> jacobian;     ///< compact columns of one pair of bodies
  std::vector<double> by_position;  ///< [axes][3][members]
  double start[3][kBlock], seen[3][kBlock], unmoved[3][kBlock], gathered[3][kBlock], trig[4][kBlock], weight[6][kBlock];
  double residual[3][kBlock], force[3][3][kBlock], by_start[3][3][kBlock];
  std::uint16_t station[kBlock], reflector[kBlock];
};

}  // namespace abbe
