#pragma once

// Internal to formats: faces of any number of corners on their way to triangles.
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

/// Collects faces before their vertices are known; then cuts those of more than three corners into triangles.
class FaceTriangles {
 public:
  void reserve(std::size_t triangles) { triangles_.reserve(3 * triangles); }
  /// @param corners  at least three
  /// @param offset   byte in the file, for messages
  void add(std::span<const std::uint32_t> corners, std::size_t offset);
  /// Appends what another part of the file has.
  void append(const FaceTriangles& other);

  std::size_t size() const { return triangles_.size() / 3; }
  /// @returns the byte of the first polygon that cannot be cut, if there is one; see polygon_triangles()
  std::optional<std::size_t> cut(const Eigen::Matrix3Xd& vertices);
  Eigen::Map<const Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>> triangles() const {
    return {triangles_.data(), 3, static_cast<Eigen::Index>(size())};
  }

 private:
  struct Polygon {
    std::size_t triangle = 0;
    std::size_t corner = 0;
    std::size_t count = 0;
    std::size_t offset = 0;
  };
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> corners_;  // of polygons with more than three
  std::vector<Polygon> polygons_;
};

}  // namespace abbe
