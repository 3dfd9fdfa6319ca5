#include "abbe/compensate/axis_directions.h"

#include <algorithm>

namespace abbe {

AxisDirections::AxisDirections(const std::vector<double>& dead_bands) {
  for (const double band : dead_bands) state_.push_back({.dead_band = band});
}

void AxisDirections::stand(std::size_t i, double position) {
  State& state = state_[i];
  state.lowest = state.highest = position;
  state.direction = 0;
  state.seen = true;
}

void AxisDirections::move(std::size_t i, double position) {
  State& state = state_[i];
  if (!state.seen) stand(i, position);
  const std::int8_t before = state.direction;
  if (before <= 0 && position > state.lowest + state.dead_band) state.direction = 1;
  if (before >= 0 && position < state.highest - state.dead_band) state.direction = -1;
  if (state.direction != before) {
    state.lowest = state.highest = position;
    return;
  }
  state.lowest = std::min(state.lowest, position);
  state.highest = std::max(state.highest, position);
}

}  // namespace abbe
