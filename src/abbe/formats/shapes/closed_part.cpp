#include "abbe/formats/shapes/closed_part.h"

#include <fmt/format.h>

#include <cstdint>
#include <vector>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/surface/mesh_check.h"
#include "abbe/geometry/surface/vertex_welder.h"

namespace abbe {
namespace {

TriangleMesh welded(const TriangleMesh& mesh) {
  VertexWelder welder(static_cast<std::size_t>(mesh.vertices.cols()));
  std::vector<std::uint32_t> index(static_cast<std::size_t>(mesh.vertices.cols()));
  welder.add({mesh.vertices.data(), static_cast<std::size_t>(mesh.vertices.size())}, index.data());
  TriangleMesh result;
  result.vertices = welder.vertices();
  result.triangles = mesh.triangles.unaryExpr([&](std::uint32_t vertex) { return index[vertex]; });
  return result;
}

}  // namespace

TriangleMesh closed_part(const TriangleMesh& mesh, const std::string& file) {
  TriangleMesh part = welded(mesh);
  const MeshCheck check = check_mesh(part);
  if (!check.encloses_volume()) {
    throw InputError({file, 0, 0, ""},
                     fmt::format("the surface is not closed or not oriented: {} edges of one triangle, {} of more than "
                                 "two, {} turned over",
                                 check.border_edges, check.branching_edges, check.turned_edges),
                     "a closed mesh; abbe check says more");
  }
  if (!(check.volume > 0)) {
    throw InputError({file, 0, 0, ""}, "the triangles look inwards", "normals out of the material");
  }
  return part;
}

}  // namespace abbe
