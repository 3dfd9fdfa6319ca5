#include "abbe/geometry/surface_faces.h"

#include <Eigen/Geometry>
#include <cmath>

#include "abbe/geometry/surface_normals.h"

namespace abbe {

SurfaceFaces surface_faces(const TriangleMesh& mesh, double crease_angle, int threads) {
  const surface::Normals normals = surface::surface_normals(mesh, threads);
  const double together = std::cos(crease_angle);
  constexpr std::uint32_t kNone = 0xffffffffu;
  SurfaceFaces faces;
  faces.face_of_triangle.assign(static_cast<std::size_t>(mesh.size()), kNone);
  std::vector<std::uint32_t> open;
  for (std::uint32_t first = 0; first < faces.face_of_triangle.size(); ++first) {
    if (faces.face_of_triangle[first] != kNone) continue;
    const std::uint32_t face = static_cast<std::uint32_t>(faces.area.size());
    double area = 0;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    faces.face_of_triangle[first] = face;
    open.assign(1, first);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      const Eigen::Index column = static_cast<Eigen::Index>(t);
      const Eigen::Vector3d a = mesh.corner(column, 0), b = mesh.corner(column, 1), c = mesh.corner(column, 2);
      const double part = (b - a).cross(c - a).norm() / 2;
      area += part;
      moment += part * (a + b + c) / 3;
      for (const std::uint32_t other : normals.neighbour[t]) {
        // Borders and edges of more than two triangles are edges.
        if (other >= faces.face_of_triangle.size() || faces.face_of_triangle[other] != kNone) continue;
        if (normals.face[t].dot(normals.face[other]) < together) continue;
        faces.face_of_triangle[other] = face;
        open.push_back(other);
      }
    }
    faces.area.push_back(area);
    faces.middle.push_back(area > 0 ? Eigen::Vector3d(moment / area)
                                    : mesh.corner(static_cast<Eigen::Index>(first), 0));
  }
  return faces;
}

}  // namespace abbe
