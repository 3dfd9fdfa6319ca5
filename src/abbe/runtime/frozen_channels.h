#pragma once

#include <array>
#include <cstddef>

#include "abbe/runtime/frozen_states.h"

namespace abbe {

/// A channel as it is used: docs/runtime.md, "A sensor that fails".
struct FrozenChannel {
  bool started = false;  ///< a value has come
  bool follows = true;   ///< the values, not a ramp
  double used = 0;       ///< in its unit
  double held = 0;       ///< the last value or limit
  double bad_s = 0;      ///< since the last good value, s
  int flags = ABBE_CHANNEL_DEAD | ABBE_CHANNEL_AT_REFERENCE;
  bool restored = false;  ///< there is a value from before a pause
  double then = 0;        ///< this value
  double since = 0;       ///< s since it was used
};

struct FrozenLag {
  bool started = false;
  double value = 0;
  double then = 0;  ///< before a pause
};

}  // namespace abbe

/// Everything behind the handle of abbe_runtime_states.h.
struct abbe_runtime_states {
  const abbe_runtime* read = nullptr;
  abbe_runtime live;  ///< the machine at the present states
  abbe::FrozenPosed posed;
  abbe::FrozenGroup* group = nullptr;  ///< of `live`; null where no error depends on a channel
  abbe_runtime_policy policy{};
  std::array<abbe::FrozenChannel, abbe::kFrozenStates> channel;
  std::array<abbe::FrozenLag, abbe::kFrozenStates> lag;
  std::array<double, abbe::kFrozenStates> factor{};  ///< as they have been put in
  double behind = 0;                                 ///< mm, from there to the present states
};
