#include "abbe/geometry/closest_point.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/surface_normals.h"
#include "abbe/geometry/surface_tree.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

Vector3d column(const std::array<surface::Leaf::Row, 3>& rows, std::size_t lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}

/// Where on a triangle the closest point lies.
struct OnTriangle {
  SurfaceFeature feature = SurfaceFeature::face;
  std::size_t which = 0;  ///< edge ab, bc, ca or vertex a, b, c
  Vector3d rest;          ///< from the closest point to the point
  double height = 0;      ///< over the plane
};

/// As triangle_squares() of the search, with the place.
OnTriangle on_triangle(const surface::Leaf& leaf, std::size_t lane, const Vector3d& point) {
  const Vector3d normal = column(leaf.normal, lane), ab = column(leaf.edge_ab, lane), ac = column(leaf.edge_ac, lane);
  const Vector3d bc = ac - ab, ap = point - column(leaf.corner, lane), bp = ap - ab;
  struct Edge {
    const Vector3d& from_start;
    const Vector3d& edge;
    double inverse_square;
    std::size_t which, start, end;
  };
  const Edge edges[] = {{ap, ab, leaf.inverse_square[0][lane], 0, 0, 1},
                        {ap, ac, leaf.inverse_square[1][lane], 2, 0, 2},
                        {bp, bc, leaf.inverse_square[2][lane], 1, 1, 2}};
  OnTriangle result;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Edge& e : edges) {
    const double t = std::min(std::max(e.from_start.dot(e.edge) * e.inverse_square, 0.0), 1.0);
    const Vector3d rest = e.from_start - t * e.edge;
    if (rest.squaredNorm() >= nearest) continue;
    nearest = rest.squaredNorm();
    result.rest = rest;
    result.feature = t > 0 && t < 1 ? SurfaceFeature::edge : SurfaceFeature::vertex;
    result.which = t > 0 && t < 1 ? e.which : (t > 0 ? e.end : e.start);
  }
  if (normal.squaredNorm() > 0.5 && normal.dot(ab.cross(ap)) >= 0 && normal.dot(ap.cross(ac)) >= 0 &&
      normal.dot(bc.cross(bp)) >= 0) {
    result.feature = SurfaceFeature::face;
    result.height = normal.dot(result.rest);
    result.rest = result.height * normal;
  }
  return result;
}

}  // namespace

struct ClosestPointFinder::Inside {
  surface::Tree tree;
  surface::Normals normals;

  SurfacePoint finish(const surface::Found& found, const Vector3d& point, const Vector3d& centred) const {
    const OnTriangle on = on_triangle(tree.leaves[found.slot.leaf], found.slot.lane, centred);
    SurfacePoint result;
    result.triangle = found.triangle;
    result.feature = on.feature;
    result.point = point - on.rest;
    const std::array<std::uint32_t, 3>& corners = normals.welded[found.triangle];
    switch (on.feature) {
      case SurfaceFeature::face:
        result.normal = normals.face[found.triangle];
        result.distance = on.height;
        return result;
      case SurfaceFeature::edge:
        result.normal = normals.edge(found.triangle, on.which);
        result.on_border = normals.is_border(found.triangle, on.which);
        break;
      case SurfaceFeature::vertex:
        result.normal = normals.vertex[corners[on.which]];
        result.on_border = normals.border_vertex[corners[on.which]] != 0;
        break;
    }
    result.distance = on.rest.dot(result.normal) < 0 ? -on.rest.norm() : on.rest.norm();
    return result;
  }

  template <class Take>
  void search(const Eigen::Ref<const Eigen::Matrix3Xd>& points, std::uint32_t* hints, const Take& take) const {
    constexpr std::uint32_t kLanes = static_cast<std::uint32_t>(surface::kWidth);
    constexpr Eigen::Index kSome = 256;
    surface::Slot starts[kSome];
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kSome> centred;
    surface::Found found[kSome];
    for (Eigen::Index first = 0; first < points.cols(); first += kSome) {
      const Eigen::Index count = std::min(kSome, points.cols() - first);
      centred = points.middleCols(first, count).colwise() - tree.centre;
      bool known = hints != nullptr;
      for (Eigen::Index i = 0; known && i < count; ++i) {
        known = hints[first + i] != kNoHint;
        starts[i] = {hints[first + i] / kLanes, hints[first + i] % kLanes};
      }
      surface::search_block(tree, centred.data(), static_cast<std::size_t>(count), known ? starts : nullptr, found);
      for (Eigen::Index i = 0; i < count; ++i) {
        if (hints != nullptr) hints[first + i] = found[i].slot.leaf * kLanes + found[i].slot.lane;
        take(first + i, finish(found[i], points.col(first + i), centred.col(i)));
      }
    }
  }
};

ClosestPointFinder::ClosestPointFinder(const TriangleMesh& mesh, int threads) {
  assert(mesh.size() > 0 && mesh.size() < (Eigen::Index{1} << 28));
  auto inside = std::make_unique<Inside>();
  inside->tree = surface::build_tree(mesh, threads);
  inside->normals = surface::surface_normals(mesh, threads);
  inside_ = std::move(inside);
}
ClosestPointFinder::~ClosestPointFinder() = default;
ClosestPointFinder::ClosestPointFinder(ClosestPointFinder&&) noexcept = default;
ClosestPointFinder& ClosestPointFinder::operator=(ClosestPointFinder&&) noexcept = default;

void ClosestPointFinder::closest_block(const Eigen::Ref<const Eigen::Matrix3Xd>& points, SurfacePoint* found,
                                       std::uint32_t* hints) const {
  inside_->search(points, hints, [&](Eigen::Index i, const SurfacePoint& point) { found[i] = point; });
}

std::vector<SurfacePoint> ClosestPointFinder::closest(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                      int threads) const {
  std::vector<SurfacePoint> found(static_cast<std::size_t>(points.cols()));
  for_each_block(static_cast<std::size_t>((points.cols() + kBlock - 1) / kBlock), threads, [&](std::size_t block) {
    const Eigen::Index first = static_cast<Eigen::Index>(block) * kBlock;
    closest_block(points.middleCols(first, std::min(kBlock, points.cols() - first)), found.data() + first);
  });
  return found;
}

SurfacePoint ClosestPointFinder::closest_to(const Vector3d& point) const {
  SurfacePoint found;
  closest_block(point, &found);
  return found;
}

Eigen::VectorXd ClosestPointFinder::signed_distances(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                     int threads) const {
  Eigen::VectorXd distances(points.cols());
  for_each_block(static_cast<std::size_t>((points.cols() + kBlock - 1) / kBlock), threads, [&](std::size_t block) {
    const Eigen::Index first = static_cast<Eigen::Index>(block) * kBlock;
    inside_->search(points.middleCols(first, std::min(kBlock, points.cols() - first)), nullptr,
                    [&](Eigen::Index i, const SurfacePoint& point) { distances[first + i] = point.distance; });
  });
  return distances;
}

}  // namespace abbe
