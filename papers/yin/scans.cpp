#include "yin/scans.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/triangulation.h"
#include "yin/constants.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

const Vector3d kMoved(150, -60, 0);
const Vector3d kSphere(40, 150, yin::kSphereHeight);
const Vector3d kTarget(-120, 40, 14);  // of X and Y
const std::array<Vector3d, 2> kTurning = {Vector3d(150, 60, 10), Vector3d(-90, 70, 45)};

/// Bodies made of triangles, one after the other.
class Scene {
 public:
  /// A convex polygon drawn up from one height to another. @param outline  anticlockwise seen from above
  void add_prism(const std::vector<Eigen::Vector2d>& outline, double from, double to) {
    const std::size_t n = outline.size(), first = vertices_.size();
    for (const double z : {from, to}) {
      for (const Eigen::Vector2d& p : outline) vertices_.emplace_back(p.x(), p.y(), z);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t next = (i + 1) % n;
      triangles_.push_back({first + i, first + next, first + n + next});
      triangles_.push_back({first + i, first + n + next, first + n + i});
      if (i == 0 || next == 0) continue;
      triangles_.push_back({first, first + next, first + i});
      triangles_.push_back({first + n, first + n + i, first + n + next});
    }
  }
  void add_ball(const Vector3d& centre, double radius) {
    constexpr std::size_t kAround = 48, kUp = 24;
    const std::size_t first = vertices_.size();
    for (std::size_t i = 0; i <= kUp; ++i) {
      for (std::size_t k = 0; k < kAround; ++k) {
        const double up = std::numbers::pi * (static_cast<double>(i) / kUp - 0.5);
        const double around = 2 * std::numbers::pi * static_cast<double>(k) / kAround;
        vertices_.push_back(
            centre + radius * Vector3d(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up)));
      }
    }
    for (std::size_t i = 0; i < kUp; ++i) {
      for (std::size_t k = 0; k < kAround; ++k) {
        const std::size_t a = first + i * kAround + k, b = first + i * kAround + (k + 1) % kAround;
        triangles_.push_back({a, b, b + kAround});
        triangles_.push_back({a, b + kAround, a + kAround});
      }
    }
  }
  void move(std::size_t from, const RigidTransform& motion) {
    for (std::size_t i = from; i < vertices_.size(); ++i) vertices_[i] = motion * vertices_[i];
  }
  std::size_t size() const { return vertices_.size(); }
  TriangleMesh mesh() const {
    TriangleMesh mesh;
    mesh.vertices.resize(3, static_cast<Index>(vertices_.size()));
    mesh.triangles.resize(3, static_cast<Index>(triangles_.size()));
    for (std::size_t i = 0; i < vertices_.size(); ++i) mesh.vertices.col(static_cast<Index>(i)) = vertices_[i];
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        mesh.triangles(k, static_cast<Index>(i)) =
            static_cast<std::uint32_t>(triangles_[i][static_cast<std::size_t>(k)]);
      }
    }
    return mesh;
  }

 private:
  std::vector<Vector3d> vertices_;
  std::vector<std::array<std::size_t, 3>> triangles_;
};

Scene scene_with(const Placement& placement, const Shape& cylinder) {
  Scene scene;
  std::vector<Eigen::Vector2d> disc, post;
  for (int i = 0; i < 72; ++i) {
    const Eigen::Vector2d around(std::cos(5 * i * kDegree), std::sin(5 * i * kDegree));
    disc.push_back(260 * around);
    post.push_back(kSphere.head<2>() + 4 * around);
  }
  scene.add_prism(disc, -30, 0);
  scene.add_prism(post, 0, yin::kSphereHeight - 12);
  scene.add_ball(kSphere, yin::kSphereRadius);
  const std::size_t part = scene.size();
  std::vector<Eigen::Vector2d> outline = {{70, -20}, {155, -20}};
  for (int i = 0; i <= 40; ++i) {
    const double x = 155 - 85.0 * i / 40, off = x - cylinder.point.x();
    outline.emplace_back(x, cylinder.point.y() + std::sqrt(cylinder.radius * cylinder.radius - off * off));
  }
  scene.add_prism(outline, 120, 205);
  scene.move(part, placement.table_from_workpiece);
  return scene;
}

/// A scanner that stands there and looks at a place, its baseline level.
RigidTransform looking_at(const Vector3d& from, const Vector3d& at) {
  const Vector3d z = (at - from).normalized(), x = z.cross(Vector3d::UnitZ()).normalized();
  RigidTransform t;
  t.rotation << x, z.cross(x), z;
  t.translation = from;
  return t;
}

double rounded_to_a_nanometre(double mm) { return std::round(1e6 * mm) / 1e6; }

std::vector<Vector3d> list_of(const Eigen::Matrix3Xd& points) {
  std::vector<Vector3d> list;
  for (Index i = 0; i < points.cols(); ++i) list.emplace_back(points.col(i));
  return list;
}

}  // namespace

YinScans yin_simulated_scans(std::uint64_t seed) {
  const std::vector<Shape> part = yin_part();
  YinScans result;
  // Table 3 by the paper's words: p_workpiece = D p_table.
  result.placement.table_from_workpiece = RigidTransform{
      rotation_xyz(kDegree * Vector3d(yin::kTable3[3], yin::kTable3[4], yin::kTable3[5])),
      {yin::kTable3[0], yin::kTable3[1],
       yin::kTable3[2]}}.inverse();
  result.table_from_scanner = looking_at({820, 420, 740}, {120, -20, 100});
  const RayTracer scene(scene_with(result.placement, part[0]).mesh());
  RandomStream random(seed);
  AreaScanner scanner;
  scanner.noise = yin::kTargetNoise;
  // The table carries everything: seen from it, the scanner moves the other way.
  const auto target = [&](const Vector3d& place, const RigidTransform& table_moves, std::vector<Vector3d>& points) {
    const Eigen::Matrix3Xd seen = scan_places(scanner, scene, table_moves.inverse() * result.table_from_scanner, place,
                                              Vector3d::UnitZ(), random);
    ++result.targets_placed;
    if (seen.cols() == 0) return;
    ++result.targets_seen;
    points.emplace_back(seen.col(0));
  };
  PositioningScans& scans = result.scans;
  for (int i = 0; i <= 10; ++i) {
    target(kTarget, RigidTransform::translate(Vector3d(20.0 * i, 0, 0)), scans.along_x);
    target(kTarget, RigidTransform::translate(Vector3d(0, -20.0 * i, 0)), scans.along_y);
  }
  // Moved back towards +Y: the list is in the positive sense.
  std::reverse(scans.along_y.begin(), scans.along_y.end());
  scans.circles.resize(kTurning.size());
  for (std::size_t k = 0; k < kTurning.size(); ++k) {
    for (int i = 0; i < 18; ++i) {
      target(kTurning[k], RigidTransform::rotate(rotation_about(Vector3d::UnitZ(), 20 * i * kDegree)),
             scans.circles[k]);
    }
  }
  scans.sphere_radius = yin::kSphereRadius;
  scans.sphere_height = yin::kSphereHeight + yin::kHeightNoise * random.normal();
  scans.moved_since = kMoved;
  scans.target_noise = yin::kTargetNoise;
  scans.sphere_noise = yin::kSurfaceNoise;
  scans.height_noise = yin::kHeightNoise;

  scanner.noise = yin::kSurfaceNoise;
  Eigen::Matrix3Xd places(3, 300), normals(3, 300);
  for (Index i = 0; i < places.cols(); ++i) {
    const double z = random.normal(), y = random.normal(), x = random.normal();
    normals.col(i) = Vector3d(x, y, z).normalized();
    places.col(i) = kSphere + yin::kSphereRadius * normals.col(i);
  }
  scans.sphere = list_of(scan_places(scanner, scene, result.table_from_scanner, places, normals, random));
  result.surface_placed = 300;
  result.surface_seen = scans.sphere.size();

  // The workpiece is scanned with the table moved on: the scanner's place on the table is another one.
  const RigidTransform later = RigidTransform::translate(-kMoved) * result.table_from_scanner;
  const RigidTransform table_from_workpiece = result.placement.table_from_workpiece;
  std::vector<Eigen::Matrix3Xd> surfaces;
  for (std::size_t f = 0; f < part.size(); ++f) {
    places.resize(3, 180);
    normals.resize(3, 180);
    for (Index i = 0; i < places.cols(); ++i) {
      const double x = random.uniform(75, 152), z = random.uniform(125, 203), back = random.uniform(1, 30);
      const double off = x - part[0].point.x();
      const double y = part[0].point.y() + std::sqrt(part[0].radius * part[0].radius - off * off);
      const Vector3d place = f == 0   ? Vector3d(x, y, z)
                             : f == 1 ? Vector3d(x, y - back, 205)
                                      : Vector3d(155, y - back - 5, z);
      const Vector3d normal =
          f == 0 ? Vector3d((place - part[0].point).cwiseProduct(Vector3d(1, 1, 0)).normalized()) : part[f].direction;
      places.col(i) = table_from_workpiece * place;
      normals.col(i) = table_from_workpiece.rotation * normal;
    }
    surfaces.push_back(scan_places(scanner, scene, later, places, normals, random));
    result.surface_placed += 180;
    result.surface_seen += static_cast<std::size_t>(surfaces.back().cols());
    result.labels.insert(result.labels.end(), static_cast<std::size_t>(surfaces.back().cols()), f);
  }
  result.surface.resize(3, static_cast<Index>(result.labels.size()));
  result.surface << surfaces[0], surfaces[1], surfaces[2];
  result.table_from_scanner = later;
  const RigidTransform truth = table_from_workpiece.inverse() * later;
  result.start = {rotation_from_vector({0.006, -0.004, 0.005}) * truth.rotation,
                  truth.translation + Vector3d(3, -4, 2)};
  return result;
}

YinScansFound yin_locate(const YinScans& scans) {
  YinScansFound found;
  YinPositioning& p = found.positioning;
  p.scanner = locate_scanner(scans.scans);
  FeatureRegistrationOptions options;
  options.noise_mm = yin::kSurfaceNoise;
  p.registration = register_to_features(scans.surface, yin_part(), scans.labels, scans.start, options);
  place_workpiece(p);
  if (!p.failure.empty()) return found;
  const PositioningParameters truth = positioning_parameters(scans.placement, true);
  Eigen::Matrix<double, 6, 1> off;
  off << p.table_to_workpiece.translation - truth.translation, p.table_to_workpiece.angles - truth.angles;
  found.chi_square = off.dot(Ldlt<6>(p.table_to_workpiece.covariance).solve(off));
  p.largest_difference = off.head<3>().norm();
  return found;
}

YinScanFiles yin_scan_files(const YinScans& scans, const std::string& points_file) {
  ScannerPositioningFile file;
  file.scans = scans.scans;
  file.scans.sphere_height = rounded_to_a_nanometre(scans.scans.sphere_height);
  WorkpieceScan& workpiece = file.workpiece.emplace();
  workpiece.features = yin_part();
  workpiece.points = scans.surface;
  workpiece.labels = scans.labels;
  workpiece.start = scans.start;
  workpiece.start.translation = scans.start.translation.unaryExpr(&rounded_to_a_nanometre);
  workpiece.noise = yin::kSurfaceNoise;
  const std::vector<std::string> names = {"cylinder", "top", "side"};
  return {
      "# A structured-light scanner beside Yin's engraver: targets while X and Y carry the table and while it "
      "turns, a\n"
      "# standard sphere, and the clamped part. Simulated: what is hidden from projector or camera is not there.\n"
      "#\n#   abbe position examples/laser_engraver/scanner.positioning.toml -o part.placement.toml\n" +
          scanner_positioning_text(file, points_file, names),
      target_points_csv(positioning_targets(file, names))};
}

}  // namespace abbe
