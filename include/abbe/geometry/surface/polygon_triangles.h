#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

namespace abbe {

/// Corners of the largest polygon that is cut by its ears: that takes a time with the square of their number.
inline constexpr std::size_t kLargestConcavePolygon = 1000;

/// Triangles of a polygon face, n - 2 of them, with its sense of rotation.
///
/// A polygon that is convex in the plane of its mean normal (Newell) becomes a fan from its first corner; another one
/// is cut ear by ear, so that no triangle lies outside it. One that crosses itself or has no area becomes a fan.
/// @param vertices   [3, any] mm
/// @param corners    [n >= 3] columns of `vertices`, in order around the polygon
/// @param triangles  [3 (n - 2)] becomes the corners of the triangles, as columns of `vertices`
/// @returns false if the polygon is not convex and has more than kLargestConcavePolygon corners: nothing is written
/// Source: G. H. Meisters, Amer. Math. Monthly 82 (1975) 648: every simple polygon has two ears.
bool polygon_triangles(const Eigen::Matrix3Xd& vertices, std::span<const std::uint32_t> corners,
                       std::uint32_t* triangles);

}  // namespace abbe
