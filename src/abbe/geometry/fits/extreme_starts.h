#pragma once

#include <vector>

#include "abbe/geometry/fits/extreme_fit.h"
#include "abbe/geometry/fits/shape_start.h"

/// Inside of the fits: where else a minimum zone, circumscribed or inscribed shape may lie.
namespace abbe::fits {

/// True if the points stray so far from a shape, compared with their smallest extent that shows its form, that it may
/// not be the only optimum.
/// @param form  largest less smallest distance from the least-squares shape, mm
bool may_have_rivals(ShapeKind kind, const Survey& survey, double form);

/// Starts in other valleys: axes and normals all around, centres beside that of the least-squares shape, and for
/// inscribed circles and spheres the roomiest places of a grid.
/// @param frame  the least-squares shape, centre zero
std::vector<ShapeFrame> extreme_starts(ExtremeKind extreme, const ShapeFrame& frame, const Survey& survey,
                                       const FitConstraints& constraints);

}  // namespace abbe::fits
