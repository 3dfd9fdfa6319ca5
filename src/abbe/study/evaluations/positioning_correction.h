#pragma once

#include <optional>
#include <string>

#include "abbe/report/evaluations/positioning_report.h"
#include "abbe/study/evaluations/axis_tests.h"

namespace abbe {

/// A positioning test whose readings are to be corrected to 20 degC.
struct CorrectedPositioning {
  std::vector<PositioningReading> readings;  ///< corrected
  PositioningCorrection correction;          ///< what was done, for the report
};

/// @returns nothing where the test says no temperature
/// @throws InputError for what misses each other, temperatures of a rotary axis, and readings outside the record
std::optional<CorrectedPositioning> corrected_positioning(const PositioningTest& test, const std::string& file);

/// What is known of the measurement besides that: expansions and temperatures belong to the correction.
PositioningUncertaintyInput without_expansion(PositioningUncertaintyInput input);

}  // namespace abbe
