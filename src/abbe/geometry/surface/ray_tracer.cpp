#include "abbe/geometry/surface/ray_tracer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "abbe/geometry/surface/surface_tree.h"

namespace abbe {

struct RayTracer::Inside {
  TriangleMesh mesh;
  surface::Tree tree;
};

namespace {

using surface::kLeaf;
using surface::kNoChild;
using surface::kWidth;

/// A ray in the coordinates of the tree, prepared for both tests.
struct Ray {
  Eigen::Vector3d origin, direction, inverse;
  int x = 0, y = 1, z = 2;  ///< z: largest component of the direction; x, y so that the triangles keep their sense
  double shear_x = 0, shear_y = 0;

  Ray(const Eigen::Vector3d& from, const Eigen::Vector3d& along) : origin(from), direction(along) {
    direction.cwiseAbs().maxCoeff(&z);
    x = (z + 1) % 3;
    y = (z + 2) % 3;
    if (direction[z] < 0) std::swap(x, y);
    shear_x = direction[x] / direction[z];
    shear_y = direction[y] / direction[z];
    // Zero components become huge slopes instead of 0/0; boxes are rounded outwards by more than that costs.
    for (int i = 0; i < 3; ++i) {
      const double d = direction[i];
      inverse[i] = 1 / (std::abs(d) > 1e-200 ? d : std::copysign(1e-200, d));
    }
  }
};

/// Distance at which a ray enters a box, or infinity where it misses it between `from` and `to`.
double enters(const Ray& ray, const surface::Node& node, std::size_t child, double from, double to) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<int>(i);
    double a = (static_cast<double>(node.low[i][child]) - ray.origin[k]) * ray.inverse[k];
    double b = (static_cast<double>(node.high[i][child]) - ray.origin[k]) * ray.inverse[k];
    if (a > b) std::swap(a, b);
    from = std::max(from, a);
    to = std::min(to, b);
  }
  // A little slack: the slopes are rounded.
  return from <= to + 1e-12 * (1 + std::abs(to)) ? from : std::numeric_limits<double>::infinity();
}

/// Distance along the ray to a triangle, or infinity.
double meets(const Ray& ray, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  constexpr double kMissed = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d pa = a - ray.origin, pb = b - ray.origin, pc = c - ray.origin;
  const double ax = pa[ray.x] - ray.shear_x * pa[ray.z], ay = pa[ray.y] - ray.shear_y * pa[ray.z];
  const double bx = pb[ray.x] - ray.shear_x * pb[ray.z], by = pb[ray.y] - ray.shear_y * pb[ray.z];
  const double cx = pc[ray.x] - ray.shear_x * pc[ray.z], cy = pc[ray.y] - ray.shear_y * pc[ray.z];
  const double u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return kMissed;
  const double sum = u + v + w;
  if (sum == 0) return kMissed;
  return (u * pa[ray.z] + v * pb[ray.z] + w * pc[ray.z]) / (sum * ray.direction[ray.z]);
}

}  // namespace

RayTracer::RayTracer(const TriangleMesh& mesh, int threads)
    : inside_(std::make_unique<const Inside>(Inside{mesh, surface::build_tree(mesh, threads)})) {}
RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

std::optional<RayHit> RayTracer::first(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double from,
                                       double to) const {
  const surface::Tree& tree = inside_->tree;
  const Ray ray(origin - tree.centre, direction);
  struct Waiting {
    std::uint32_t child;
    double enters;
  };
  Waiting stack[8 * 64];  // at most seven more per level, of which there are fewer than 64
  std::size_t waiting = 1;
  stack[0] = {0, from};
  double nearest = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = 0;
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.enters > std::min(nearest, to)) continue;
    if (next.child >= kLeaf) {
      const surface::Leaf& leaf = tree.leaves[next.child - kLeaf];
      for (const std::uint32_t index : leaf.index) {
        const auto column = static_cast<Eigen::Index>(index);
        const double distance =
            meets(ray, inside_->mesh.corner(column, 0) - tree.centre, inside_->mesh.corner(column, 1) - tree.centre,
                  inside_->mesh.corner(column, 2) - tree.centre);
        if (!(distance >= from && distance <= to)) continue;
        if (distance < nearest || (distance == nearest && index < triangle)) {
          nearest = distance;
          triangle = index;
        }
      }
      continue;
    }
    const surface::Node& node = tree.nodes[next.child];
    const std::size_t begin = waiting;
    for (std::size_t child = 0; child < kWidth; ++child) {
      if (node.child[child] == kNoChild) continue;
      const double at = enters(ray, node, child, from, std::min(nearest, to));
      if (at < std::numeric_limits<double>::infinity()) stack[waiting++] = {node.child[child], at};
    }
    std::sort(stack + begin, stack + waiting, [](const Waiting& a, const Waiting& b) { return a.enters > b.enters; });
  }
  if (!(nearest < std::numeric_limits<double>::infinity())) return std::nullopt;
  const auto column = static_cast<Eigen::Index>(triangle);
  const Eigen::Vector3d a = inside_->mesh.corner(column, 0);
  const Eigen::Vector3d normal =
      (inside_->mesh.corner(column, 1) - a).cross(inside_->mesh.corner(column, 2) - a).normalized();
  return RayHit{nearest, triangle, normal};
}

}  // namespace abbe
