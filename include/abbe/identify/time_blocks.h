#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace abbe {

/// Readings of one set of observations by time: the parts that are held out, each without a break.
struct TimeBlocks {
  std::vector<std::size_t> block;  ///< [readings] its block, from 0 over all sets of observations
  std::vector<std::uint8_t> near;  ///< [readings * blocks] reading * blocks + block: too near to take part in its fit
  std::size_t blocks = 0;          ///< of all sets of observations together
};

/// Divides readings by time into blocks with about as many readings each; readings of one time stay together.
/// @param time_s   per set of observations, [readings]
/// @param blocks   wanted in all; every set has at least two
/// @param gap_s    readings nearer than this to a block take no part in the fit without it
/// @returns per set of observations
std::vector<TimeBlocks> divide_by_time(const std::vector<std::vector<double>>& time_s, std::size_t blocks,
                                       double gap_s);

}  // namespace abbe
