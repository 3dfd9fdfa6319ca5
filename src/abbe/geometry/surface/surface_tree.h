#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/geometry/surface/triangle_mesh.h"

/// Inside of ClosestPointFinder: the tree of boxes as plain data, how it is built and how it is searched. Not an
/// interface.
namespace abbe::surface {

inline constexpr std::size_t kWidth = 8;  ///< children of a node and triangles of a leaf
inline constexpr std::uint32_t kLeaf = 0x80000000u;
inline constexpr std::uint32_t kNoChild = 0xffffffffu;

/// Boxes of eight children, rounded outward far enough to hold every error of a search in single precision.
struct alignas(32) Node {
  std::array<std::array<float, kWidth>, 3> low, high;  ///< [axis][child] mm, about Tree::centre
  std::array<std::uint32_t, kWidth> child;             ///< node, or kLeaf + leaf, or kNoChild
};

/// Eight triangles as the search first looks at them: in single precision, about a centre and in a unit of their own.
struct alignas(64) Leaf {
  using Row = std::array<float, kWidth>;
  std::array<Row, 3> corner, edge_ab, edge_ac;  ///< [axis][lane] in units of 1 / inverse_scale, none above 2
  std::array<std::uint32_t, kWidth> index;      ///< triangle of the mesh; the last lanes may repeat one
  std::array<double, 3> centre;                 ///< mm, about Tree::centre
  double inverse_scale = 1;                     ///< power of two, 1/mm
  std::uint32_t first = 0;                      ///< of Tree::corners, the first lane
  std::uint32_t count = 0;                      ///< lanes without the repeated ones
};

struct Coordinates {
  double x = 0, y = 0, z = 0;
};

struct Tree {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< subtracted from vertices and points, exactly
  Eigen::Vector3d low, high;                         ///< box around the vertices, mm
  float largest = 0;                                 ///< largest coordinate about the centre
  std::vector<Node> nodes;                           ///< the first one is the root
  std::vector<Leaf> leaves;
  /// Triangles and vertices in the order of the leaves, so that what lies together is read together.
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< [triangles] kNeedle added to the first one of a needle
  std::vector<Coordinates> vertices;                  ///< mm, about Tree::centre
  static constexpr std::uint32_t kNeedle = 0x80000000u;
  /// Unit normals, better than double precision gives them, of triangles that are almost without area; zero for those
  /// without.
  std::unordered_map<std::uint32_t, Coordinates> needle_normals;
};

/// Place on a triangle that is nearest to a point.
struct Place {
  double square = std::numeric_limits<double>::infinity();  ///< of the distance, mm^2
  Coordinates rest;                                         ///< from the place to the point, mm
  double height = 0;                                        ///< over the face, mm
  SurfaceFeature feature = SurfaceFeature::face;
  std::uint8_t which = 0;  ///< edge ab, bc, ca or vertex a, b, c
};

/// The same bits on every processor.
/// @param triangle  of Tree::corners
/// @param point     about Tree::centre, mm
Place nearest_place(const Tree& tree, std::uint32_t triangle, const double* point);

/// Triangle of the smallest computed distance; of equal ones that with the smallest number.
struct Found {
  Place place;
  std::uint32_t triangle = 0;
  std::uint32_t leaf = 0;
};

/// Binned surface-area heuristic; the tree does not depend on the number of threads.
/// Source: Wald, IEEE Symposium on Interactive Ray Tracing (2007) 33.
Tree build_tree(const TriangleMesh& mesh, int threads);

/// @param points  [3 * count] about Tree::centre; neighbours in this order should be neighbours in space
/// @param hints   null, or [count] a leaf that may be near: where a point was found before it moved a little
void search_block(const Tree& tree, const double* points, std::size_t count, const std::uint32_t* hints, Found* found);

}  // namespace abbe::surface
