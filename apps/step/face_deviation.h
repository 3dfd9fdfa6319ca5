#pragma once

#include <TopoDS_Face.hxx>

namespace abbe {

/// Largest distance found between the triangles of a face and its exact surface, and between the exact curves of its
/// edges and the sides of the triangles along them, in mm.
///
/// Of each triangle 28 points are looked at (corners, sixths of the sides, ten inside), of each piece of an edge seven.
/// Where the surface is curved alike all over the triangle, the farthest point is at most 2.8 % farther than the
/// farthest of these (it is within 1/6 of a side over sqrt(3) of one). The distance of a point is that to the nearest
/// point of the surface: in closed form for planes, cylinders, cones, spheres and tori, else by Gauss-Newton steps from
/// where the parameters of the corners point, which gives no less than the distance. Where the triangles end, only the
/// edges can say that nothing of the face is left out: projection onto the surface is continuous, so what lies between
/// the edges is covered.
/// @param at_least  distances below this are not told from it
/// @throws std::runtime_error if the face has no triangles
double face_deviation(const TopoDS_Face& face, double at_least);

}  // namespace abbe
