#pragma once

// Internal to study: what a verification by readings says.
#include <vector>

#include "abbe/study/verified_readings.h"

namespace abbe {

/// Residuals of one set-up, [readings]; negative: left out, or without a length.
struct SetupResiduals {
  std::vector<double> before, after;  ///< mm
};

/// Fills the report from the rest of the result.
void write_readings_report(const ReadingsToVerify& request, const Campaign& campaign,
                           const std::vector<SetupResiduals>& residuals, VerifiedReadings& result);

}  // namespace abbe
