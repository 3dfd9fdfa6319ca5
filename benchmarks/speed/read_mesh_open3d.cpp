#include "read_mesh_open3d.h"

#include <open3d/geometry/TriangleMesh.h>
#include <open3d/io/TriangleMeshIO.h>
#include <open3d/utility/Logging.h>

namespace abbe::benchmarks {

std::size_t open3d_triangles(const std::string& path) {
  open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);
  open3d::geometry::TriangleMesh mesh;
  open3d::io::ReadTriangleMeshOptions options;
  options.print_progress = false;
  return open3d::io::ReadTriangleMesh(path, mesh, options) ? mesh.triangles_.size() : 0;
}

}  // namespace abbe::benchmarks
