#pragma once

#include <cstdint>
#include <vector>

#include "abbe/geometry/fits/shape_start.h"

/// Inside of the robust fit: where to begin among outliers.
namespace abbe::fits {

/// The median of the distances without those of `met` points, the nearest, through which a shape can always be laid;
/// the distances are put into another order. With all of them a few exact points would be taken for small noise.
/// Source: P. W. Holland, R. E. Welsch, Commun. Stat. A6 (1977) 813; P. J. Rousseeuw, A. M. Leroy, Robust Regression
/// and Outlier Detection (1987), 3.4: the quantile (n + p + 1) / 2.
double median_distance(std::vector<double>& distances, std::size_t met);

/// Through how many points a shape of so many free parameters can be laid.
inline std::size_t points_met(ShapeKind kind, std::size_t parameters) {
  const auto rows = static_cast<std::size_t>(rows_per_point(kind));
  return (parameters + rows - 1) / rows;
}

/// Different shapes as far as rough candidates tell.
bool unlike(const ShapeFrame& a, const ShapeFrame& b, const Survey& survey);

/// Shapes with the smallest median distance of the survey's points, of many through a few points each: the best that
/// differ from each other, best first.
/// Source: P. J. Rousseeuw, J. Am. Stat. Assoc. 79 (1984) 871.
std::vector<ShapeFrame> least_median_shapes(ShapeKind kind, const Survey& survey, const FitConstraints& constraints,
                                            std::uint64_t seed);

}  // namespace abbe::fits
