#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>

#include <cmath>

#include "scan_yardsticks.h"

namespace abbe::benchmarks {

Outcome pcl_distances(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points, std::vector<double>* distances) {
  const pcl::PointCloud<pcl::PointXYZ>::Ptr vertices(new pcl::PointCloud<pcl::PointXYZ>);
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const Eigen::Vector3f p = mesh.vertices.col(i).cast<float>();
    vertices->emplace_back(p.x(), p.y(), p.z());
  }
  Outcome outcome;
  double start = now_s();
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(vertices);
  outcome.prepare_s = now_s() - start;
  start = now_s();
  distances->resize(static_cast<std::size_t>(points.cols()));
#pragma omp parallel
  {
    std::vector<int> index(1);
    std::vector<float> square(1);
#pragma omp for
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Eigen::Vector3f p = points.col(i).cast<float>();
      tree.nearestKSearch(pcl::PointXYZ(p.x(), p.y(), p.z()), 1, index, square);
      (*distances)[static_cast<std::size_t>(i)] = std::sqrt(static_cast<double>(square[0]));
    }
  }
  outcome.run_s = now_s() - start;
  return outcome;
}

Outcome pcl_registration(const ScanCase& data, double reach_mm) {
  using Cloud = pcl::PointCloud<pcl::PointNormal>;
  const Cloud::Ptr part(new Cloud), scan(new Cloud);
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, data.mesh.vertices.cols());
  for (Eigen::Index t = 0; t < data.mesh.size(); ++t) {
    const Eigen::Vector3d a = data.mesh.corner(t, 0);
    const Eigen::Vector3d normal = (data.mesh.corner(t, 1) - a).cross(data.mesh.corner(t, 2) - a);
    for (int k = 0; k < 3; ++k) normals.col(data.mesh.triangles(k, t)) += normal;
  }
  const auto point = [](const Eigen::Vector3d& place, const Eigen::Vector3d& normal) {
    pcl::PointNormal result;
    result.getVector3fMap() = place.cast<float>();
    result.getNormalVector3fMap() = normal.cast<float>();
    return result;
  };
  for (Eigen::Index i = 0; i < data.mesh.vertices.cols(); ++i) {
    part->push_back(point(data.mesh.vertices.col(i), normals.col(i).normalized()));
  }
  for (Eigen::Index i = 0; i < data.moved.cols(); ++i) {
    scan->push_back(point(data.moved.col(i), Eigen::Vector3d::UnitZ()));
  }
  Outcome outcome;
  const double start = now_s();
  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
  icp.setInputSource(scan);
  icp.setInputTarget(part);
  icp.setMaxCorrespondenceDistance(reach_mm);
  icp.setMaximumIterations(60);
  icp.setTransformationEpsilon(1e-12);
  Cloud placed;
  icp.align(placed);
  outcome.run_s = now_s() - start;
  const Eigen::Matrix4d found = icp.getFinalTransformation().cast<double>();
  outcome.error_mm = data.error_mm({found.topLeftCorner<3, 3>(), Eigen::Vector3d(found.topRightCorner<3, 1>())});
  return outcome;
}

}  // namespace abbe::benchmarks
