#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

/// Gives corners with the same coordinates one vertex: exact comparison, numbers in order of first appearance.
///
/// Minus zero counts as zero. No tolerance: corners that differ in the last bit stay apart, because a distance below
/// which points are one would be a decision about the part.
class VertexWelder {
 public:
  /// @param expected  vertices to make room for; more may come
  /// @param corners   that will be added, if known: room for more vertices is then made for all that are likely
  explicit VertexWelder(std::size_t expected, std::size_t corners = 0);

  /// @param corners  x, y, z of each corner, finite; any unit
  /// @param indices  [corners.size() / 3] becomes the vertex of each
  /// @throws std::length_error beyond 2^32 - 2 vertices
  void add(std::span<const double> corners, std::uint32_t* indices);

  std::size_t size() const { return coordinates_.size() / 3; }
  /// [3, size()] in order of first appearance; as long as nothing is added.
  Eigen::Map<const Eigen::Matrix3Xd> vertices() const;

 private:
  void make_room();
  void rehash(std::size_t slots);

  std::size_t corners_ = 0;  // that will come
  std::size_t added_ = 0;
  std::vector<double> coordinates_;
  std::vector<std::uint32_t> slots_;  // open addressing, a power of two; kFree or a vertex
  int shift_ = 0;                     // of a hash to its slot
};

}  // namespace abbe
