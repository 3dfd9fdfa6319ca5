#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "abbe/geometry/triangle_mesh.h"

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

/// Eight triangles in structure of arrays; the last leaves repeat a triangle to fill up.
struct alignas(64) Leaf {
  using Row = std::array<double, kWidth>;
  std::array<Row, 3> corner;                ///< a, mm, about Tree::centre
  std::array<Row, 3> edge_ab, edge_ac;      ///< mm
  std::array<Row, 3> normal;                ///< unit vector, or zero for a triangle without area
  std::array<Row, 3> inverse_square;        ///< 1 / length^2 of ab, ac, bc; 0 for an edge without length
  std::array<std::uint32_t, kWidth> index;  ///< triangle of the mesh
};

/// A triangle in a leaf.
struct Slot {
  std::uint32_t leaf = 0;
  std::uint32_t lane = 0;
};

struct Tree {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< subtracted from vertices and points, exactly
  float largest = 0;                                 ///< largest coordinate about the centre
  std::vector<Node> nodes;                           ///< the first one is the root
  std::vector<Leaf> leaves;
};

/// Triangle of the smallest computed distance; of equal ones that with the smaller index.
struct Found {
  Slot slot;
  std::uint32_t triangle = 0;
  double square = std::numeric_limits<double>::infinity();  ///< mm^2
};

/// Binned surface-area heuristic; the tree does not depend on the number of threads.
/// Source: Wald, IEEE Symposium on Interactive Ray Tracing (2007) 33.
Tree build_tree(const TriangleMesh& mesh, int threads);

/// @param points  [3 * count] about Tree::centre; neighbours in this order should be neighbours in space
/// @param hints   null, or [count] a triangle that may be near: where a point was found before it moved a little
void search_block(const Tree& tree, const double* points, std::size_t count, const Slot* hints, Found* found);

}  // namespace abbe::surface
