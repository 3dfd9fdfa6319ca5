#include "abbe/geometry/fits/revolution_axis.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kSphereTolerance = 2e-3;  // of the radius: the centre comes from flat triangles
constexpr double kLeastDepth = 0.95;       // of a triangle below the centre, by the radius

struct Facet {
  Eigen::Vector3d centre, twice_area;
};

Facet facet(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto column = static_cast<Eigen::Index>(triangle);
  const Eigen::Vector3d a = mesh.corner(column, 0), b = mesh.corner(column, 1), c = mesh.corner(column, 2);
  return {(a + b + c) / 3, (b - a).cross(c - a)};
}

}  // namespace

std::vector<RevolutionAxis> revolution_axes(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                                            std::span<const Eigen::Vector3d> directions) {
  double area = 0, spread = 0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const std::uint32_t triangle : triangles) {
    const Facet f = facet(mesh, triangle);
    area += f.twice_area.norm();
    middle += f.twice_area.norm() * f.centre;
  }
  if (!(area > 0)) return {};
  middle /= area;
  for (const std::uint32_t triangle : triangles) {
    const Facet f = facet(mesh, triangle);
    spread += f.twice_area.norm() * (f.centre - middle).squaredNorm();
  }
  const double size = std::sqrt(spread / area);
  if (!(size > 0)) return {};
  Matrix6 sum = Matrix6::Zero();
  for (const std::uint32_t triangle : triangles) {
    const Facet f = facet(mesh, triangle);
    const double weight = f.twice_area.norm();
    if (!(weight > 0)) continue;
    const Eigen::Vector3d normal = f.twice_area / weight, place = (f.centre - middle) / size;
    Vector6 line;
    line << place.cross(normal), normal;
    sum += weight / area * line * line.transpose();
  }
  const SymmetricEigen<6> solver(sum);  // ascending
  const Matrix6& motions = solver.eigenvectors();
  std::vector<RevolutionAxis> axes;
  for (Eigen::Index count = 1; count <= 2; ++count) {
    // Of all mixtures of these motions the one that turns most.
    const Eigen::MatrixXd turns = motions.topLeftCorner(3, count);
    const SymmetricEigen<> most((turns.transpose() * turns).eval());
    const Vector6 motion = motions.leftCols(count) * most.eigenvectors().col(count - 1);
    const Eigen::Vector3d turn = motion.head<3>(), shift = motion.tail<3>();
    if (turn.norm() < 0.05) continue;
    // The point that does not move but along the axis.
    const Eigen::Vector3d still = turn.cross(shift) / turn.squaredNorm();
    axes.push_back({middle + size * still, turn.normalized()});
  }
  // A sphere: the point that none of three motions moves.
  Eigen::Matrix3d normal_equations = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Vector3d turn = motions.col(i).head<3>(), shift = motions.col(i).tail<3>();
    // turn x p + shift = 0
    const Eigen::Matrix3d cross = skew(turn);
    normal_equations += cross.transpose() * cross;
    right -= cross.transpose() * shift;
  }
  const FullLu<3> centre(normal_equations);
  if (!(centre.reciprocal_condition() > 1e-6)) return axes;
  const Eigen::Vector3d point = middle + size * centre.solve(right);
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0, deepest = nearest;
  for (const std::uint32_t triangle : triangles) {
    const Facet f = facet(mesh, triangle);
    if (f.twice_area.norm() > 0) deepest = std::min(deepest, std::abs(f.twice_area.normalized().dot(f.centre - point)));
    for (int k = 0; k < 3; ++k) {
      const double radius = (mesh.corner(static_cast<Eigen::Index>(triangle), k) - point).norm();
      nearest = std::min(nearest, radius);
      farthest = std::max(farthest, radius);
    }
  }
  // The corners of long strips of a cylinder lie on a sphere too, but the strips lie deep in it.
  if (farthest - nearest > kSphereTolerance * farthest || deepest < kLeastDepth * farthest) return axes;
  for (const Eigen::Vector3d& direction : directions) axes.push_back({point, direction});
  return axes;
}

double revolution_deviation(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                            const RevolutionAxis& axis) {
  double largest = 0;
  for (const std::uint32_t triangle : triangles) {
    const auto column = static_cast<Eigen::Index>(triangle);
    const Eigen::Vector3d twice = facet(mesh, triangle).twice_area;
    const double norm = twice.norm();
    if (!(norm > 0)) continue;
    const Eigen::Vector3d moment = (twice / norm).cross(axis.direction);
    std::array<double, 3> miss{};
    for (int k = 0; k < 3; ++k) {
      miss[static_cast<std::size_t>(k)] = moment.dot(mesh.corner(column, k) - axis.point);
    }
    const auto [low, high] = std::minmax_element(miss.begin(), miss.end());
    largest = std::max({largest, *low, -*high});
  }
  return largest;
}

}  // namespace abbe
