#include "abbe/geometry/surface/closest_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/surface/hilbert_order.h"
#include "abbe/geometry/surface/surface_normals.h"
#include "abbe/geometry/surface/surface_tree.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

Vector3d vector_of(const surface::Coordinates& v) { return {v.x, v.y, v.z}; }

}  // namespace

struct ClosestPointFinder::Inside {
  surface::Tree tree;
  surface::Normals normals;

  SurfacePoint finish(const surface::Found& found, const Vector3d& point) const {
    const surface::Place& place = found.place;
    const Vector3d rest = vector_of(place.rest);
    SurfacePoint result;
    result.triangle = found.triangle;
    result.feature = place.feature;
    result.point = point - rest;
    switch (place.feature) {
      case SurfaceFeature::face:
        result.normal = normals.face[found.triangle];
        result.distance = place.height;
        return result;
      case SurfaceFeature::edge:
        result.normal = normals.edge(found.triangle, place.which);
        result.on_border = normals.is_border(found.triangle, place.which);
        break;
      case SurfaceFeature::vertex: {
        const std::uint32_t vertex = normals.welded[found.triangle][place.which];
        result.normal = normals.vertex[vertex];
        result.on_border = normals.border_vertex[vertex] != 0;
        break;
      }
    }
    result.distance = rest.dot(result.normal) < 0 ? -rest.norm() : rest.norm();
    return result;
  }

  /// @param take  called with the number of each point and what was found
  template <class Take>
  void search(const Eigen::Ref<const Eigen::Matrix3Xd>& points, std::uint32_t* hints, const Take& take) const {
    constexpr Eigen::Index kSome = 128;
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kSome> centred;
    surface::Found found[kSome];
    for (Eigen::Index first = 0; first < points.cols(); first += kSome) {
      const Eigen::Index count = std::min(kSome, points.cols() - first);
      centred = points.middleCols(first, count).colwise() - tree.centre;
      const bool known =
          hints != nullptr && std::find(hints + first, hints + first + count, kNoHint) == hints + first + count;
      surface::search_block(tree, centred.data(), static_cast<std::size_t>(count), known ? hints + first : nullptr,
                            found);
      for (Eigen::Index i = 0; i < count; ++i) {
        if (hints != nullptr) hints[first + i] = found[i].leaf;
        take(first + i, finish(found[i], points.col(first + i)));
      }
    }
  }

  /// All points, many of them in an order in which neighbours follow each other.
  template <class Take>
  void search_all(const Eigen::Ref<const Eigen::Matrix3Xd>& points, int threads, const std::stop_token& stop,
                  const Take& take) const {
    // A part of very many points keeps the numbers small and the memory for them bounded.
    constexpr Eigen::Index kPart = Eigen::Index{1} << 23;
    for (Eigen::Index from = 0; from < points.cols(); from += kPart) {
      const auto part = points.middleCols(from, std::min(kPart, points.cols() - from));
      const std::size_t blocks = static_cast<std::size_t>((part.cols() + kBlock - 1) / kBlock);
      if (blocks == 1) return search(part, nullptr, [&](Eigen::Index i, const SurfacePoint& p) { take(from + i, p); });
      const Vector3d half = (tree.high - tree.low) / 2;
      const std::vector<std::uint32_t> order =
          hilbert_order(part, part.rowwise().minCoeff().cwiseMax(tree.low - half),
                        part.rowwise().maxCoeff().cwiseMin(tree.high + half), threads);
      for_each_block(blocks, threads, [&](std::size_t block) {
        stop_if_asked(stop);
        const Eigen::Index first = static_cast<Eigen::Index>(block) * kBlock;
        Eigen::Matrix3Xd some(3, std::min(kBlock, part.cols() - first));
        const std::uint32_t* number = order.data() + first;
        for (Eigen::Index i = 0; i < some.cols(); ++i) some.col(i) = part.col(number[i]);
        search(some, nullptr, [&](Eigen::Index i, const SurfacePoint& p) { take(from + number[i], p); });
      });
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

std::vector<SurfacePoint> ClosestPointFinder::closest(const Eigen::Ref<const Eigen::Matrix3Xd>& points, int threads,
                                                      const std::stop_token& stop) const {
  std::vector<SurfacePoint> found(static_cast<std::size_t>(points.cols()));
  inside_->search_all(points, threads, stop,
                      [&](Eigen::Index i, const SurfacePoint& point) { found[static_cast<std::size_t>(i)] = point; });
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
  inside_->search_all(points, threads, {},
                      [&](Eigen::Index i, const SurfacePoint& point) { distances[i] = point.distance; });
  return distances;
}

}  // namespace abbe
