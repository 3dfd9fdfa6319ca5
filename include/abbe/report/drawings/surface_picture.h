#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/report/drawings/drawn_readings.h"
#include "abbe/report/drawings/surface_data.h"
#include "abbe/verify/evaluations/fine_histogram.h"
#include "abbe/verify/parts/averaged_places.h"
#include "abbe/verify/parts/surface_deviation.h"

namespace abbe {

/// What a page draws at most, so that it stays below its size with a part of a million triangles.
inline constexpr Eigen::Index kTrianglesDrawn = 60000;

/// A part for a page: thinned out if it is finer than that, and said so.
/// @param refined_mm  edges no longer than this, as far as the number of triangles allows; 0: as they are
SurfacePicture part_picture(const TriangleMesh& part, double refined_mm, int threads);

/// Block "surface" of a page and its distribution: the part coloured by signed deviation, and the points that count.
///
/// Of many points one of each few is drawn and the 200 with the largest amounts; the colours of the surface are means
/// of all.
/// @param closest    [points] on the part
/// @param deviation  of them
/// @param limit_mm   deviation of the full colour
/// @return {"surface", "histograms"}, or an empty object if no point counts
nlohmann::json deviation_page(const TriangleMesh& part, std::span<const SurfacePoint> closest,
                              const SurfaceDeviation& deviation, double limit_mm, int threads);

/// A part and the places for its colours, the vertices of the picture. Both depend only on how dense the readings are,
/// so they are known before the readings.
struct ColouredPart {
  SurfacePicture picture;
  AveragedPlaces places;  ///< [vertices]
};
/// @param dense_mm  radius_of_readings()
ColouredPart coloured_part(const TriangleMesh& part, double dense_mm, int threads);

/// The same of readings that were added up and chosen as they came.
/// @param sums          of the places of the part
/// @param measured      number of all points
/// @param deviation_mm  of those that count
nlohmann::json deviation_page(const ColouredPart& part, const PlaceSums& sums, const DrawnReadings& drawn,
                              std::size_t measured, std::span<const double> deviation_mm, double limit_mm);

/// For a picture of a choice of the points: states the numbers and the distribution of all. @param page  if not empty
void state_all_points(std::size_t measured, std::size_t counted, const FineHistogram& all, double limit_mm,
                      nlohmann::json& page);

}  // namespace abbe
