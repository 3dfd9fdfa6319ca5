#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/report/drawings/surface_data.h"

namespace abbe {

/// Places of a surface and what is said of each of them: an index into reasons.
struct PlacesOfASurface {
  Eigen::Matrix3Xd points;           ///< [3, n] mm, on the surface
  std::vector<std::uint8_t> reason;  ///< [n]
  std::vector<std::string> reasons;  ///< "covered" first, then why not
};

/// A part for a page, each of its triangles with what is said of most of the places about it on its side; triangles
/// without a place near get a reason of their own, but those of a thinned part, which may look another way than the
/// part does, take that of the places on whatever side.
/// @param part  the surface on which the places lie
SurfacePicture coverage_picture(const TriangleMesh& part, const PlacesOfASurface& places, int threads);

}  // namespace abbe
