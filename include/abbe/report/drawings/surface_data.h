#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/verify/parts/surface_average.h"

namespace abbe {

/// A part as a page draws it; already thinned, see docs/report-data.md.
struct SurfacePicture {
  std::string frame = "part";          ///< of the coordinates, as the page names it
  TriangleMesh mesh;                   ///< mm, vertices separate at the edges of the part
  std::size_t triangles_of_part = 0;   ///< before thinning and refining
  double thinned_cell_mm = 0;          ///< edge of the cubes in which vertices became one; 0: none did
  std::vector<std::uint8_t> coverage;  ///< [triangles] index into `reasons`, or empty
  std::vector<std::string> reasons;    ///< "covered" first, then why not
  std::vector<double> percent;         ///< of the first reasons: share of the area, or empty
  std::vector<std::string> colours;    ///< [reasons] "#28a046", or empty: those of the page
};

/// Signed deviations on it.
struct DeviationPicture {
  SurfaceAverage average;  ///< [vertices of the mesh]
  double averaging_radius_mm = 0;
  SurfaceReadings readings;               ///< those that are drawn
  std::size_t measured = 0, counted = 0;  ///< points of the scan; those with a deviation
  double limit_mm = 0;                    ///< deviation of the full colour, above zero
};

/// Steps of the numbers of a picture: coordinates and deviations are whole multiples.
inline constexpr int kPictureSteps = 65535;    ///< of the largest extent
inline constexpr double kStepsToLimit = 2000;  ///< from zero deviation to the full colour
inline constexpr std::int16_t kNoDeviation = -32768;
/// Fewer make no mean: a stray point alone does not colour a part.
inline constexpr std::uint32_t kFewestReadings = 3;

/// Block "surface" of the data of a page. @param deviation  null: the part alone
/// @throws std::invalid_argument  sizes that do not belong together, a limit that is not above zero
nlohmann::json surface_data(const SurfacePicture& part, const DeviationPicture* deviation);

}  // namespace abbe
