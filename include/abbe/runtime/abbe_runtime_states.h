#pragma once

/* Compensation that depends on states: channels of a controller such as temperatures and loads, C99 and later. To be
 * used with abbe_runtime.h; docs/runtime.md derives the policy.
 *
 *   abbe_runtime_states* states;
 *   abbe_runtime_states_make(runtime, NULL, &states);            // once, after abbe_runtime_load(); allocates
 *   ...
 *   abbe_runtime_states_advance(states, channels, 0.001);        // every servo cycle
 *   abbe_runtime_correct(abbe_runtime_at_states(states), &state, nominal, NULL, 1, joints);
 *
 * Channels are in the order of the file, in their units (degC, Nm, ...). Lags are computed from them. Except
 * abbe_runtime_states_make() and _free(), no call allocates, locks, touches files or throws. One object belongs to one
 * thread at a time; objects of one runtime do not share anything that changes.
 */

#include "abbe/runtime/abbe_runtime.h"

/* The names and types of C. NOLINTBEGIN(modernize-*,readability-identifier-naming) */
#ifdef __cplusplus
extern "C" {
#endif

enum { ABBE_RUNTIME_STATES = 16 /**< no file has more channels and lags */ };

/** Flags of a channel; 0: the value is used as it is. */
enum {
  ABBE_CHANNEL_HELD = 1,         /**< the limit, or the last good value, is used instead of the value */
  ABBE_CHANNEL_RAMPING = 2,      /**< on the way to the reference, or back from it */
  ABBE_CHANNEL_AT_REFERENCE = 4, /**< the reference is used: what depends on the channel is not compensated */
  ABBE_CHANNEL_OUT_OF_RANGE = 8, /**< the value is a number outside the range of the file */
  ABBE_CHANNEL_DEAD = 16         /**< the value is no number, or larger than 1e6 */
};

typedef struct abbe_runtime_channel {
  char name[ABBE_RUNTIME_TEXT]; /**< "ambient" */
  char unit[8];                 /**< "degC", "K", "Nm", "N", "kg", "rpm", "s"; "1": a pure number */
  double reference;             /**< value at which nothing depends on it, in its unit */
  double range_min;             /**< the errors were identified from here */
  double range_max;             /**< to here */
} abbe_runtime_channel;

typedef struct abbe_runtime_lag {
  char name[ABBE_RUNTIME_TEXT];
  int channel;            /**< whose first-order lag it is */
  double time_constant_s; /**< tau dy/dt + y = value used of the channel */
} abbe_runtime_lag;

/** What becomes of values that cannot be used, and how quickly a correction may change. */
typedef struct abbe_runtime_policy {
  double hold_s;          /**< so long the limit or the last good value is used; 0 or more */
  double ramp_per_s;      /**< then it goes to the reference, and back later: parts of its range per second, above 0 */
  double rate_mm_per_s;   /**< the states move the correction of the tool point at most so quickly; above 0 */
  double longest_pause_s; /**< a longer pause of the calls counts as so long for ramp and rate; above 0 */
} abbe_runtime_policy;

typedef struct abbe_runtime_states abbe_runtime_states;

/** Numbers of channels and lags; 0 where no error depends on one. */
int abbe_runtime_channels(const abbe_runtime* runtime) ABBE_NOEXCEPT;
int abbe_runtime_lags(const abbe_runtime* runtime) ABBE_NOEXCEPT;
/** @return ABBE_OK, or ABBE_NULL for one that does not exist */
int abbe_runtime_describe_channel(const abbe_runtime* runtime, int channel,
                                  abbe_runtime_channel* description) ABBE_NOEXCEPT;
int abbe_runtime_describe_lag(const abbe_runtime* runtime, int lag, abbe_runtime_lag* description) ABBE_NOEXCEPT;

/** 10 s, 0.01 per s (a range within 100 s), 0.01 mm/s, 5 ms. */
void abbe_runtime_default_policy(abbe_runtime_policy* policy) ABBE_NOEXCEPT;

/** States of one machine, all at their references until values come. Allocates once. The runtime must live longer.
 *  @param policy  null: the default
 *  @return ABBE_OK, ABBE_NULL, ABBE_NOT_FINITE for a policy that cannot be, ABBE_FILE_NO_MEMORY */
int abbe_runtime_states_make(const abbe_runtime* runtime, const abbe_runtime_policy* policy,
                             abbe_runtime_states** states) ABBE_NOEXCEPT;
void abbe_runtime_states_free(abbe_runtime_states* states) ABBE_NOEXCEPT;
/** @return as abbe_runtime_states_make() */
int abbe_runtime_states_set_policy(abbe_runtime_states* states, const abbe_runtime_policy* policy) ABBE_NOEXCEPT;

/** The compensation at the present states, for every call of abbe_runtime.h. It is the same handle at all times; what
 *  it computes changes with the states. The handle of a file with channels gives ABBE_STATES_NOT_GIVEN itself. */
const abbe_runtime* abbe_runtime_at_states(const abbe_runtime_states* states) ABBE_NOEXCEPT;

/** Advances the time. Lags follow exactly for values that are linear between the calls.
 *  @param channels  present values, [channels]; no number where a sensor gives none
 *  @param seconds   since the last call; 0 or more, at most 1e9
 *  @return ABBE_OK, ABBE_NULL, or ABBE_NOT_FINITE for `seconds`: nothing has changed then */
int abbe_runtime_states_advance(abbe_runtime_states* states, const double* channels, double seconds) ABBE_NOEXCEPT;

/** Sets states at once, without policy and rate: for poses that are computed beforehand, never while a machine moves.
 *  @param lags  [lags]; null: in equilibrium with the channels
 *  @return ABBE_OK, ABBE_NULL, or ABBE_NOT_FINITE: nothing has changed then */
int abbe_runtime_states_set(abbe_runtime_states* states, const double* channels, const double* lags) ABBE_NOEXCEPT;

/** What is used now; every pointer may be null. No number: no good value of the channel has come yet.
 *  @param channels   [channels], in their units
 *  @param lags       [lags]
 *  @param flags      [channels], ABBE_CHANNEL_...
 *  @param behind_mm  how far the correction of the tool point may still be behind the states */
int abbe_runtime_states_get(const abbe_runtime_states* states, double* channels, double* lags, int* flags,
                            double* behind_mm) ABBE_NOEXCEPT;

/** Takes up lags where they were before a pause. When the first good value of a channel comes, its lags have the values
 *  of exact decay since then, the channel having been linear in between. To be called before the first advance.
 *  @param channels  values used then, [channels]
 *  @param lags      [lags]
 *  @param seconds   since then; 0 to 1e9
 *  @return ABBE_OK, ABBE_NULL, or ABBE_NOT_FINITE: nothing has changed then */
int abbe_runtime_states_restore(abbe_runtime_states* states, const double* channels, const double* lags,
                                double seconds) ABBE_NOEXCEPT;

/** The states as text that abbe_runtime_states_restore_text() reads, to be stored by the host.
 *  @param unix_s  time of day, seconds since 1970-01-01 UTC
 *  @return length without the 0 at the end; 0 if the room is too small, or if any channel has a flag: then what was
 *          stored before is better */
size_t abbe_runtime_states_text(const abbe_runtime_states* states, double unix_s, char* text,
                                size_t size) ABBE_NOEXCEPT;
/** abbe_runtime_states_restore() from that text.
 *  @param largest_age_s  older ones are refused
 *  @return ABBE_OK; ABBE_FILE_FOREIGN: not such a text, or of another compensation; ABBE_FILE_SHORT: truncated;
 *          ABBE_FILE_CONTENT; ABBE_STALE: too old, or from the future. Nothing has changed but for ABBE_OK */
int abbe_runtime_states_restore_text(abbe_runtime_states* states, const char* text, size_t size, double unix_s,
                                     double largest_age_s) ABBE_NOEXCEPT;

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
