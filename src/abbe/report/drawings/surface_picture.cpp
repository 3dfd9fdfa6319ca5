#include "abbe/report/drawings/surface_picture.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

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

/// Every n-th, and those with the largest amounts, in their order.
std::vector<std::size_t> drawn_points(const std::vector<double>& deviation_mm) {
  constexpr std::size_t kLargest = 200;
  const std::size_t n = deviation_mm.size();
  std::vector<std::size_t> kept;
  const std::size_t every = (n + kPointsDrawn - kLargest - 1) / (kPointsDrawn - kLargest);
  for (std::size_t i = 0; i < n; i += std::max<std::size_t>(1, every)) kept.push_back(i);
  if (every > 1) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::partial_sort(order.begin(), order.begin() + kLargest, order.end(), [&](std::size_t a, std::size_t b) {
      const double first = std::abs(deviation_mm[a]), second = std::abs(deviation_mm[b]);
      return first != second ? first > second : a < b;
    });
    kept.insert(kept.end(), order.begin(), order.begin() + kLargest);
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  }
  return kept;
}

SurfaceReadings chosen(const SurfaceReadings& all, const std::vector<std::size_t>& kept) {
  SurfaceReadings readings;
  readings.foot.resize(3, static_cast<Index>(kept.size()));
  readings.normal.resize(3, static_cast<Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    readings.foot.col(static_cast<Index>(i)) = all.foot.col(static_cast<Index>(kept[i]));
    readings.normal.col(static_cast<Index>(i)) = all.normal.col(static_cast<Index>(kept[i]));
    readings.deviation_mm.push_back(all.deviation_mm[kept[i]]);
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
  return deviation_page(part, counted_readings(closest, deviation), closest.size(), limit_mm, threads);
}

nlohmann::json deviation_page(const TriangleMesh& part, const SurfaceReadings& readings, std::size_t measured,
                              double limit_mm, int threads) {
  if (readings.deviation_mm.empty()) return nlohmann::json::object();
  const double dense = radius_of_readings(readings);
  const SurfacePicture picture = part_picture(part, std::max(dense, 1e-6), threads);
  DeviationPicture colours;
  // No smaller than the triangles and the cubes of the thinning, or vertices would find no reading.
  double longest = 0;
  for (Index t = 0; t < picture.mesh.size(); ++t) {
    longest = std::max(longest, (picture.mesh.corner(t, 0) - picture.mesh.corner(t, 1)).norm());
  }
  colours.averaging_radius_mm = std::max({1.5 * dense, std::min(longest, 4 * dense), 1.5 * picture.thinned_cell_mm});
  colours.average = surface_average(readings, picture.mesh.vertices, vertex_normals(picture.mesh),
                                    colours.averaging_radius_mm, threads);
  colours.readings = chosen(readings, drawn_points(readings.deviation_mm));
  colours.measured = measured;
  colours.counted = readings.deviation_mm.size();
  colours.limit_mm = limit_mm;
  return {{"surface", surface_data(picture, &colours)},
          {"histograms",
           nlohmann::json::array({distribution(histogram(readings.deviation_mm, -limit_mm, limit_mm, kPageClasses))})}};
}

void state_all_points(std::size_t measured, std::size_t counted, const FineHistogram& all, double limit_mm,
                      nlohmann::json& page) {
  if (page.empty()) return;
  page["surface"]["points"]["measured"] = measured;
  page["surface"]["points"]["counted"] = counted;
  page["histograms"] = nlohmann::json::array({distribution(all.classes(-limit_mm, limit_mm, kPageClasses))});
}

}  // namespace abbe
