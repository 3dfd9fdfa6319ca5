#pragma once

// Internal to study: a campaign whose poses are read again and again while the machine warms.
#include <string>

#include "abbe/formats/study/study.h"
#include "abbe/study/campaign.h"
#include "abbe/study/evaluations/cycle_readings.h"
#include "abbe/verify/thermal/location_distortion.h"

namespace abbe {

/// Identifies the whole campaign, then in every cycle its location errors and what is open in its set-ups.
///
/// Held at the result of the whole campaign: all other errors of the machine, location errors that a convention fixes,
/// and what is known of a set-up beforehand. With the same poses in every cycle what is held has no influence on
/// changes, to first order.
/// @param file  of the study, for messages
/// @throws InputError for readings without times, a set-up that drifts, errors with measured states, no location
///         errors, or fewer than two cycles that determine them
LocationErrorsOverTime location_errors_over_time(const Study& study, const Campaign& campaign,
                                                 const CycleChoice& choice, const std::string& file);

/// What the location errors do over the time of a test (the fourth test of ISO 230-3: rotary motion of components).
///
/// chi-square of a location error's changes about its weighted mean has cycles - 1 degrees of freedom. Definitions:
/// docs/evaluate-thermal.md.
/// @param run  from a time at or after the first cycle to a later one, at or before the last
LocationDistortion evaluate_location_distortion(const LocationErrorsOverTime& found, const WarmingRun& run);

}  // namespace abbe
