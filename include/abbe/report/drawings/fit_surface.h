#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "abbe/geometry/fits/shape_fit.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// The fitted surface as far as points go, as a mesh; planes, spheres, cylinders and cones have one, the others give no
/// triangle.
TriangleMesh surface_of(const Shape& shape, const Eigen::Matrix3Xd& points);

/// Blocks of a page that shows the points of a fit on the fitted surface, or an empty object if it has none.
/// @param deviations_mm  of the points
/// @param counted        [points] 0: left out by a robust fit
nlohmann::json fit_page(const Shape& shape, const Eigen::Matrix3Xd& points, const std::vector<double>& deviations_mm,
                        const std::vector<std::uint8_t>& counted, int threads);

}  // namespace abbe
