#include "abbe/report/drawings/surface_picture.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/surface/mesh_refinement.h"
#include "abbe/geometry/surface/mesh_thinning.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {
namespace {

using Eigen::Index;

constexpr double kCrease = 30 * kDegree;
constexpr std::size_t kPageClasses = 40;

SurfaceReadings counted_readings(std::span<const SurfacePoint> closest, const SurfaceDeviation& deviation) {
  SurfaceReadings readings;
  const auto count = static_cast<Index>(deviation.all.sample.count);
  readings.foot.resize(3, count);
  readings.normal.resize(3, count);
  readings.deviation_mm.reserve(deviation.all.sample.count);
  Index next = 0;
  for (std::size_t i = 0; i < closest.size(); ++i) {
    if (deviation.counted[i] == 0) continue;
    readings.foot.col(next) = closest[i].point;
    readings.normal.col(next++) = closest[i].normal;
    readings.deviation_mm.push_back(deviation.deviation_mm[i]);
  }
  return readings;
}

nlohmann::json distribution(const Histogram& classes) {
  nlohmann::json entry = {{"title", "Distribution of the deviations"}, {"quantity", "deviation"}, {"of", "points"}};
  for (std::size_t i = 0; i <= kPageClasses; ++i) {
    entry["edges_um"].push_back(1e3 * (classes.from + classes.width * static_cast<double>(i)));
  }
  entry["counts"] = classes.counts;
  entry["below"] = classes.below;
  entry["above"] = classes.above;
  return entry;
}

}  // namespace

SurfacePicture part_picture(const TriangleMesh& part, double refined_mm, int threads) {
  ThinnedMesh thin = thinned_mesh(part, kTrianglesDrawn);
  if (refined_mm > 0) thin.mesh = refined_mesh(thin.mesh, refined_mm, kTrianglesDrawn).mesh;
  SurfacePicture picture;
  picture.mesh = with_separate_faces(thin.mesh, surface_faces(thin.mesh, kCrease, threads));
  picture.triangles_of_part = static_cast<std::size_t>(part.size());
  picture.thinned_cell_mm = thin.cell_mm;
  return picture;
}

nlohmann::json deviation_page(const TriangleMesh& part, std::span<const SurfacePoint> closest,
                              const SurfaceDeviation& deviation, double limit_mm, int threads) {
  const SurfaceReadings readings = counted_readings(closest, deviation);
  if (readings.deviation_mm.empty()) return nlohmann::json::object();
  const ColouredPart coloured = coloured_part(part, radius_of_readings(readings), threads);
  const PlaceSums sums = sums_of_readings(coloured.places, readings, threads);
  DrawnReadings drawn(closest.size());
  for (std::size_t i = 0; i < readings.deviation_mm.size(); ++i) {
    drawn.add(readings.foot.col(static_cast<Index>(i)), readings.normal.col(static_cast<Index>(i)),
              readings.deviation_mm[i]);
  }
  return deviation_page(coloured, sums, drawn, closest.size(), readings.deviation_mm, limit_mm);
}

ColouredPart coloured_part(const TriangleMesh& part, double dense_mm, int threads) {
  ColouredPart coloured;
  coloured.picture = part_picture(part, std::max(dense_mm, 1e-6), threads);
  const TriangleMesh& mesh = coloured.picture.mesh;
  // No smaller than the triangles and the cubes of the thinning, or vertices would find no reading.
  double longest = 0;
  for (Index t = 0; t < mesh.size(); ++t) longest = std::max(longest, (mesh.corner(t, 0) - mesh.corner(t, 1)).norm());
  const double radius =
      std::max({1.5 * dense_mm, std::min(longest, 4 * dense_mm), 1.5 * coloured.picture.thinned_cell_mm});
  coloured.places = AveragedPlaces(mesh.vertices, vertex_normals(mesh), radius);
  return coloured;
}

nlohmann::json deviation_page(const ColouredPart& part, const PlaceSums& sums, const DrawnReadings& drawn,
                              std::size_t measured, std::span<const double> deviation_mm, double limit_mm) {
  if (deviation_mm.empty()) return nlohmann::json::object();
  DeviationPicture colours;
  colours.averaging_radius_mm = part.places.radius_mm();
  colours.average = sums.average();
  colours.readings = drawn.readings();
  colours.measured = measured;
  colours.counted = deviation_mm.size();
  colours.limit_mm = limit_mm;
  return {{"surface", surface_data(part.picture, &colours)},
          {"histograms",
           nlohmann::json::array({distribution(histogram(deviation_mm, -limit_mm, limit_mm, kPageClasses))})}};
}

void state_all_points(std::size_t measured, std::size_t counted, const FineHistogram& all, double limit_mm,
                      nlohmann::json& page) {
  if (page.empty()) return;
  page["surface"]["points"]["measured"] = measured;
  page["surface"]["points"]["counted"] = counted;
  page["histograms"] = nlohmann::json::array({distribution(all.classes(-limit_mm, limit_mm, kPageClasses))});
}

}  // namespace abbe
