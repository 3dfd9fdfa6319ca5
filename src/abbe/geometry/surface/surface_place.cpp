#include <algorithm>
#include <cmath>

#include "abbe/geometry/surface/surface_tree.h"

namespace abbe::surface {
namespace {

double dot(const Coordinates& a, const Coordinates& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Coordinates minus(const Coordinates& a, const Coordinates& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Coordinates cross(const Coordinates& a, const Coordinates& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Square of the height of a triangle over its longest side from which on its normal is as sure as its corners.
constexpr double kStoutSquared = 0.05 * 0.05;

}  // namespace

/// The distance to the plane where the point lies over the triangle, else that to the nearest edge. Of a thin triangle
/// the first is measured from the nearest edge: its normal is least sure in the direction of its length, in which
/// nothing is left from there.
Place nearest_place(const Tree& tree, std::uint32_t triangle, const double* point) {
  const std::array<std::uint32_t, 3>& corners = tree.corners[triangle];
  const bool needle = (corners[0] & Tree::kNeedle) != 0;
  const Coordinates& a = tree.vertices[corners[0] & ~Tree::kNeedle];
  const Coordinates ab = minus(tree.vertices[corners[1]], a), ac = minus(tree.vertices[corners[2]], a),
                    bc = minus(ac, ab);
  const Coordinates ap = minus({point[0], point[1], point[2]}, a), bp = minus(ap, ab);
  Coordinates normal = cross(ab, ac);
  double square_of_normal = dot(normal, normal);
  if (needle) {
    normal = tree.needle_normals.at(triangle);
    square_of_normal = dot(normal, normal) > 0.5 ? 1 : 0;
  }
  // In one comparison, since any of the three may be the one that fails.
  const bool over = std::min({dot(normal, cross(ab, ap)), dot(normal, cross(ap, ac)), dot(normal, cross(bc, bp))}) >= 0;
  const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
  Place place;
  if (over && !needle && square_of_normal > kStoutSquared * longest * longest) {
    const double share = dot(normal, ap) / square_of_normal;
    place.height = share * std::sqrt(square_of_normal);
    place.square = place.height * place.height;
    place.rest = {share * normal.x, share * normal.y, share * normal.z};
    return place;
  }
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
  if (over && square_of_normal > 0) {
    const double length = std::sqrt(square_of_normal);
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
