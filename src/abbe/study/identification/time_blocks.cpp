#include "abbe/study/identification/time_blocks.h"

#include <algorithm>
#include <cmath>

#include "abbe/errors/error_states.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/identify/time_blocks.h"

namespace abbe {
namespace {

constexpr std::size_t kBlocks = 20;

}  // namespace

bool is_time_series(const Machine& machine, const ErrorSet& errors, const CampaignSetup& setup) {
  if (setup.readings.time_s.empty()) return false;
  if (setup.readings.drift != nullptr) return true;
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] != 0 && is_input(machine.states[j].kind)) return true;
  }
  return false;
}

void hold_out_blocks(const std::vector<double>& time_s, double fraction, RandomStream random,
                     std::vector<std::uint8_t>& use) {
  const TimeBlocks blocks = divide_by_time({time_s}, kBlocks, 0).front();
  const auto inner = static_cast<double>(kBlocks - 2);
  const auto count = std::clamp(std::lround(fraction * kBlocks), 1L, static_cast<long>(inner));
  std::vector<std::uint8_t> out(blocks.blocks, 0);
  const double offset = random.uniform();
  for (long i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + offset) * inner / static_cast<double>(count);
    out[1 + static_cast<std::size_t>(at)] = 1;
  }
  for (std::size_t k = 0; k < use.size(); ++k) {
    if (out[blocks.block[k]] != 0) use[k] = 0;
  }
}

void mark_noise_blocks(double block_s, const Campaign& campaign, Problem& problem) {
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    const std::vector<double>& times = campaign.setups[s].readings.time_s;
    if (times.empty()) {
      throw InputError({.file = campaign.setups[s].name, .field = "block_noise"}, "the readings have no times",
                       "a column time_s");
    }
    const double first = *std::min_element(times.begin(), times.end());
    std::vector<std::size_t>& common = problem.observations[s].common;
    common.clear();
    for (const double time : times) common.push_back(static_cast<std::size_t>((time - first) / block_s));
  }
}

}  // namespace abbe
