#include "abbe/geometry/surface/surface_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/even_choice.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

double uniform(std::mt19937_64& generator) { return static_cast<double>(generator() >> 11) * 0x1p-53; }

/// At most so many points take part; more do not make the normals better.
constexpr Eigen::Index kMostPoints = 60000;

/// Points sorted into the cells of a cubic grid.
class Cells {
 public:
  using Key = std::array<std::int32_t, 3>;
  struct Entry {
    Key key;
    Eigen::Index point;
    bool operator<(const Entry& other) const {
      for (std::size_t k = 0; k < 3; ++k) {
        if (key[k] != other.key[k]) return key[k] < other.key[k];
      }
      return point < other.point;
    }
  };

  /// @param count  of the points, about
  Cells(const Eigen::Matrix3Xd& points, Eigen::Index count, double size) : size_(size) {
    const EvenChoice some(points.cols(), count);
    for (Eigen::Index k = 0; k < some.size(); ++k) entries_.push_back({key(points.col(some[k])), some[k]});
    sort();
  }

  Key key(const Vector3d& point) const {
    Key result;
    for (int k = 0; k < 3; ++k) {
      // Farther away than any part is only one more cell.
      result[static_cast<std::size_t>(k)] =
          static_cast<std::int32_t>(std::clamp(std::floor(point[k] / size_), -1e9, 1e9));
    }
    return result;
  }
  const std::vector<Entry>& entries() const { return entries_; }

  /// Calls visit(point) for the points of the 27 cells around.
  template <class Visit>
  void around(const Key& key, const Visit& visit) const {
    for (std::int32_t x = -1; x <= 1; ++x) {
      for (std::int32_t y = -1; y <= 1; ++y) {
        const Key from{key[0] + x, key[1] + y, key[2] - 1}, to{key[0] + x, key[1] + y, key[2] + 1};
        for (auto at = std::lower_bound(entries_.begin(), entries_.end(), Entry{from, -1});
             at != entries_.end() && at->key <= to; ++at) {
          visit(at->point);
        }
      }
    }
  }

 private:
  /// The points are in order already. Where there are few cells, each is counted.
  void sort() {
    constexpr std::int64_t kFewCells = std::int64_t{1} << 18;
    if (entries_.empty()) return;
    Key low = entries_.front().key, high = low;
    for (const Entry& entry : entries_) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], entry.key[k]);
        high[k] = std::max(high[k], entry.key[k]);
      }
    }
    std::array<std::int64_t, 3> side{};
    std::int64_t cells = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      side[k] = std::int64_t{high[k]} - low[k] + 1;
      if (side[k] > kFewCells / cells) return std::sort(entries_.begin(), entries_.end());
      cells *= side[k];
    }
    const auto number = [&](const Entry& entry) {
      std::int64_t at = 0;
      for (std::size_t k = 0; k < 3; ++k) at = at * side[k] + (entry.key[k] - low[k]);
      return static_cast<std::size_t>(at);
    };
    std::vector<std::size_t> next(static_cast<std::size_t>(cells) + 1);
    for (const Entry& entry : entries_) ++next[number(entry) + 1];
    for (std::size_t cell = 1; cell < next.size(); ++cell) next[cell] += next[cell - 1];
    std::vector<Entry> sorted(entries_.size());
    for (const Entry& entry : entries_) sorted[next[number(entry)]++] = entry;
    entries_ = std::move(sorted);
  }

  double size_ = 1;
  std::vector<Entry> entries_;
};

/// Normal of the plane through the points within a radius; zero if they form none.
Vector3d plane_normal(const Eigen::Matrix3Xd& points, const Cells& cells, Eigen::Index point, double radius) {
  Vector3d sum = Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double count = 0;
  cells.around(cells.key(points.col(point)), [&](Eigen::Index other) {
    const Vector3d away = points.col(other) - points.col(point);
    if (away.squaredNorm() > radius * radius) return;
    sum += away;
    squares += away * away.transpose();
    count += 1;
  });
  if (count < 6) return Vector3d::Zero();
  const SymmetricEigen<3> solver(squares - sum * sum.transpose() / count);
  if (!(solver.eigenvalues()[0] < 0.1 * solver.eigenvalues()[1])) return Vector3d::Zero();
  return solver.eigenvectors().col(0);
}

Eigen::Matrix3Xd columns_of(const std::vector<Vector3d>& vectors) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(vectors.size()));
  for (std::size_t i = 0; i < vectors.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = vectors[i];
  return result;
}

}  // namespace

PointCloud sample_surface(const TriangleMesh& mesh, Eigen::Index count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::vector<double> area{0};
  for (Eigen::Index t = 0; t < mesh.size(); ++t) {
    const Vector3d a = mesh.corner(t, 0);
    area.push_back(area.back() + (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm());
  }
  PointCloud cloud;
  if (!(area.back() > 0)) return cloud;
  cloud.points.resize(3, count);
  cloud.normals.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = area.back() * (static_cast<double>(i) + uniform(generator)) / static_cast<double>(count);
    const auto above = std::upper_bound(area.begin() + 1, area.end() - 1, at);
    const Eigen::Index t = static_cast<Eigen::Index>(above - area.begin()) - 1;
    double u = uniform(generator), v = uniform(generator);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Vector3d a = mesh.corner(t, 0), ab = mesh.corner(t, 1) - a, ac = mesh.corner(t, 2) - a;
    cloud.points.col(i) = a + u * ab + v * ac;
    cloud.normals.col(i) = ab.cross(ac).normalized();
  }
  return cloud;
}

ThinnedScan thin_scan(const PointCloud& cloud, double cell) {
  ThinnedScan result;
  result.outwards = cloud.has_normals();
  const Cells cells(cloud.points, kMostPoints, cell);
  std::vector<Vector3d> places, points, normals;
  const std::vector<Cells::Entry>& entries = cells.entries();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    // The middle one in the order of the scan stands for its cell.
    std::size_t end = i;
    while (end + 1 < entries.size() && entries[end + 1].key == entries[i].key) ++end;
    const Eigen::Index point = entries[(i + end) / 2].point;
    i = end;
    places.emplace_back(cloud.points.col(point));
    const Vector3d normal =
        result.outwards ? Vector3d(cloud.normals.col(point)) : plane_normal(cloud.points, cells, point, cell);
    if (!(normal.norm() > 0.5)) continue;
    points.push_back(cloud.points.col(point));
    normals.push_back(normal.normalized());
  }
  result.places = columns_of(places);
  result.points = columns_of(points);
  result.normals = columns_of(normals);
  return result;
}

}  // namespace abbe
