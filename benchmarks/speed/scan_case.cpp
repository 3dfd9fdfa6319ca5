#include "scan_case.h"

#include <algorithm>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/parts_for_test.h"
#include "abbe/geometry/rotation.h"

namespace abbe::benchmarks {

ScanCase::ScanCase(std::size_t around, std::size_t along, Eigen::Index points, double noise_mm, double outliers)
    : mesh(parts::blade(around, along)) {
  parts::Sample sample = parts::sample(mesh, points, 1);
  // Lines 0.1 mm apart, there and back.
  struct Place {
    long line = 0;
    double along = 0;
    Eigen::Index point = 0;
  };
  std::vector<Place> order;
  for (Eigen::Index i = 0; i < points; ++i) {
    const long line = static_cast<long>(sample.points(2, i) / 0.1);
    const double angle = std::atan2(sample.points(1, i), sample.points(0, i));
    order.push_back({line, line % 2 == 0 ? angle : -angle, i});
  }
  std::sort(order.begin(), order.end(),
            [](const Place& a, const Place& b) { return a.line != b.line ? a.line < b.line : a.along < b.along; });
  surface.resize(3, points);
  normals.resize(3, points);
  for (Eigen::Index i = 0; i < points; ++i) {
    surface.col(i) = sample.points.col(order[static_cast<std::size_t>(i)].point);
    normals.col(i) = sample.normals.col(order[static_cast<std::size_t>(i)].point);
  }
  test::Numbers numbers(2);
  scan = surface;
  for (Eigen::Index i = 0; i < points; ++i) scan.col(i) += noise_mm * numbers.normal() * normals.col(i);
  Eigen::Matrix3Xd placed = scan;
  const Eigen::Vector3d low = mesh.vertices.rowwise().minCoeff(), high = mesh.vertices.rowwise().maxCoeff();
  for (Eigen::Index i = 0; i < points; ++i) {
    if (numbers.uniform() >= outliers) continue;
    for (int k = 0; k < 3; ++k) placed(k, i) = numbers.uniform(low[k] - 2, high[k] + 2);
  }
  const Eigen::Vector3d middle = (low + high) / 2;
  const Eigen::Matrix3d turn = rotation_about(Eigen::Vector3d(1, 2, -1).normalized(), 0.03);
  mesh_from_scan = {turn, middle - turn * middle + Eigen::Vector3d(0.3, -0.2, 0.25)};
  const RigidTransform back = mesh_from_scan.inverse();
  moved = (back.rotation * placed).colwise() + back.translation;
}

double ScanCase::error_mm(const RigidTransform& found) const {
  const RigidTransform off = found * mesh_from_scan.inverse();
  double largest = 0;
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const Eigen::Vector3d vertex = mesh.vertices.col(v);
    largest = std::max(largest, (off * vertex - vertex).norm());
  }
  return largest;
}

}  // namespace abbe::benchmarks
