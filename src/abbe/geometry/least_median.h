#pragma once

#include <cstdint>
#include <vector>

#include "abbe/geometry/shape_start.h"

/// Inside of the robust fit: where to begin among outliers.
namespace abbe::fits {

/// The middle one of values, which are put into another order.
double middle(std::vector<double>& values);

/// Different shapes as far as rough candidates tell.
bool unlike(const ShapeFrame& a, const ShapeFrame& b, const Survey& survey);

/// Shapes with the smallest median distance of the survey's points, of many through a few points each: the best that
/// differ from each other, best first.
/// Source: P. J. Rousseeuw, J. Am. Stat. Assoc. 79 (1984) 871.
std::vector<ShapeFrame> least_median_shapes(ShapeKind kind, const Survey& survey, const FitConstraints& constraints,
                                            std::uint64_t seed);

}  // namespace abbe::fits
