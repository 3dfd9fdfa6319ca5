#pragma once

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <Poly_Triangulation.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Face.hxx>
#include <array>
#include <gp_XY.hxx>
#include <gp_XYZ.hxx>

namespace abbe {

/// The farthest point of a triangle may be between those that are looked at.
constexpr double kBetweenPoints = 1.03;

bool has_triangles(const TopoDS_Face& face);

/// The triangles of a face, in its own frame. @param location  set to where that is in the part
/// @throws std::runtime_error if there are none
Handle(Poly_Triangulation) triangles_of(const TopoDS_Face& face, TopLoc_Location& location);

/// In mm^2, of the exact surface within the edges; above zero whichever way they run; not a number
/// where OpenCASCADE finds none.
double face_area_mm2(const TopoDS_Face& face);

/// How far the triangles of a face are from its exact surface, in mm.
struct FaceDeviation {
  double triangles_mm = 0;  ///< largest distance found anywhere on a triangle
  double corners_mm = 0;    ///< largest distance of a corner: so far the file's own edges lie beside the face
};

/// The part of a deviation that no division can avoid: where the file's own edges lie beside the face by half of the
/// chord or more, the triangles along them do, too.
inline double unavoidable_mm(const FaceDeviation& deviation, double chord_mm) {
  return deviation.corners_mm > 0.5 * chord_mm ? kBetweenPoints * deviation.corners_mm : 0;
}

/// The largest distances of one triangle from its surface, of 28 points that are looked at (corners, sixths of the
/// sides, ten inside). Where the surface is curved alike all over the triangle, the farthest point is at most 2.8 %
/// farther than the farthest of these (it is within 1/6 of a side over sqrt(3) of one). The distance of a point is that
/// to the nearest point of the surface: in closed form for planes, cylinders, cones, spheres and tori, else by
/// Gauss-Newton steps from where the parameters of the corners point, which gives no less than the distance. Where the
/// triangles end, only the edges (edges_deviation()) can say that nothing of the face is left out: projection onto the
/// surface is continuous, so what lies between the edges is covered.
/// @param corners     in the part
/// @param parameters  of the corners, or null
/// @param small_mm    distances below this may come out larger, but not above it
/// @returns in mm, as measured: without kBetweenPoints
/// @throws std::runtime_error where there is no distance
FaceDeviation triangle_deviation(const BRepAdaptor_Surface& surface, const std::array<gp_XYZ, 3>& corners,
                                 const std::array<gp_XY, 3>* parameters, double small_mm);

/// Largest distance of seven points of a piece of an edge from the straight line between its ends, in mm.
/// @param from, to    parameters of the ends
/// @param begin, end  where the line has them
double curve_deviation(const BRepAdaptor_Curve& curve, double from, double to, const gp_XYZ& begin, const gp_XYZ& end);

/// Largest distance between the exact curves of a face's edges and the sides of its triangles along them, in mm, of
/// seven points of each piece of an edge.
/// @throws std::runtime_error if the face has no triangles or an edge is not among their sides
double edges_deviation(const TopoDS_Face& face);

}  // namespace abbe
