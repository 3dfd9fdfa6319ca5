#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "time_limit.h"

namespace abbe {

struct DivisionOptions {
  double chord_mm = 0;  ///< largest deviation wanted
  double angle_rad = 0;
  double face_seconds = 0;    ///< for one face
  Handle(TimeLimit) limit{};  ///< for all
  /// How many faces are divided, of how many.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// A face without triangles, and why.
struct LostFace {
  TopoDS_Face face;
  std::string problem;     ///< "could not be divided into triangles: ..."
  bool timed_out = false;  ///< whether that is because it took too long
};

struct ShapeDivision {
  /// How far a face is off its triangles.
  struct Off {
    TopoDS_Face face;
    double deviation_mm = 0;  ///< kBetweenPoints times the largest distance found, edges included
    double gap_mm = 0;        ///< how far the file's own edges lie beside the face
  };
  Off farthest;
  double excess_mm = 0;  ///< largest deviation of a face without what no division of it can avoid (unavoidable_mm())
  Off most_in_excess;    ///< the face of this excess
  std::vector<LostFace> lost;
  /// Faces without triangles that have no area, such as those bounded by one edge twice.
  std::size_t without_area = 0;
};

/// Gives the faces of a shape their triangles, which OpenCASCADE keeps in the shape, each face once however often it
/// occurs. The edges are divided until they keep to the chord, then each face along them (FaceMesher). Where the edges
/// turn out to limit the faces, or a face gets no triangles along them, edges and faces are divided again, more finely.
/// The best division is kept: the one that loses the fewest faces, and of these the one with the least excess_mm.
///
/// The caller checks whether the chord was kept: where the file's own edges lie beside its faces, it cannot be.
/// @throws TimeIsUp, Standard_Failure
ShapeDivision divide_shape(const TopoDS_Shape& shape, const DivisionOptions& options);

}  // namespace abbe
