#pragma once

// Internal to study: readings of a campaign whose poses are read again and again, cycle by cycle.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/machine/machine.h"
#include "abbe/study/campaign.h"

namespace abbe {

/// How the readings of a test are divided into cycles. 0: not stated.
struct CycleChoice {
  double length = 0;  ///< s: cycles of this length, from the first reading on
  double pause = 0;   ///< s: a longer time without a reading begins a cycle; without both it is found from the times
};

/// Where a reading stands, and when it was taken.
struct TimedReading {
  double time = 0;
  std::size_t setup = 0, reading = 0;
};

/// Readings of the whole campaign, sorted by time, and where cycles begin.
struct CycleReadings {
  std::vector<TimedReading> all;
  std::vector<std::size_t> starts;  ///< [cycles + 1]

  std::size_t count(std::size_t cycle) const { return starts[cycle + 1] - starts[cycle]; }
  /// Median of the counts of all cycles.
  std::size_t usual_count() const;
  /// [setups][readings] of a cycle.
  std::vector<std::vector<std::size_t>> of_cycle(std::size_t cycle, std::size_t setups) const;
};

/// Cycles of sorted times: the index of the first time of each, from 0.
///
/// Without a statement the shortest pause counts that is at least three times as long as the next shorter time between
/// two readings, and after which four of five cycles begin at the pose of the first one.
/// @param at_first  [times] whether the reading is at the pose of the first one
/// @param pause     becomes the time that begins a cycle; 0 with a length, or if there is none
std::vector<std::size_t> cycle_starts(const std::vector<double>& times, const std::vector<std::uint8_t>& at_first,
                                      const CycleChoice& choice, double& pause);

/// @param pause  becomes what begins a cycle, as cycle_starts() says
/// @throws InputError for readings without times, a set-up that drifts, and times that show no cycles
CycleReadings divide_into_cycles(const Machine& machine, const Campaign& campaign, const CycleChoice& choice,
                                 const std::string& file, double& pause);

}  // namespace abbe
