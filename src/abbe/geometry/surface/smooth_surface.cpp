#include "abbe/geometry/surface/smooth_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/surface/surface_normals.h"

namespace abbe {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Corners (3 * triangle + which) in the order of their vertices.
struct CornersOfVertices {
  std::vector<std::uint32_t> begin, corners;

  CornersOfVertices(const surface::Normals& normals, std::size_t vertices) : begin(vertices + 1, 0) {
    for (const auto& triangle : normals.welded) {
      for (const std::uint32_t v : triangle) ++begin[v + 1];
    }
    for (std::size_t v = 0; v < vertices; ++v) begin[v + 1] += begin[v];
    corners.resize(begin.back());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::size_t t = 0; t < normals.welded.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) corners[next[normals.welded[t][k]]++] = static_cast<std::uint32_t>(3 * t + k);
    }
  }
};

}  // namespace

SmoothSurface::SmoothSurface(const TriangleMesh& mesh, double crease_angle, int threads) {
  const surface::Normals normals = surface::surface_normals(mesh, threads);
  const CornersOfVertices around(normals, static_cast<std::size_t>(mesh.vertices.cols()));
  const double together = std::cos(crease_angle);
  faces_.resize(static_cast<std::size_t>(mesh.size()));
  std::vector<std::array<double, 3>> angles(faces_.size());
  constexpr std::size_t kBlock = 16384;
  const auto for_each_face = [&](const auto& work) {
    for_each_block((faces_.size() + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
      for (std::size_t t = block * kBlock; t < std::min(faces_.size(), (block + 1) * kBlock); ++t) work(t);
    });
  };
  for_each_face([&](std::size_t t) {
    const Eigen::Index i = static_cast<Eigen::Index>(t);
    Face& face = faces_[t];
    face.corner = mesh.corner(i, 0);
    face.ab = mesh.corner(i, 1) - face.corner;
    face.ac = mesh.corner(i, 2) - face.corner;
    const Vector3d bc = face.ac - face.ab;
    const double area = face.ab.cross(face.ac).norm();
    angles[t] = {std::atan2(area, face.ab.dot(face.ac)), std::atan2(area, -face.ab.dot(bc)),
                 std::atan2(area, face.ac.dot(bc))};
  });
  for_each_face([&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = normals.welded[t][k];
      Vector3d sum = Vector3d::Zero();
      for (std::uint32_t c = around.begin[vertex]; c < around.begin[vertex + 1]; ++c) {
        const std::uint32_t other = around.corners[c] / 3;
        if (normals.face[other].dot(normals.face[t]) < together) continue;
        sum += angles[other][around.corners[c] % 3] * normals.face[other];
      }
      faces_[t].normal[k] = (sum.norm() > 0 ? Vector3d(sum.normalized()) : normals.face[t]).cast<float>();
    }
  });
}

Vector3d SmoothSurface::normal(std::uint32_t triangle, const Vector3d& point) const {
  const Face& face = faces_[triangle];
  const Vector3d across = face.ab.cross(face.ac), from = point - face.corner;
  const double square = across.squaredNorm();
  if (!(square > 0)) return face.normal[0].cast<double>();
  const double v = std::clamp(across.dot(from.cross(face.ac)) / square, 0.0, 1.0);
  const double w = std::clamp(across.dot(face.ab.cross(from)) / square, 0.0, 1.0);
  const Vector3d mixed = std::max(0.0, 1 - v - w) * face.normal[0].cast<double>() + v * face.normal[1].cast<double>() +
                         w * face.normal[2].cast<double>();
  return mixed.norm() > 0 ? Vector3d(mixed.normalized()) : Vector3d(across / std::sqrt(square));
}

SmoothSurface::Curvature SmoothSurface::curvature(std::uint32_t triangle) const {
  const Face& face = faces_[triangle];
  Curvature result;
  const Vector3d across = face.ab.cross(face.ac);
  const double area = across.norm(), length = face.ab.norm();
  // Of a needle the change of the normal across it is mostly rounding.
  if (!(area > 1e-6 * std::max(face.ab.squaredNorm(), face.ac.squaredNorm()))) {
    result.direction[0] = result.direction[1] = Vector3d::Zero();
    return result;
  }
  const Vector3d x = face.ab / length, y = (across / area).cross(x);
  Matrix2d edges, turns;
  edges << length, face.ac.dot(x), 0, face.ac.dot(y);
  const Vector3d turn_ab = (face.normal[1] - face.normal[0]).cast<double>(),
                 turn_ac = (face.normal[2] - face.normal[0]).cast<double>();
  turns << turn_ab.dot(x), turn_ac.dot(x), turn_ab.dot(y), turn_ac.dot(y);
  const Matrix2d shape = turns * edges.inverse();
  // Eigenvalues and eigenvectors in closed form; the vector is the one of two that does not suffer from cancellation.
  const double mean = 0.5 * shape.trace(), half = 0.5 * (shape(0, 0) - shape(1, 1)),
               twist = 0.5 * (shape(0, 1) + shape(1, 0)), radius = std::hypot(half, twist);
  Vector2d most = half >= 0 ? Vector2d(half + radius, twist) : Vector2d(twist, radius - half);
  most = radius > 0 ? Vector2d(most / std::hypot(most.x(), most.y())) : Vector2d(Vector2d::UnitX());
  result.value[0] = mean - radius;
  result.value[1] = mean + radius;
  result.direction[0] = -most.y() * x + most.x() * y;
  result.direction[1] = most.x() * x + most.y() * y;
  return result;
}

}  // namespace abbe
