#pragma once

#include <array>
#include <optional>

#include "abbe/report/evaluations/circular_report.h"
#include "abbe/study/evaluations/axis_tests.h"

namespace abbe {

/// A circular test whose radii are to be corrected to 20 degC.
struct CorrectedCircle {
  std::array<CircularReadings, 2> paths;  ///< corrected
  CircularCorrection correction;          ///< what was done, for the report
};

/// @returns nothing where the test says no temperature. @throws InputError for numbers that miss each other
std::optional<CorrectedCircle> corrected_circle(const CircularTest& test);

}  // namespace abbe
