#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// Values at some places in ascending order, of many values in a few passes over them.
/// @param places  below the number of values
/// @return [places]
std::vector<double> values_at_places(std::span<const double> values, std::span<const std::size_t> places);

/// As sample_statistics(), with further percentiles of the same values: quicker than one by one.
/// @param fractions  0..1
/// @param found      [fractions] filled
SampleStatistics sample_statistics(std::span<const double> values, std::span<const double> fractions,
                                   std::span<double> found);

}  // namespace abbe
