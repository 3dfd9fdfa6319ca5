#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/report/drawings/surface_data.h"
#include "abbe/verify/evaluations/fine_histogram.h"
#include "abbe/verify/parts/surface_deviation.h"

namespace abbe {

/// What a page draws at most, so that it stays below its size with a part of a million triangles and as many points.
inline constexpr Eigen::Index kTrianglesDrawn = 60000;
inline constexpr std::size_t kPointsDrawn = 40000;

/// A part for a page: thinned out if it is finer than that, and said so.
/// @param refined_mm  edges no longer than this, as far as the number of triangles allows; 0: as they are
SurfacePicture part_picture(const TriangleMesh& part, double refined_mm, int threads);

/// Block "surface" of a page and its distribution: the part coloured by signed deviation, and the points that count.
///
/// Of many points every n-th is drawn and the 200 with the largest amounts; the colours of the surface are means of
/// all.
/// @param closest    [points] on the part
/// @param deviation  of them
/// @param limit_mm   deviation of the full colour
/// @return {"surface", "histograms"}, or an empty object if no point counts
nlohmann::json deviation_page(const TriangleMesh& part, std::span<const SurfacePoint> closest,
                              const SurfaceDeviation& deviation, double limit_mm, int threads);
/// The same of the points that count. @param measured  number of all points
nlohmann::json deviation_page(const TriangleMesh& part, const SurfaceReadings& readings, std::size_t measured,
                              double limit_mm, int threads);

/// For a picture of a choice of the points: states the numbers and the distribution of all. @param page  if not empty
void state_all_points(std::size_t measured, std::size_t counted, const FineHistogram& all, double limit_mm,
                      nlohmann::json& page);

}  // namespace abbe
