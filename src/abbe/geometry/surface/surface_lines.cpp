#include "abbe/geometry/surface/surface_lines.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "abbe/geometry/angle.h"

namespace abbe {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// What a plane cuts out of one triangle, from edge to edge.
struct Piece {
  std::array<Edge, 2> edge;
  std::array<Eigen::Vector3d, 2> end;
  std::uint32_t triangle = 0;
};

std::vector<Piece> cut(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                       const Eigen::Vector3d& direction, double height) {
  std::vector<Piece> pieces;
  for (const std::uint32_t triangle : triangles) {
    const auto column = static_cast<Eigen::Index>(triangle);
    std::array<double, 3> above;
    for (int k = 0; k < 3; ++k) above[static_cast<std::size_t>(k)] = direction.dot(mesh.corner(column, k)) - height;
    Piece piece;
    piece.triangle = triangle;
    std::size_t crossed = 0;
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const double a = above[static_cast<std::size_t>(k)], b = above[static_cast<std::size_t>(next)];
      // A corner in the plane counts as above it, so that every triangle is crossed twice or not at all.
      if ((a >= 0) == (b >= 0) || crossed == 2) continue;
      const std::uint32_t from = mesh.triangles(k, column), to = mesh.triangles(next, column);
      piece.edge[crossed] = std::minmax(from, to);
      // The same numbers in the same order for both triangles of an edge.
      const bool in_order = from < to;
      const Eigen::Vector3d low = mesh.vertices.col(in_order ? from : to),
                            high = mesh.vertices.col(in_order ? to : from);
      const double share = in_order ? a / (a - b) : b / (b - a);
      piece.end[crossed] = low + share * (high - low);
      ++crossed;
    }
    if (crossed == 2) pieces.push_back(piece);
  }
  return pieces;
}

/// A run of pieces, each with the end at which it begins.
using Chain = std::vector<std::pair<std::size_t, std::size_t>>;

/// Joins pieces that share an edge.
std::vector<Chain> chains_of(const std::vector<Piece>& pieces, std::vector<bool>& closed) {
  std::map<Edge, std::vector<std::size_t>> at;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (const Edge& edge : pieces[i].edge) at[edge].push_back(i);
  }
  const auto neighbour = [&](std::size_t piece, std::size_t end) {
    for (const std::size_t other : at[pieces[piece].edge[end]]) {
      if (other != piece) return other;
    }
    return pieces.size();
  };
  std::vector<bool> used(pieces.size(), false);
  std::vector<Chain> chains;
  const auto walk = [&](std::size_t piece, std::size_t begin) {
    Chain chain;
    const std::size_t first = piece;
    while (piece < pieces.size() && !used[piece]) {
      used[piece] = true;
      chain.emplace_back(piece, begin);
      const std::size_t next = neighbour(piece, 1 - begin);
      if (next < pieces.size()) begin = pieces[next].edge[0] == pieces[piece].edge[1 - begin] ? 0U : 1U;
      piece = next;
    }
    chains.push_back(std::move(chain));
    closed.push_back(piece == first);
  };
  // Open chains from their ends, then what is left: rings.
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t end = 0; end < 2 && !used[i]; ++end) {
      if (neighbour(i, end) == pieces.size()) walk(i, end);
    }
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!used[i]) walk(i, 0);
  }
  return chains;
}

SurfaceLine spaced(const std::vector<Piece>& pieces, const Chain& chain, const SmoothSurface& smooth, double along,
                   double largest_turn) {
  // In steps: of length, or of turning where the surface turns faster than that.
  std::vector<double> length(chain.size() + 1, 0.0);
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Piece& piece = pieces[chain[i].first];
    const Eigen::Vector3d from = smooth.normal(piece.triangle, piece.end[0]),
                          to = smooth.normal(piece.triangle, piece.end[1]);
    const double turn = angle_between(from, to);
    length[i + 1] = length[i] + std::max((piece.end[1] - piece.end[0]).norm() / along, turn / largest_turn);
  }
  const auto count = static_cast<Eigen::Index>(std::max(1.0, std::ceil(length.back() - 1e-9)));
  SurfaceLine line;
  line.points.resize(3, count);
  line.normals.resize(3, count);
  std::size_t i = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const double at = length.back() * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    while (i + 1 < chain.size() && length[i + 1] < at) ++i;
    const auto [index, begin] = chain[i];
    const Piece& piece = pieces[index];
    const double whole = length[i + 1] - length[i], share = whole > 0 ? (at - length[i]) / whole : 0.0;
    line.points.col(k) = piece.end[begin] + share * (piece.end[1 - begin] - piece.end[begin]);
    line.normals.col(k) = smooth.normal(piece.triangle, line.points.col(k));
  }
  return line;
}

}  // namespace

std::vector<SurfaceLine> surface_lines(const TriangleMesh& mesh, const SmoothSurface& smooth,
                                       std::span<const std::uint32_t> triangles, const Eigen::Vector3d& direction,
                                       double along, double between, double largest_turn) {
  std::vector<SurfaceLine> lines;
  for_each_surface_line(mesh, smooth, triangles, direction, along, between, largest_turn,
                        [&](const SurfaceLine& line) { lines.push_back(line); });
  return lines;
}

void for_each_surface_line(const TriangleMesh& mesh, const SmoothSurface& smooth,
                           std::span<const std::uint32_t> triangles, const Eigen::Vector3d& direction, double along,
                           double between, double largest_turn, const std::function<void(const SurfaceLine&)>& visit) {
  constexpr double kSteepest = 0.05;
  struct Extent {
    double low, high, slope;  ///< slope: sine of the angle between the triangle's normal and the direction
  };
  std::vector<Extent> extents;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const std::uint32_t triangle : triangles) {
    const auto column = static_cast<Eigen::Index>(triangle);
    Extent extent{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 1};
    for (int k = 0; k < 3; ++k) {
      const double height = direction.dot(mesh.corner(column, k));
      extent.low = std::min(extent.low, height);
      extent.high = std::max(extent.high, height);
    }
    const Eigen::Vector3d a = mesh.corner(column, 0);
    const Eigen::Vector3d area = (mesh.corner(column, 1) - a).cross(mesh.corner(column, 2) - a);
    if (area.norm() > 0) extent.slope = std::max(kSteepest, area.normalized().cross(direction).norm());
    extents.push_back(extent);
    low = std::min(low, extent.low);
    high = std::max(high, extent.high);
  }
  if (!(high > low)) return;
  const auto step_at = [&](double height) {
    double slope = 1;
    for (const Extent& extent : extents) {
      if (extent.low <= height && extent.high >= height) slope = std::min(slope, extent.slope);
    }
    return between * slope;
  };
  const auto add = [&](double height) {
    const std::vector<Piece> pieces = cut(mesh, triangles, direction, height);
    std::vector<bool> closed;
    const std::vector<Chain> chains = chains_of(pieces, closed);
    for (std::size_t i = 0; i < chains.size(); ++i) {
      SurfaceLine line = spaced(pieces, chains[i], smooth, along, largest_turn);
      line.is_closed = closed[i];
      line.height = height;
      visit(line);
    }
  };
  // Half a step from both ends; a face lower than that has one line in its middle.
  double height = low + std::min(0.5 * step_at(low + 1e-6 * (high - low)), 0.5 * (high - low));
  while (height < high) {
    add(height);
    height += step_at(height);
  }
}

}  // namespace abbe
