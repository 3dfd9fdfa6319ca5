#include <open3d/core/Tensor.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/pipelines/registration/RobustKernel.h>
#include <open3d/pipelines/registration/TransformationEstimation.h>
#include <open3d/t/geometry/RaycastingScene.h>

#include "scan_yardsticks.h"

namespace abbe::benchmarks {

using open3d::core::Tensor;

Outcome open3d_distances(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points, std::vector<double>* distances) {
  // In its own form before the clock runs.
  const Eigen::Matrix3Xf vertices = mesh.vertices.cast<float>(), queries = points.cast<float>();
  const Tensor vertex_tensor(vertices.data(), {vertices.cols(), 3}, open3d::core::Float32);
  const Tensor triangle_tensor(mesh.triangles.data(), {mesh.triangles.cols(), 3}, open3d::core::UInt32);
  const Tensor query_tensor(queries.data(), {queries.cols(), 3}, open3d::core::Float32);
  Outcome outcome;
  double start = now_s();
  open3d::t::geometry::RaycastingScene scene;
  scene.AddTriangles(vertex_tensor, triangle_tensor);
  // The first query builds the tree.
  scene.ComputeSignedDistance(query_tensor.Slice(0, 0, 1));
  outcome.prepare_s = now_s() - start;
  start = now_s();
  const Tensor found = scene.ComputeSignedDistance(query_tensor);
  outcome.run_s = now_s() - start;
  const float* values = found.GetDataPtr<float>();
  distances->assign(values, values + points.cols());
  return outcome;
}

Outcome open3d_registration(const ScanCase& data, double reach_mm) {
  namespace registration = open3d::pipelines::registration;
  open3d::geometry::PointCloud scan;
  for (Eigen::Index i = 0; i < data.moved.cols(); ++i) scan.points_.push_back(data.moved.col(i));
  open3d::geometry::TriangleMesh mesh;
  for (Eigen::Index i = 0; i < data.mesh.vertices.cols(); ++i) mesh.vertices_.push_back(data.mesh.vertices.col(i));
  for (Eigen::Index i = 0; i < data.mesh.size(); ++i) mesh.triangles_.push_back(data.mesh.triangles.col(i).cast<int>());
  Outcome outcome;
  double start = now_s();
  mesh.ComputeVertexNormals();
  open3d::geometry::PointCloud part;
  part.points_ = mesh.vertices_;
  part.normals_ = mesh.vertex_normals_;
  outcome.prepare_s = now_s() - start;
  start = now_s();
  const auto kernel = std::make_shared<registration::TukeyLoss>(0.05);
  const registration::RegistrationResult found = registration::RegistrationICP(
      scan, part, reach_mm, Eigen::Matrix4d::Identity(), registration::TransformationEstimationPointToPlane(kernel),
      registration::ICPConvergenceCriteria(1e-8, 1e-8, 60));
  outcome.run_s = now_s() - start;
  outcome.error_mm = data.error_mm(
      {found.transformation_.topLeftCorner<3, 3>(), Eigen::Vector3d(found.transformation_.topRightCorner<3, 1>())});
  return outcome;
}

}  // namespace abbe::benchmarks
