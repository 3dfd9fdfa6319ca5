#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/surface/hilbert_order.h"
#include "scan_yardsticks.h"

namespace abbe::benchmarks {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::size_t kBlock = 2048;

/// Square of the distance of a point from a segment from the origin.
double square_from_segment(const Vector3d& point, const Vector3d& along) {
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp(point.dot(along) / length, 0.0, 1.0) : 0.0;
  return (point - share * along).squaredNorm();
}

/// Square of the distance of a point from a triangle: from its plane if the foot is inside, else from its edges.
double square_from_triangle(const Vector3d& point, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, p = point - a;
  const double aa = ab.squaredNorm(), bb = ac.squaredNorm(), across = ab.dot(ac), pa = p.dot(ab), pb = p.dot(ac);
  const double area = aa * bb - across * across, v = bb * pa - across * pb, w = aa * pb - across * pa;
  if (v >= 0 && w >= 0 && v + w <= area && area > 0) {
    const Vector3d normal = ab.cross(ac);
    const double height = normal.dot(p);
    return height * height / normal.squaredNorm();
  }
  return std::min({square_from_segment(p, ab), square_from_segment(p, ac), square_from_segment(point - b, c - b)});
}

/// A query on its way: what its callback needs and what it has found.
struct Search {
  const TriangleMesh* mesh = nullptr;
  Vector3d point;
  float slack = 0;  ///< mm, more than single precision of coordinates takes away from a radius
  double square = std::numeric_limits<double>::infinity();
  unsigned triangle = 0;

  double square_from(unsigned number) const {
    return square_from_triangle(point, mesh->corner(number, 0), mesh->corner(number, 1), mesh->corner(number, 2));
  }
  float radius() const { return static_cast<float>(std::sqrt(square)) * (1 + 1e-6F) + slack; }
};

bool measure(RTCPointQueryFunctionArguments* arguments) {
  Search& search = *static_cast<Search*>(arguments->userPtr);
  const double square = search.square_from(arguments->primID);
  if (!(square < search.square)) return false;
  search.square = square;
  search.triangle = arguments->primID;
  arguments->query->radius = std::min(arguments->query->radius, search.radius());
  return true;
}

class Scene {
 public:
  explicit Scene(const TriangleMesh& mesh) : mesh_(mesh), device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto vertices = static_cast<std::size_t>(mesh.vertices.cols()),
               triangles = static_cast<std::size_t>(mesh.size());
    float* const places = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
    unsigned* const corners = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles));
    Eigen::Map<Eigen::Matrix3Xf>(places, 3, mesh.vertices.cols()) = mesh.vertices.cast<float>();
    std::copy_n(mesh.triangles.data(), 3 * triangles, corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  ~Scene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  /// @param order   [n] of the points
  /// @param seeded  the triangle of the point before bounds the first radius
  void distances(const Eigen::Matrix3Xd& points, const std::vector<std::uint32_t>& order, bool seeded,
                 std::vector<double>* found) const {
    const double largest = std::max(mesh_.vertices.cwiseAbs().maxCoeff(), points.cwiseAbs().maxCoeff());
    const float slack = 8 * std::numeric_limits<float>::epsilon() * static_cast<float>(largest);
    for_each_block((order.size() + kBlock - 1) / kBlock, 0, [&](std::size_t block) {
      Search search;
      search.mesh = &mesh_;
      search.slack = slack;
      RTCPointQueryContext context;
      rtcInitPointQueryContext(&context);
      const std::size_t first = block * kBlock, end = std::min(first + kBlock, order.size());
      for (std::size_t k = first; k < end; ++k) {
        search.point = points.col(order[k]);
        search.square =
            seeded && k > first ? search.square_from(search.triangle) : std::numeric_limits<double>::infinity();
        RTCPointQuery query;
        query.x = static_cast<float>(search.point.x());
        query.y = static_cast<float>(search.point.y());
        query.z = static_cast<float>(search.point.z());
        query.time = 0;
        query.radius = search.radius();
        rtcPointQuery(scene_, &query, &context, measure, &search);
        (*found)[order[k]] = std::sqrt(search.square);
      }
    });
  }

 private:
  const TriangleMesh& mesh_;
  RTCDevice device_;
  RTCScene scene_;
};

Outcome distances_by_embree(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points, bool sorted,
                            std::vector<double>* distances) {
  distances->resize(static_cast<std::size_t>(points.cols()));
  Outcome outcome;
  double start = now_s();
  const Scene scene(mesh);
  outcome.prepare_s = now_s() - start;
  start = now_s();
  std::vector<std::uint32_t> order(distances->size());
  if (sorted) {
    order = hilbert_order(points, mesh.vertices.rowwise().minCoeff(), mesh.vertices.rowwise().maxCoeff(), 0);
  } else {
    std::iota(order.begin(), order.end(), 0U);
  }
  scene.distances(points, order, sorted, distances);
  outcome.run_s = now_s() - start;
  return outcome;
}

}  // namespace

Outcome embree_distances(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points, std::vector<double>* distances) {
  return distances_by_embree(mesh, points, false, distances);
}

Outcome embree_sorted_distances(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points,
                                std::vector<double>* distances) {
  return distances_by_embree(mesh, points, true, distances);
}

}  // namespace abbe::benchmarks
