#pragma once

#include <optional>
#include <span>

#include "abbe/verify/parts/surface_deviation.h"

namespace abbe {

/// @param values  deviations of points that count, mm
DeviationStatistics deviation_statistics(std::span<const double> values,
                                         const std::optional<DeviationTolerance>& tolerance);

}  // namespace abbe
