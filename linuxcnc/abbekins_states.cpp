// SPDX-License-Identifier: GPL-2.0-or-later
#include "abbekins_states.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>

extern "C" {
#include "hal.h"
#include "rtapi.h"
}

#include "abbe/runtime/abbe_runtime_states.h"

namespace abbekins {
namespace {

/// What is visible in HAL, where errors depend on channels. Values in the units of the channels.
struct StatePins {
  hal_float_t* value[ABBE_RUNTIME_STATES];  // in, of each channel
  hal_float_t* used[ABBE_RUNTIME_STATES];   // out: what is used of it
  hal_u32_t* flags[ABBE_RUNTIME_STATES];    // out: ABBE_CHANNEL_..., 0: the value is used as it is
  hal_float_t* lag[ABBE_RUNTIME_STATES];    // out, of each lag
  hal_bit_t* ok;                            // out: no channel has a flag
  hal_float_t* behind;                      // out: how far the correction may be behind the states, um
  hal_u32_t* checksum[2];                   // out: of the compensation, upper and lower half
  hal_float_t hold_seconds, ramp_per_second, rate_um_per_second;  // parameters: abbe_runtime_policy
};

struct States {
  StatePins* pins = nullptr;
  abbe_runtime_states* states = nullptr;
  int channels = 0, lags = 0;
  abbe_runtime_policy policy{};
  long long last_time = 0;
};
States all;

int make_state_pins(int id, const abbe_runtime* runtime) {
  all.pins = static_cast<StatePins*>(hal_malloc(sizeof(StatePins)));
  if (all.pins == nullptr) return -ENOMEM;
  StatePins& pins = *all.pins;
  int failed = 0;
  for (int c = 0; c < all.channels; ++c) {
    abbe_runtime_channel channel;
    abbe_runtime_describe_channel(runtime, c, &channel);
    if (std::strlen(ABBEKINS_NAME ".state-") + std::strlen(channel.name) + std::strlen("-flags") > HAL_NAME_LEN) {
      complain("the name of a state is too long for a pin", channel.name);
      return -EINVAL;
    }
    failed |= hal_pin_float_newf(HAL_IN, &pins.value[c], id, ABBEKINS_NAME ".state-%s", channel.name);
    failed |= hal_pin_float_newf(HAL_OUT, &pins.used[c], id, ABBEKINS_NAME ".state-%s-used", channel.name);
    failed |= hal_pin_u32_newf(HAL_OUT, &pins.flags[c], id, ABBEKINS_NAME ".state-%s-flags", channel.name);
    // A pin that nothing is connected to is no temperature of 0 degrees: its channel has the flags of a dead one.
    if (failed == 0) *pins.value[c] = std::numeric_limits<double>::quiet_NaN();
  }
  for (int k = 0; k < all.lags; ++k) {
    abbe_runtime_lag lag;
    abbe_runtime_describe_lag(runtime, k, &lag);
    failed |= hal_pin_float_newf(HAL_OUT, &pins.lag[k], id, ABBEKINS_NAME ".lag-%s", lag.name);
  }
  failed |= hal_pin_bit_newf(HAL_OUT, &pins.ok, id, ABBEKINS_NAME ".states-ok");
  failed |= hal_pin_float_newf(HAL_OUT, &pins.behind, id, ABBEKINS_NAME ".states-behind-um");
  failed |= hal_pin_u32_newf(HAL_OUT, &pins.checksum[0], id, ABBEKINS_NAME ".checksum-high");
  failed |= hal_pin_u32_newf(HAL_OUT, &pins.checksum[1], id, ABBEKINS_NAME ".checksum-low");
  failed |= hal_param_float_newf(HAL_RW, &pins.hold_seconds, id, ABBEKINS_NAME ".states-hold-seconds");
  failed |= hal_param_float_newf(HAL_RW, &pins.ramp_per_second, id, ABBEKINS_NAME ".states-ramp-per-second");
  failed |= hal_param_float_newf(HAL_RW, &pins.rate_um_per_second, id, ABBEKINS_NAME ".states-rate-um-per-second");
  if (failed != 0) return -ENOMEM;
  abbe_runtime_default_policy(&all.policy);
  pins.hold_seconds = all.policy.hold_s;
  pins.ramp_per_second = all.policy.ramp_per_s;
  pins.rate_um_per_second = 1e3 * all.policy.rate_mm_per_s;
  abbe_runtime_information about;
  abbe_runtime_describe(runtime, &about);
  *pins.checksum[0] = static_cast<unsigned>(about.checksum >> 32U);
  *pins.checksum[1] = static_cast<unsigned>(about.checksum & 0xffffffffU);
  return 0;
}

/// Lags as they were before LinuxCNC was ended. Without them it starts as well.
void take_up(const char* path, int hours) {
  size_t size = 0;
  unsigned char* const text = read_file(path, size);
  if (text == nullptr) {
    rtapi_print_msg(RTAPI_MSG_WARN, ABBEKINS_NAME ": no stored states, lags start in equilibrium: %s\n", path);
    return;
  }
  timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  const double unix_s = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  const int result =
      abbe_runtime_states_restore_text(all.states, reinterpret_cast<const char*>(text), size, unix_s, 3600.0 * hours);
  std::free(text);
  if (result == ABBE_OK) {
    rtapi_print_msg(RTAPI_MSG_INFO, ABBEKINS_NAME ": stored states taken up: %s\n", path);
    return;
  }
  const char* why = "damaged";
  if (result == ABBE_STALE) why = "too old, or from the future";
  if (result == ABBE_FILE_FOREIGN) why = "of another compensation, or no states";
  if (result == ABBE_FILE_SHORT) why = "truncated";
  rtapi_print_msg(RTAPI_MSG_ERR, ABBEKINS_NAME ": stored states refused (%s), lags start in equilibrium: %s\n", why,
                  path);
}

/// Parameters that cannot be used leave the policy as it was.
void follow_parameters() {
  StatePins& pins = *all.pins;
  abbe_runtime_policy wanted = all.policy;
  wanted.hold_s = pins.hold_seconds;
  wanted.ramp_per_s = pins.ramp_per_second;
  wanted.rate_mm_per_s = 1e-3 * pins.rate_um_per_second;
  if (abbe_runtime_states_set_policy(all.states, &wanted) == ABBE_OK) all.policy = wanted;
}

}  // namespace

int make_states(int component, const abbe_runtime* runtime, const char* stored, int hours) {
  all.channels = abbe_runtime_channels(runtime);
  all.lags = abbe_runtime_lags(runtime);
  if (all.channels == 0) return 0;
  const int result = make_state_pins(component, runtime);
  if (result != 0) return result;
  if (abbe_runtime_states_make(runtime, &all.policy, &all.states) != ABBE_OK) return -ENOMEM;
  all.last_time = rtapi_get_time();
  if (stored[0] != 0) take_up(stored, hours);
  return 0;
}

void advance_states() {
  if (all.states == nullptr) return;
  StatePins& pins = *all.pins;
  // Before homing LinuxCNC does not call; lags take such a pause as one step, exactly.
  const long long now = rtapi_get_time();
  double passed = 1e-9 * static_cast<double>(now - all.last_time);
  if (!(passed >= 0)) passed = 0;
  all.last_time = now;
  follow_parameters();
  double values[ABBE_RUNTIME_STATES], lags[ABBE_RUNTIME_STATES], behind = 0;
  int flags[ABBE_RUNTIME_STATES];
  for (int c = 0; c < all.channels; ++c) values[c] = *pins.value[c];
  abbe_runtime_states_advance(all.states, values, passed);
  abbe_runtime_states_get(all.states, values, lags, flags, &behind);
  bool ok = true;
  for (int c = 0; c < all.channels; ++c) {
    *pins.used[c] = values[c];
    *pins.flags[c] = static_cast<unsigned>(flags[c]);
    ok = ok && flags[c] == 0;
  }
  for (int k = 0; k < all.lags; ++k) *pins.lag[k] = lags[k];
  *pins.ok = ok;
  *pins.behind = 1e3 * behind;
}

const abbe_runtime* at_states(const abbe_runtime* runtime) {
  return all.states == nullptr ? runtime : abbe_runtime_at_states(all.states);
}

void free_states() {
  abbe_runtime_states_free(all.states);
  all.states = nullptr;
}

}  // namespace abbekins
