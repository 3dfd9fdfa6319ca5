#include "abbe/geometry/surface/surface_faces.h"

#include <Eigen/Geometry>
#include <cmath>

#include "abbe/geometry/surface/surface_normals.h"

namespace abbe {

namespace {

/// Areas and middles; a face without area has its middle at a corner of its first triangle.
void measure(const TriangleMesh& mesh, std::size_t count, SurfaceFaces* faces) {
  faces->area.assign(count, 0);
  faces->middle.assign(count, Eigen::Vector3d::Zero());
  std::vector<Eigen::Index> first(count, -1);
  for (Eigen::Index t = 0; t < mesh.size(); ++t) {
    const std::uint32_t face = faces->face_of_triangle[static_cast<std::size_t>(t)];
    const Eigen::Vector3d a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const double part = (b - a).cross(c - a).norm() / 2;
    faces->area[face] += part;
    faces->middle[face] += part * (a + b + c) / 3;
    if (first[face] < 0) first[face] = t;
  }
  for (std::size_t face = 0; face < count; ++face) {
    if (faces->area[face] > 0) {
      faces->middle[face] /= faces->area[face];
    } else if (first[face] >= 0) {
      faces->middle[face] = mesh.corner(first[face], 0);
    }
  }
}

}  // namespace

SurfaceFaces surface_faces(const TriangleMesh& mesh, double crease_angle, int threads) {
  const surface::Normals normals = surface::surface_normals(mesh, threads);
  const double together = std::cos(crease_angle);
  constexpr std::uint32_t kNone = 0xffffffffu;
  SurfaceFaces faces;
  faces.face_of_triangle.assign(static_cast<std::size_t>(mesh.size()), kNone);
  std::vector<std::uint32_t> open;
  std::size_t count = 0;
  for (std::uint32_t first = 0; first < faces.face_of_triangle.size(); ++first) {
    if (faces.face_of_triangle[first] != kNone) continue;
    const std::uint32_t face = static_cast<std::uint32_t>(count);
    faces.face_of_triangle[first] = face;
    open.assign(1, first);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (const std::uint32_t other : normals.neighbour[t]) {
        // Borders and edges of more than two triangles are edges.
        if (other >= faces.face_of_triangle.size() || faces.face_of_triangle[other] != kNone) continue;
        if (normals.face[t].dot(normals.face[other]) < together) continue;
        faces.face_of_triangle[other] = face;
        open.push_back(other);
      }
    }
    ++count;
  }
  measure(mesh, count, &faces);
  return faces;
}

SurfaceFaces stated_faces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& face_of_triangle,
                          std::size_t faces) {
  SurfaceFaces result;
  result.face_of_triangle = face_of_triangle;
  measure(mesh, faces, &result);
  return result;
}

}  // namespace abbe
