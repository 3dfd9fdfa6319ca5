#include "abbe/geometry/surface/mesh_thinning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/surface/vertex_welder.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Number of the cube of every vertex, in the order in which they are met.
struct Cubes {
  std::vector<std::uint32_t> of_vertex;
  Eigen::Matrix3Xd place;  ///< [3, cubes] in cubes from the lower corner
};

Cubes cubes_of(const TriangleMesh& mesh, const Vector3d& lower, double cell) {
  const Eigen::Matrix3Xd place = ((mesh.vertices.colwise() - lower) / cell).array().floor().matrix();
  VertexWelder welder(static_cast<std::size_t>(place.cols()));
  Cubes cubes;
  cubes.of_vertex.resize(static_cast<std::size_t>(place.cols()));
  welder.add({place.data(), static_cast<std::size_t>(place.size())}, cubes.of_vertex.data());
  cubes.place = welder.vertices();
  return cubes;
}

Index triangles_left(const TriangleMesh& mesh, const Cubes& cubes) {
  Index count = 0;
  for (Index t = 0; t < mesh.size(); ++t) {
    const std::uint32_t a = cubes.of_vertex[mesh.triangles(0, t)], b = cubes.of_vertex[mesh.triangles(1, t)],
                        c = cubes.of_vertex[mesh.triangles(2, t)];
    if (a != b && b != c && c != a) ++count;
  }
  return count;
}

/// Squared distances from the planes of triangles about a mean point: x' A x - 2 b' x.
struct Quadric {
  Matrix3d a = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero(), sum = Vector3d::Zero();
  double area = 0;

  /// Where the planes meet best, as near to the mean as they allow; from the corner of the cube.
  Vector3d best(double cell) const {
    const Vector3d mean = sum / area;
    const SymmetricEigen<3> solver(a);
    const double largest = solver.eigenvalues()[2];
    Vector3d point = mean;
    for (int k = 0; k < 3; ++k) {
      // Planes that are nearly parallel say nothing of the place along them.
      if (!(solver.eigenvalues()[k] > 1e-3 * largest)) continue;
      const Vector3d v = solver.eigenvectors().col(k);
      point += v * (v.dot(b - a * mean) / solver.eigenvalues()[k]);
    }
    // Planes that meet far away are nearly parallel: then the mean.
    const bool is_near = (point.array() >= -0.5 * cell).all() && (point.array() <= 1.5 * cell).all();
    return is_near ? point : mean;
  }
};

TriangleMesh joined(const TriangleMesh& mesh, const Cubes& cubes, const Vector3d& lower, double cell) {
  const std::size_t count = static_cast<std::size_t>(cubes.place.cols());
  std::vector<Quadric> quadrics(count);
  const auto corner_of = [&](std::size_t cube) -> Vector3d {
    return lower + cell * cubes.place.col(static_cast<Index>(cube));
  };
  for (Index t = 0; t < mesh.size(); ++t) {
    const Vector3d corners[] = {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
    const Vector3d twice = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double area = twice.norm() / 2;
    const Vector3d normal = area > 0 ? Vector3d(twice / (2 * area)) : Vector3d(Vector3d::Zero());
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t cube = cubes.of_vertex[mesh.triangles(k, t)];
      // About the corner of the cube: far from the origin nothing is left of the digits otherwise.
      const Vector3d at = corners[k] - corner_of(cube);
      Quadric& q = quadrics[cube];
      const double weight = std::max(area, 1e-300);
      q.a += weight * normal * normal.transpose();
      q.b += weight * normal * normal.dot(at);
      q.sum += weight * at;
      q.area += weight;
    }
  }
  TriangleMesh result;
  result.vertices.resize(3, static_cast<Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d at = quadrics[i].area > 0 ? quadrics[i].best(cell) : Vector3d(Vector3d::Zero());
    result.vertices.col(static_cast<Index>(i)) = corner_of(i) + at;
  }
  result.triangles.resize(3, triangles_left(mesh, cubes));
  Index next = 0;
  for (Index t = 0; t < mesh.size(); ++t) {
    const std::uint32_t a = cubes.of_vertex[mesh.triangles(0, t)], b = cubes.of_vertex[mesh.triangles(1, t)],
                        c = cubes.of_vertex[mesh.triangles(2, t)];
    if (a != b && b != c && c != a) result.triangles.col(next++) << a, b, c;
  }
  return result;
}

}  // namespace

ThinnedMesh thinned_mesh(const TriangleMesh& mesh, Index most_triangles) {
  if (mesh.size() <= most_triangles) return {mesh, 0};
  const Vector3d lower = mesh.vertices.rowwise().minCoeff(), upper = mesh.vertices.rowwise().maxCoeff();
  const double size = std::max((upper - lower).maxCoeff(), 1e-9);
  // The number falls with the cell: the smallest one that is enough, to a few per cent.
  double enough = size, too_small = 0;
  double cell = size / std::sqrt(static_cast<double>(most_triangles));
  for (int step = 0; step < 12 && enough > 1.03 * too_small; ++step) {
    const Index left = triangles_left(mesh, cubes_of(mesh, lower, cell));
    (left <= most_triangles ? enough : too_small) = cell;
    if (left <= most_triangles && 20 * left > 19 * most_triangles) break;
    // On a surface the number goes with the square of the cell.
    const double guess =
        cell * std::sqrt(std::max(1.0, static_cast<double>(left)) / (0.97 * static_cast<double>(most_triangles)));
    const double middle = too_small > 0 ? std::sqrt(too_small * enough) : enough / 2;
    cell = guess > 1.01 * too_small && guess < 0.99 * enough ? guess : middle;
  }
  return {joined(mesh, cubes_of(mesh, lower, enough), lower, enough), enough};
}

}  // namespace abbe
