#pragma once

// Internal to study: what a verification by readings says.
#include "abbe/study/verification/verified_readings.h"

namespace abbe {

/// Fills the report from the rest of the result.
void write_readings_report(const ReadingsToVerify& request, const Campaign& campaign, VerifiedReadings& result);

}  // namespace abbe
