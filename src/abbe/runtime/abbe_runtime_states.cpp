#include "abbe/runtime/abbe_runtime_states.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "abbe/runtime/frozen_channels.h"
#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_values.h"

namespace abbe {
namespace {

constexpr const char* kChannelUnits[] = {"degC", "K", "Nm", "N", "kg", "rpm", "s", "1"};
constexpr double kLongestTime = 1e9;  // s
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

bool is_value(double value) { return std::abs(value) <= frozen::kLongest; }
bool is_time(double seconds) { return seconds >= 0 && seconds <= kLongestTime; }

/// tau dy/dt + y = u from one time to another, u linear in between; exact, as lagged() of state.h.
double lag_after(double before, double input_before, double input, double seconds, double time_constant) {
  if (!(seconds > 0)) return before;
  const double ratio = seconds / time_constant;
  const double gone = -std::expm1(-ratio);
  return before + gone * (input_before - before) + (input - input_before) * (1 - gone / ratio);
}

const FrozenState& channel_state(const FrozenStates& s, std::size_t c) { return s.state[s.channel[c]]; }

double toward(double from, double to, double step) {
  return std::abs(to - from) <= step ? to : from + (to > from ? step : -step);
}

/// The value that is used of a channel, after `seconds`; `counted` of them for a ramp.
void follow(const FrozenState& state, const abbe_runtime_policy& policy, double value, double seconds, double counted,
            FrozenChannel& channel) {
  const bool finite = is_value(value);
  const bool good = finite && value >= state.from && value <= state.to;
  channel.since = std::min(channel.since + seconds, kLongestTime);
  if (finite) channel.held = std::clamp(value, state.from, state.to);
  if (!channel.started && !finite) return;
  if (!channel.started) channel.used = channel.held;
  channel.started = true;
  channel.bad_s = good ? 0 : std::min(channel.bad_s + seconds, kLongestTime);
  const bool given_up = !good && channel.bad_s > policy.hold_s;
  if (given_up) channel.follows = false;
  const double target = given_up ? state.reference : channel.held;
  const double step = policy.ramp_per_s * (state.to - state.from) * counted;
  channel.used = channel.follows ? target : toward(channel.used, target, step);
  const bool there = channel.used == target;
  if (good && there) channel.follows = true;
  channel.flags = 0;
  if (!good) channel.flags |= finite ? ABBE_CHANNEL_OUT_OF_RANGE : ABBE_CHANNEL_DEAD;
  if (!good && !given_up) channel.flags |= ABBE_CHANNEL_HELD;
  if (!channel.follows && !there) channel.flags |= ABBE_CHANNEL_RAMPING;
  if (given_up && there) channel.flags |= ABBE_CHANNEL_AT_REFERENCE;
}

/// Lags of a channel that was at `before` and is at `channel.used`.
void follow_lags(abbe_runtime_states& states, std::size_t c, bool was_started, double before, double seconds) {
  const FrozenStates& s = *states.read->states;
  const FrozenChannel& channel = states.channel[c];
  if (!channel.started) return;
  for (std::size_t k = 0; k < s.lags; ++k) {
    const FrozenState& state = s.state[s.lag[k]];
    FrozenLag& lag = states.lag[k];
    if (state.of != s.channel[c]) continue;
    if (was_started) {
      lag.value = lag_after(lag.value, before, channel.used, seconds, state.time_constant);
    } else if (channel.restored) {
      lag.value = lag_after(lag.then, channel.then, channel.used, channel.since, state.time_constant);
    } else {
      lag.value = channel.used;
    }
    lag.started = true;
  }
}

/// Factors at the present channels and lags, [factors].
void present_factors(const abbe_runtime_states& states, double* factors) {
  const FrozenStates& s = *states.read->states;
  const auto departure = [&](std::size_t place) {
    const FrozenState& state = s.state[place];
    if (state.kind == FrozenState::Kind::measured) {
      const FrozenChannel& channel = states.channel[state.place];
      return channel.started ? channel.used - state.reference : 0.0;
    }
    const FrozenLag& lag = states.lag[state.place];
    return lag.started ? lag.value - state.reference : 0.0;
  };
  for (std::size_t j = 0; j < s.factors; ++j) {
    factors[j] = departure(s.factor[j].first);
    if (s.factor[j].second != kNoFactor) factors[j] *= departure(s.factor[j].second);
  }
}

/// Moves the factors that are put in towards the present ones; `most` mm of the tool point at most.
void move_factors(abbe_runtime_states& states, double most) {
  const FrozenStates& s = *states.read->states;
  double target[kFrozenStates];
  present_factors(states, target);
  bool same = true;
  double way = 0;
  for (std::size_t j = 0; j < s.factors; ++j) {
    same = same && target[j] == states.factor[j];
    way += s.factor[j].largest * std::abs(target[j] - states.factor[j]);
  }
  states.behind = std::max(0.0, way - most);
  if (same || (way > most && !(most > 0))) return;
  for (std::size_t j = 0; j < s.factors; ++j) {
    states.factor[j] = way <= most ? target[j] : states.factor[j] + most / way * (target[j] - states.factor[j]);
  }
  put_in(*states.read, s, states.factor.data(), states.group, states.posed, states.live);
}

bool is_policy(const abbe_runtime_policy& policy) {
  const auto is_rate = [](double rate) { return rate > 0 && rate <= kLongestTime; };
  return is_time(policy.hold_s) && is_rate(policy.ramp_per_s) && is_rate(policy.rate_mm_per_s) &&
         is_rate(policy.longest_pause_s);
}

/// The machine that the calls use, with room of its own for what states change.
void make_live(const abbe_runtime& read, abbe_runtime_states& states, double* room) {
  states.read = &read;
  states.live = read;
  if (read.states == nullptr) return;
  const FrozenStates& s = *read.states;
  if (!read.needs_states) return;
  std::copy_n(read.group, s.groups, states.group);
  for (std::size_t b = 0; b < s.blocks; ++b) {
    const std::size_t g = s.block[b].group;
    if (b > 0 && s.block[b - 1].group == g) continue;
    states.group[g].coefficients = room;
    room += 6 * group_rows(states.group[g]);
  }
  states.posed = s.posed;
  states.posed.group = states.group;
  states.live.group = states.group;
  if (read.posed != nullptr) states.live.posed = &states.posed;
  states.live.needs_states = false;
  put_in(read, s, states.factor.data(), states.group, states.posed, states.live);
}

std::size_t coefficients_of(const FrozenStates& s, const FrozenGroup* group) {
  std::size_t count = 0;
  for (std::size_t b = 0; b < s.blocks; ++b) {
    if (b == 0 || s.block[b - 1].group != s.block[b].group) count += 6 * group_rows(group[s.block[b].group]);
  }
  return count;
}

}  // namespace

extern "C" {

int abbe_runtime_channels(const abbe_runtime* runtime) ABBE_NOEXCEPT {
  return runtime == nullptr || runtime->states == nullptr ? 0 : static_cast<int>(runtime->states->channels);
}

int abbe_runtime_lags(const abbe_runtime* runtime) ABBE_NOEXCEPT {
  return runtime == nullptr || runtime->states == nullptr ? 0 : static_cast<int>(runtime->states->lags);
}

int abbe_runtime_describe_channel(const abbe_runtime* runtime, int channel,
                                  abbe_runtime_channel* description) ABBE_NOEXCEPT {
  if (description == nullptr || channel < 0 || channel >= abbe_runtime_channels(runtime)) return ABBE_NULL;
  const FrozenState& state = channel_state(*runtime->states, static_cast<std::size_t>(channel));
  *description = {};
  std::memcpy(description->name, state.name, frozen::kStateName);
  std::strcpy(description->unit, kChannelUnits[state.unit]);
  description->reference = state.reference;
  description->range_min = state.from;
  description->range_max = state.to;
  return ABBE_OK;
}

int abbe_runtime_describe_lag(const abbe_runtime* runtime, int lag, abbe_runtime_lag* description) ABBE_NOEXCEPT {
  if (description == nullptr || lag < 0 || lag >= abbe_runtime_lags(runtime)) return ABBE_NULL;
  const FrozenStates& s = *runtime->states;
  const FrozenState& state = s.state[s.lag[static_cast<std::size_t>(lag)]];
  *description = {};
  std::memcpy(description->name, state.name, frozen::kStateName);
  description->channel = static_cast<int>(s.state[state.of].place);
  description->time_constant_s = state.time_constant;
  return ABBE_OK;
}

void abbe_runtime_default_policy(abbe_runtime_policy* policy) ABBE_NOEXCEPT {
  if (policy != nullptr) *policy = {10, 0.01, 0.01, 0.005};
}

int abbe_runtime_states_make(const abbe_runtime* runtime, const abbe_runtime_policy* policy,
                             abbe_runtime_states** states) ABBE_NOEXCEPT {
  if (states == nullptr) return ABBE_NULL;
  *states = nullptr;
  if (runtime == nullptr) return ABBE_NULL;
  abbe_runtime_policy wanted;
  abbe_runtime_default_policy(&wanted);
  if (policy != nullptr) wanted = *policy;
  if (!is_policy(wanted)) return ABBE_NOT_FINITE;
  const bool changes = runtime->needs_states;
  const std::size_t groups = changes ? runtime->states->groups : 0;
  constexpr std::size_t kGroupsAt = (sizeof(abbe_runtime_states) + 63) / 64 * 64;
  const std::size_t room_at = kGroupsAt + (groups * sizeof(FrozenGroup) + 63) / 64 * 64;
  const std::size_t room = changes ? coefficients_of(*runtime->states, runtime->group) : 0;
  void* const memory = std::malloc(room_at + 8 * (room + 1));
  if (memory == nullptr) return ABBE_FILE_NO_MEMORY;
  auto* const bytes = static_cast<unsigned char*>(memory);
  abbe_runtime_states& made = *new (memory) abbe_runtime_states;
  made.policy = wanted;
  if (changes) {
    made.group = reinterpret_cast<FrozenGroup*>(bytes + kGroupsAt);
    for (std::size_t g = 0; g < groups; ++g) new (made.group + g) FrozenGroup;
  }
  make_live(*runtime, made, reinterpret_cast<double*>(bytes + room_at));
  for (int c = 0; c < abbe_runtime_channels(runtime); ++c) {
    const auto place = static_cast<std::size_t>(c);
    made.channel[place].used = made.channel[place].held = channel_state(*runtime->states, place).reference;
  }
  *states = &made;
  return ABBE_OK;
}

void abbe_runtime_states_free(abbe_runtime_states* states) ABBE_NOEXCEPT { std::free(states); }

int abbe_runtime_states_set_policy(abbe_runtime_states* states, const abbe_runtime_policy* policy) ABBE_NOEXCEPT {
  if (states == nullptr || policy == nullptr) return ABBE_NULL;
  if (!is_policy(*policy)) return ABBE_NOT_FINITE;
  states->policy = *policy;
  return ABBE_OK;
}

const abbe_runtime* abbe_runtime_at_states(const abbe_runtime_states* states) ABBE_NOEXCEPT {
  return states == nullptr ? nullptr : &states->live;
}

int abbe_runtime_states_advance(abbe_runtime_states* states, const double* channels, double seconds) ABBE_NOEXCEPT {
  if (states == nullptr || channels == nullptr) return ABBE_NULL;
  if (!is_time(seconds)) return ABBE_NOT_FINITE;
  if (states->read->states == nullptr) return ABBE_OK;
  const FrozenStates& s = *states->read->states;
  const double counted = std::min(seconds, states->policy.longest_pause_s);
  for (std::size_t c = 0; c < s.channels; ++c) {
    FrozenChannel& channel = states->channel[c];
    const bool was_started = channel.started;
    const double before = channel.used;
    follow(channel_state(s, c), states->policy, channels[c], seconds, counted, channel);
    follow_lags(*states, c, was_started, before, seconds);
  }
  move_factors(*states, states->policy.rate_mm_per_s * counted);
  return ABBE_OK;
}

int abbe_runtime_states_set(abbe_runtime_states* states, const double* channels, const double* lags) ABBE_NOEXCEPT {
  if (states == nullptr || channels == nullptr) return ABBE_NULL;
  if (states->read->states == nullptr) return ABBE_OK;
  const FrozenStates& s = *states->read->states;
  for (std::size_t c = 0; c < s.channels; ++c) {
    if (!is_value(channels[c])) return ABBE_NOT_FINITE;
  }
  for (std::size_t k = 0; lags != nullptr && k < s.lags; ++k) {
    if (!is_value(lags[k])) return ABBE_NOT_FINITE;
  }
  for (std::size_t c = 0; c < s.channels; ++c) {
    FrozenChannel& channel = states->channel[c];
    channel = {};
    channel.started = true;
    channel.used = channel.held = channels[c];
    channel.flags = 0;
  }
  for (std::size_t k = 0; k < s.lags; ++k) {
    const std::size_t of = s.state[s.state[s.lag[k]].of].place;
    states->lag[k] = {true, lags != nullptr ? lags[k] : channels[of], 0};
  }
  move_factors(*states, std::numeric_limits<double>::infinity());
  return ABBE_OK;
}

int abbe_runtime_states_get(const abbe_runtime_states* states, double* channels, double* lags, int* flags,
                            double* behind_mm) ABBE_NOEXCEPT {
  if (states == nullptr) return ABBE_NULL;
  const auto c_count = static_cast<std::size_t>(abbe_runtime_channels(states->read));
  const auto l_count = static_cast<std::size_t>(abbe_runtime_lags(states->read));
  for (std::size_t c = 0; c < c_count; ++c) {
    const FrozenChannel& channel = states->channel[c];
    if (channels != nullptr) channels[c] = channel.started ? channel.used : kUnknown;
    if (flags != nullptr) flags[c] = channel.flags;
  }
  for (std::size_t k = 0; lags != nullptr && k < l_count; ++k) {
    lags[k] = states->lag[k].started ? states->lag[k].value : kUnknown;
  }
  if (behind_mm != nullptr) *behind_mm = states->behind;
  return ABBE_OK;
}

int abbe_runtime_states_restore(abbe_runtime_states* states, const double* channels, const double* lags,
                                double seconds) ABBE_NOEXCEPT {
  if (states == nullptr || channels == nullptr || lags == nullptr) return ABBE_NULL;
  const auto c_count = static_cast<std::size_t>(abbe_runtime_channels(states->read));
  const auto l_count = static_cast<std::size_t>(abbe_runtime_lags(states->read));
  if (!is_time(seconds) || !std::all_of(channels, channels + c_count, is_value) ||
      !std::all_of(lags, lags + l_count, is_value)) {
    return ABBE_NOT_FINITE;
  }
  for (std::size_t c = 0; c < c_count; ++c) {
    states->channel[c].restored = true;
    states->channel[c].then = channels[c];
    states->channel[c].since = seconds;
  }
  for (std::size_t k = 0; k < l_count; ++k) states->lag[k].then = lags[k];
  return ABBE_OK;
}

}  // extern "C"

}  // namespace abbe
