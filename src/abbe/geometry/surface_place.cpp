#include <algorithm>
#include <cmath>

#include "abbe/geometry/surface_tree.h"

namespace abbe::surface {
namespace {

double dot(const Coordinates& a, const Coordinates& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Coordinates minus(const Coordinates& a, const Coordinates& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Coordinates cross(const Coordinates& a, const Coordinates& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace

/// The distance to the plane where the point lies over the triangle, else that to the nearest edge. The first is
/// measured from the nearest edge: the normal of a needle is least sure in the direction of its length, in which
/// nothing is left from there.
Place nearest_place(const Tree& tree, std::uint32_t triangle, const double* point) {
  const std::array<std::uint32_t, 3>& corners = tree.corners[triangle];
  const bool needle = (corners[0] & Tree::kNeedle) != 0;
  const Coordinates& a = tree.vertices[corners[0] & ~Tree::kNeedle];
  const Coordinates ab = minus(tree.vertices[corners[1]], a), ac = minus(tree.vertices[corners[2]], a),
                    bc = minus(ac, ab);
  const Coordinates ap = minus({point[0], point[1], point[2]}, a), bp = minus(ap, ab);
  Place place;
  double place_t = 0;
  const auto take = [&](const Coordinates& from_start, const Coordinates& edge, std::uint8_t which) {
    const double square_of_edge = dot(edge, edge);
    // An edge without length is where it begins.
    const double along = square_of_edge > 1e-300 ? dot(from_start, edge) / square_of_edge : 0;
    const double t = std::min(std::max(along, 0.0), 1.0);
    const Coordinates rest = {from_start.x - t * edge.x, from_start.y - t * edge.y, from_start.z - t * edge.z};
    const double square = dot(rest, rest);
    if (square < place.square) {
      place.square = square;
      place.rest = rest;
      place_t = t;
      place.which = which;
    }
  };
  take(ap, ab, 0);
  take(ap, ac, 2);
  take(bp, bc, 1);
  Coordinates normal = cross(ab, ac);
  double length = 1;
  if (needle) {
    normal = tree.needle_normals.at(triangle);
  } else {
    length = std::sqrt(dot(normal, normal));
  }
  const bool has_area = !needle || dot(normal, normal) > 0.5;
  if (has_area && dot(normal, cross(ab, ap)) >= 0 && dot(normal, cross(ap, ac)) >= 0 &&
      dot(normal, cross(bc, bp)) >= 0) {
    place.height = dot(normal, place.rest) / length;
    place.square = std::min(place.square, place.height * place.height);
    const double share = place.height / length;
    place.rest = {share * normal.x, share * normal.y, share * normal.z};
    return place;
  }
  place.feature = place_t > 0 && place_t < 1 ? SurfaceFeature::edge : SurfaceFeature::vertex;
  if (place.feature == SurfaceFeature::vertex) {
    // The edge ac begins at a and ends at c, like the edge ca counted backwards.
    constexpr std::uint8_t kStart[] = {0, 1, 0}, kEnd[] = {1, 2, 2};
    place.which = place_t > 0 ? kEnd[place.which] : kStart[place.which];
  }
  return place;
}

}  // namespace abbe::surface
