#include "abbe/study/evaluations/cycle_readings.h"

#include <algorithm>
#include <cmath>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

/// A pause between cycles is so many times as long as all shorter times between readings.
constexpr double kClearPause = 3;
/// Share of the cycles that begin where the first one does.
constexpr double kSameBeginning = 0.8;
/// Commands that differ by less are the same pose, mm and rad.
constexpr double kSamePlace = 0.01, kSameAngle = 1e-4;
std::vector<TimedReading> readings_in_time(const Campaign& campaign, const std::string& file) {
  std::vector<TimedReading> all;
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    const CampaignSetup& setup = campaign.setups[s];
    if (setup.shards) {
      throw InputError({.file = file, .field = "identify.readings_in_memory"},
                       "cycles need all readings of " + setup.name + " in memory", "no such key, or a larger number");
    }
    if (setup.readings.time_s.empty()) {
      throw InputError({.file = file, .field = setup.name}, "the readings have no times", "a column time_s");
    }
    if (setup.drift) {
      throw InputError({.file = file, .field = setup.name + ".drift"},
                       "a set-up that drifts: open quantities of a set-up are found again in every cycle",
                       "a study without drift");
    }
    for (std::size_t k = 0; k < setup.reading_count(); ++k) all.push_back({setup.readings.time_s[k], s, k});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const TimedReading& one, const TimedReading& other) { return one.time < other.time; });
  return all;
}

/// Per reading: whether it is at the pose of the first one.
std::vector<std::uint8_t> at_first_pose(const Machine& machine, const Campaign& campaign,
                                        const std::vector<TimedReading>& readings) {
  const auto commands = [&](const TimedReading& reading, std::size_t axis) {
    return campaign.setups[reading.setup].poses().axis[axis][reading.reading];
  };
  std::vector<std::uint8_t> same;
  for (const TimedReading& reading : readings) {
    bool is_same = reading.setup == readings.front().setup;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const double most = machine.axes[i].kind == AxisKind::rotary ? kSameAngle : kSamePlace;
      is_same = is_same && std::abs(commands(reading, i) - commands(readings.front(), i)) < most;
    }
    same.push_back(is_same ? 1 : 0);
  }
  return same;
}

std::vector<std::size_t> starts_after_pauses(const std::vector<double>& times, double pause) {
  std::vector<std::size_t> starts = {0};
  for (std::size_t k = 1; k < times.size(); ++k) {
    if (times[k] - times[k - 1] > pause) starts.push_back(k);
  }
  return starts;
}

/// The shortest pause that stands out and after which nearly all cycles begin at the same pose; 0: there is none.
double clear_pause(const std::vector<double>& times, const std::vector<std::uint8_t>& at_first) {
  std::vector<double> gaps;
  for (std::size_t k = 1; k < times.size(); ++k) {
    if (times[k] > times[k - 1]) gaps.push_back(times[k] - times[k - 1]);
  }
  std::sort(gaps.begin(), gaps.end());
  for (std::size_t k = 1; k < gaps.size(); ++k) {
    if (gaps[k] < kClearPause * gaps[k - 1]) continue;
    const double pause = std::sqrt(gaps[k] * gaps[k - 1]);
    const std::vector<std::size_t> starts = starts_after_pauses(times, pause);
    const auto same = std::count_if(starts.begin(), starts.end(), [&](std::size_t at) { return at_first[at] != 0; });
    if (static_cast<double>(same) >= kSameBeginning * static_cast<double>(starts.size())) return pause;
  }
  return 0;
}

}  // namespace

std::size_t CycleReadings::usual_count() const {
  std::vector<std::size_t> counts;
  for (std::size_t c = 0; c + 1 < starts.size(); ++c) counts.push_back(count(c));
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), middle, counts.end());
  return *middle;
}

std::vector<std::vector<std::size_t>> CycleReadings::of_cycle(std::size_t cycle, std::size_t setups) const {
  std::vector<std::vector<std::size_t>> readings(setups);
  for (std::size_t k = starts[cycle]; k < starts[cycle + 1]; ++k) readings[all[k].setup].push_back(all[k].reading);
  return readings;
}

std::vector<std::size_t> cycle_starts(const std::vector<double>& times, const std::vector<std::uint8_t>& at_first,
                                      const CycleChoice& choice, double& pause) {
  pause = 0;
  if (choice.length == 0) {
    pause = choice.pause > 0 ? choice.pause : clear_pause(times, at_first);
    return pause > 0 ? starts_after_pauses(times, pause) : std::vector<std::size_t>{0};
  }
  std::vector<std::size_t> starts = {0};
  const auto number = [&](std::size_t k) { return std::floor((times[k] - times.front()) / choice.length + 1e-9); };
  for (std::size_t k = 1; k < times.size(); ++k) {
    if (number(k) > number(k - 1)) starts.push_back(k);
  }
  return starts;
}

CycleReadings divide_into_cycles(const Machine& machine, const Campaign& campaign, const CycleChoice& choice,
                                 const std::string& file, double& pause) {
  CycleReadings cycles{readings_in_time(campaign, file), {}};
  std::vector<double> times;
  for (const TimedReading& reading : cycles.all) times.push_back(reading.time);
  cycles.starts = cycle_starts(times, at_first_pose(machine, campaign, cycles.all), choice, pause);
  if (cycles.starts.size() < 2) {
    throw InputError({.file = file}, "the times of the readings show no cycles",
                     "--cycle-min, the time from one cycle to the next, or --pause-min, the time without a reading "
                     "that begins one");
  }
  cycles.starts.push_back(times.size());
  return cycles;
}

}  // namespace abbe
