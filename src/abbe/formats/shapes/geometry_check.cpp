#include "abbe/formats/shapes/geometry_check.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "abbe/geometry/surface/vertex_welder.h"

namespace abbe {
namespace {

/// Points beyond the first at the same place.
std::size_t repeated_points(const Eigen::Matrix3Xd& points) {
  const auto count = static_cast<std::size_t>(points.cols());
  VertexWelder welder(count);
  std::vector<std::uint32_t> indices(count);
  welder.add({points.data(), 3 * count}, indices.data());
  return count - welder.size();
}

}  // namespace

CheckedMesh checked_mesh(MeshFile file) {
  CheckedMesh checked;
  checked.check = check_mesh(file.mesh);
  checked.repeated = repeated_points(file.mesh.vertices);
  checked.file = std::move(file);
  return checked;
}

CheckedCloud checked_cloud(PointCloudFile file) {
  CheckedCloud checked;
  const Eigen::Matrix3Xd& points = file.cloud.points;
  checked.lower = points.rowwise().minCoeff();
  checked.upper = points.rowwise().maxCoeff();
  const Eigen::Vector3d middle = 0.5 * (checked.lower + checked.upper);
  checked.centroid = middle + (points.colwise() - middle).rowwise().mean();
  checked.repeated = repeated_points(points);
  checked.file = std::move(file);
  return checked;
}

}  // namespace abbe
