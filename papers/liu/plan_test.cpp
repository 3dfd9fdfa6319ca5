#include "liu/plan.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/readings/scan_plan_file.h"
#include "liu/machine.h"

// The planned paths against the parts as formulas, the machine as the closed form of the paper, and the probe against
// points all over the surfaces: nothing here is what the planner computes with.
namespace abbe {
namespace {

using std::numbers::pi;
using Solid = std::function<double(const Eigen::Vector3d&)>;  ///< below zero in the material

/// A row of the path as it is written.
struct Row {
  double time = 0, c = 0, a = 0;  // s, rad
  Eigen::Vector3d linear, point, beam;
  bool measures = false;
  int face = 0, line = 0;
};

/// The functional point and the beam by the closed form: p = R_C(-beta) R_A(-alpha) (P_0 + [x, y, z]).
struct Probe {
  Eigen::Vector3d point, beam;
};

Probe probe_at(double c, double a, const Eigen::Vector3d& linear) {
  const Eigen::Matrix3d turned =
      (Eigen::AngleAxisd(-c, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-a, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return {turned * (Eigen::Vector3d(0, 0, 10) + linear), turned.col(2)};
}

Probe between(const Row& from, const Row& to, double share) {
  const auto mixed = [&](const auto& x, const auto& y) { return (x + share * (y - x)); };
  return probe_at(mixed(from.c, to.c), mixed(from.a, to.a), Eigen::Vector3d(mixed(from.linear, to.linear)));
}

std::vector<Row> rows_of(const std::string& csv) {
  std::istringstream text(csv);
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "time_s,C_deg,A_deg,X_mm,Y_mm,Z_mm,measures,blocked,face,line,x_mm,y_mm,z_mm,i,j,k");
  std::vector<Row> rows;
  while (std::getline(text, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    Row row;
    fields >> row.time >> row.c >> row.a;
    for (double& x : row.linear) fields >> x;
    int blocked = 1;
    fields >> row.measures >> blocked >> row.face >> row.line;
    EXPECT_EQ(blocked, 0) << line;
    for (double& x : row.point) fields >> x;
    for (double& x : row.beam) fields >> x;
    EXPECT_TRUE(fields) << line;
    row.c *= pi / 180;
    row.a *= pi / 180;
    rows.push_back(row);
  }
  return rows;
}

/// Unit normal of the surface of a solid, by differences.
Eigen::Vector3d normal_of(const Solid& solid, const Eigen::Vector3d& point) {
  constexpr double kStep = 1e-6;
  Eigen::Vector3d slope;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    slope[i] = solid(point + step) - solid(point - step);
  }
  return slope.normalized();
}

/// Points all over a mesh, evenly by area at random.
struct Sample {
  Eigen::Vector3d point, normal;
};
std::vector<Sample> samples_of(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  std::vector<double> area(static_cast<std::size_t>(mesh.size()) + 1, 0.0);
  const auto twice = [&](Eigen::Index t) {
    return Eigen::Vector3d((mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)));
  };
  for (std::size_t t = 0; t + 1 < area.size(); ++t) {
    area[t + 1] = area[t] + 0.5 * twice(static_cast<Eigen::Index>(t)).norm();
  }
  std::vector<Sample> samples;
  for (std::size_t k = 0; k < count; ++k) {
    RandomStream random(seed, k);
    const auto place = std::upper_bound(area.begin() + 1, area.end() - 1, random.uniform(0, area.back()));
    const auto t = static_cast<Eigen::Index>(place - area.begin() - 1);
    double u = random.uniform(0, 1), v = random.uniform(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Eigen::Vector3d a = mesh.corner(t, 0);
    samples.push_back({a + u * (mesh.corner(t, 1) - a) + v * (mesh.corner(t, 2) - a), twice(t).normalized()});
  }
  return samples;
}

struct Checked {
  LiuPart part;
  Solid solid;                       ///< frame of the part
  RigidTransform clamping;           ///< workpiece_from_part
  double wanted_area = 0;            ///< mm^2, 0: not known in closed form
  std::vector<std::size_t> kinds{};  ///< faces: rotary, raster, free
  double least_cosine = 0.7;         ///< between normals of one face within a few points
};

bool part_is_wanted(const LiuPart& part, const Eigen::Vector3d& point, double margin) {
  return std::all_of(part.wanted.begin(), part.wanted.end(),
                     [&](const HalfSpace& half) { return half.normal.dot(point) >= half.offset - margin; });
}

/// Angles, range, travel, working distance and collisions on the whole path, times and feed.
void expect_path_keeps_its_limits(const Checked& checked, const ScanPlanOptions& options, const ScanPlan& plan,
                                  const Machine& machine) {
  const std::vector<Row> rows = rows_of(scan_plan_csv(machine, plan));
  ASSERT_GT(rows.size(), 100U);
  const RigidTransform part_from_workpiece = checked.clamping.inverse();
  const Solid solid = [&](const Eigen::Vector3d& point) { return checked.solid(part_from_workpiece * point); };
  const auto normal = [&](const Eigen::Vector3d& point) { return normal_of(solid, point); };
  std::vector<Eigen::Vector3d> obstacles;
  for (const Sample& sample : samples_of(*options.stage, 3000, 1)) obstacles.push_back(sample.point);
  for (const Sample& sample : samples_of(checked.part.mesh, 3000, 2)) {
    obstacles.push_back(checked.clamping * sample.point);
  }
  // What is within the rod is nearer to its axis than its radius; some clearance is left.
  const auto rod_is_free = [&](const Probe& probe) {
    for (const Eigen::Vector3d& obstacle : obstacles) {
      const Eigen::Vector3d from = obstacle - probe.point;
      const double along = from.dot(probe.beam);
      if (along < options.working_distance || along > options.working_distance + options.probe_length) continue;
      if (from.squaredNorm() - along * along < options.probe_radius * options.probe_radius) return false;
    }
    return true;
  };
  const auto beam_is_free = [&](const Probe& probe) {
    for (double at = 0.3; at < options.working_distance; at += 0.3) {
      if (solid(probe.point + at * probe.beam) <= 0) return false;
    }
    return true;
  };
  const double half_range = 0.5 * options.range;
  const auto is_in_range = [&](const Probe& probe) {
    return solid(probe.point - half_range * probe.beam) < 0 && solid(probe.point + half_range * probe.beam) > 0;
  };
  std::size_t out_of_range = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    for (const double position : row.linear) ASSERT_LE(std::abs(position), 100.0) << k;
    const Probe probe = probe_at(row.c, row.a, row.linear);
    // Every row, and the ways between: those that go around in steps of a fraction of the probe.
    ASSERT_TRUE(rod_is_free(probe)) << checked.part.name << " " << k << (row.measures ? " measures" : "");
    ASSERT_TRUE(beam_is_free(probe)) << checked.part.name << " " << k;
    if (k > 0) {
      const Row& before = rows[k - 1];
      const double turn = std::max(std::abs(row.c - before.c), std::abs(row.a - before.a));
      const double length = (row.linear - before.linear).cwiseAbs().maxCoeff();
      const bool is_line = row.measures && before.measures;
      const int steps = is_line ? 2 : 1 + static_cast<int>(std::ceil(turn / 0.03 + length / 1.5));
      for (int i = 1; i < steps; ++i) {
        const Probe on_way = between(before, row, static_cast<double>(i) / steps);
        ASSERT_TRUE(rod_is_free(on_way)) << checked.part.name << " between " << k - 1 << " and " << k;
        if (is_line) {
          out_of_range += is_in_range(on_way) ? 0U : 1U;
        } else {
          ASSERT_TRUE(beam_is_free(on_way)) << checked.part.name << " between " << k - 1 << " and " << k;
        }
      }
      // The time is that of the slowest axis and of the probe, to the four digits that are written.
      const double least = std::max({turn / options.rotary_speed, length / options.linear_speed,
                                     row.measures ? 1 / options.readings_per_second : 0.0});
      ASSERT_NEAR(row.time - before.time, least, 2e-4) << k;
    }
    if (!row.measures) continue;
    ASSERT_LT((probe.point - row.point).norm(), 2e-6) << k;
    ASSERT_LT((probe.beam - row.beam).norm(), 1e-8) << k;
    ASSERT_TRUE(part_is_wanted(checked.part, part_from_workpiece * row.point, 1e-6)) << k;
    // On the surface to the chord error of the mesh.
    ASSERT_LT(solid(row.point - 0.004 * row.beam), 0) << checked.part.name << " " << k;
    ASSERT_GT(solid(row.point + 0.004 * row.beam), 0) << checked.part.name << " " << k;
    // On an edge the point is of the face that it was planned on: what holds 0.01 mm beside it counts.
    double cosine = normal(row.point).dot(row.beam);
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d beside = row.point + (i < 3 ? 0.01 : -0.01) * Eigen::Vector3d::Unit(i % 3);
      cosine = std::max(cosine, normal(beside).dot(row.beam));
    }
    ASSERT_GE(cosine, std::cos(options.largest_angle)) << checked.part.name << " " << k;
  }
  EXPECT_EQ(out_of_range, 0U) << checked.part.name;
}

/// Share of the wanted surface near measured points, by points all over it.
void expect_stated_coverage(const Checked& checked, const ScanPlanOptions& options, const ScanPlan& plan) {
  const double radius = 0.75 * std::hypot(options.along, options.between);
  std::vector<Sample> measured;
  const RigidTransform part_from_workpiece = checked.clamping.inverse();
  for (const PlannedMove& move : plan.moves) {
    if (!move.measures) continue;
    const Eigen::Vector3d point = part_from_workpiece * move.point;
    measured.push_back({point, normal_of(checked.solid, point)});
  }
  std::size_t near = 0, wanted = 0;
  constexpr std::size_t kSamples = 6000;
  for (const Sample& sample : samples_of(checked.part.mesh, kSamples, 3)) {
    if (!part_is_wanted(checked.part, sample.point, 0)) continue;
    ++wanted;
    // Points beyond an edge do not count: their normals are others.
    near += std::any_of(measured.begin(), measured.end(),
                        [&](const Sample& m) {
                          return (m.point - sample.point).squaredNorm() <= radius * radius &&
                                 m.normal.dot(sample.normal) > checked.least_cosine;
                        })
                ? 1U
                : 0U;
  }
  double area = 0;
  for (Eigen::Index t = 0; t < checked.part.mesh.size(); ++t) {
    const TriangleMesh& mesh = checked.part.mesh;
    area += 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm();
  }
  const double wanted_area = area * static_cast<double>(wanted) / kSamples;
  EXPECT_NEAR(plan.covered_share(), static_cast<double>(near) / static_cast<double>(wanted), 0.015)
      << checked.part.name;
  EXPECT_NEAR(plan.area() / wanted_area, 1, 0.05) << checked.part.name;
  if (checked.wanted_area > 0) {
    EXPECT_NEAR(plan.area() / checked.wanted_area, 1, 0.01) << checked.part.name;
  }
  double sum = 0;
  for (const PlannedFace& face : plan.faces) {
    sum += face.covered;
    for (const double uncovered : face.uncovered) sum += uncovered;
  }
  EXPECT_NEAR(sum, plan.area(), 1e-6 * plan.area());
}

Solid cylinder_about_y(double radius, double half) {
  return [=](const Eigen::Vector3d& p) { return std::max(std::hypot(p.x(), p.z()) - radius, std::abs(p.y()) - half); };
}

Solid cross() {
  return [](const Eigen::Vector3d& p) {
    return std::min(std::max(std::hypot(p.x(), p.z()) - 6, std::abs(p.y()) - 18),
                    std::max(std::hypot(p.y(), p.z()) - 4, std::abs(p.x()) - 14));
  };
}

Solid pyramid() {
  return [](const Eigen::Vector3d& p) {
    // Cube corner with its tip at y = 5; hexagonal handle whose corners lie where those of the squares do.
    const double out = 5 * std::sqrt(2.0 / 3);
    double outside = -20 - p.y();
    for (int k = 0; k < 6; ++k) {
      const double middle = pi / 3 * (k + 0.5);
      outside = std::max(outside, p.x() * std::sin(middle) + p.z() * std::cos(middle) - out * std::cos(pi / 6));
    }
    for (int k = 1; k < 6; k += 2) {
      // A face through the tip whose far corner is at the angle pi/3 k, inclined as those of a cube's corner.
      const double azimuth = pi / 3 * k;
      const Eigen::Vector3d normal(std::sqrt(2.0 / 3) * std::sin(azimuth), std::sqrt(1.0 / 3),
                                   std::sqrt(2.0 / 3) * std::cos(azimuth));
      outside = std::max(outside, normal.dot(p - Eigen::Vector3d(0, 5, 0)));
    }
    return outside;
  };
}

Solid sphere() {
  return [](const Eigen::Vector3d& p) { return p.norm() - 12.703; };
}

Solid blade() {
  return [](const Eigen::Vector3d& p) {
    const double turned = 40 * pi / 180 * p.y() / 24;
    const double a = p.x() * std::cos(turned) - p.z() * std::sin(turned),
                 b = p.x() * std::sin(turned) + p.z() * std::cos(turned);
    return std::max(1.5 * (std::hypot(a / 7, b / 1.5) - 1), std::abs(p.y()) - 12);
  };
}

void check_part(const Checked& checked) {
  const Machine machine = liu_machine();
  ScanPlanOptions options = liu_plan_options(checked.part, checked.clamping);
  options.along = options.between = 2;
  const ScanPlan plan = plan_scan(machine, checked.part.mesh, options);
  EXPECT_EQ(plan.blocked_links, 0U) << checked.part.name;
  expect_path_keeps_its_limits(checked, options, plan, machine);
  expect_stated_coverage(checked, options, plan);
  std::vector<std::size_t> kinds(3, 0);
  for (const PlannedFace& face : plan.faces) {
    if (face.area > 0) ++kinds[static_cast<std::size_t>(face.kind)];
  }
  EXPECT_EQ(kinds, checked.kinds) << checked.part.name;
}

const RigidTransform kStraight{};
RigidTransform clamped() { return liu_clamping(LiuUnit::micrometre); }

TEST(LiuPlan, TheStandardCylinderTurnsBelowTheProbe) {
  check_part({liu_cylinder(10, 0), cylinder_about_y(10, 15), kStraight, 2 * pi * 10 * 23.5, {1, 0, 0}});
  check_part({liu_cylinder(10, 0), cylinder_about_y(10, 15), clamped(), 2 * pi * 10 * 23.5, {1, 0, 0}});
}

TEST(LiuPlan, TheCrossCylinderTurnsAboutBothOfItsAxes) {
  // Main wall and two arms; four flat ends.
  check_part({liu_cross_cylinder(), cross(), kStraight, 0, {3, 4, 0}});
  check_part({liu_cross_cylinder(), cross(), clamped(), 0, {3, 4, 0}});
}

TEST(LiuPlan, ThePyramidIsRastersOnly) {
  check_part({liu_pyramid(), pyramid(), kStraight, 0, {0, 10, 0}});
  check_part({liu_pyramid(), pyramid(), clamped(), 0, {0, 10, 0}});
}

TEST(LiuPlan, CapsOfTheSphereTurnBelowTheProbe) {
  for (const double share : {0.25, 0.5, 0.7}) {
    check_part({liu_sphere(share), sphere(), clamped(), share * 4 * pi * 12.703 * 12.703, {1, 0, 0}});
  }
}

TEST(LiuPlan, TheBladeIsFollowedFreely) {
  check_part({liu_blade(), blade(), kStraight, 0, {0, 2, 1}, 0.3});
  check_part({liu_blade(), blade(), clamped(), 0, {0, 2, 1}, 0.3});
}

TEST(LiuPlan, ATiltedClampingIsTurnedByTheSameAxisWithTheBeamBesideTheNormal) {
  const Machine machine = liu_machine();
  const LiuPart part = liu_cylinder(10, 0);
  ScanPlanOptions options = liu_plan_options(part, clamped());
  options.along = options.between = 3;
  const ScanPlan plan = plan_scan(machine, part.mesh, options);
  const double tilt = std::acos(clamped().rotation(1, 1));
  EXPECT_NEAR(tilt, 6.1 * pi / 180, 0.1 * pi / 180);
  std::size_t rotary = 0;
  for (const PlannedFace& face : plan.faces) {
    if (face.kind != ScanPathKind::rotary) continue;
    ++rotary;
    EXPECT_EQ(face.turning_axis, machine.find_axis("C"));
    EXPECT_NEAR(face.axis_tilt, tilt, 1e-4);
    EXPECT_NEAR(face.largest_angle, tilt, 1e-3);
  }
  EXPECT_EQ(rotary, 1U);
  // A stays where it is.
  for (std::size_t k = 0; k < plan.moves.size(); ++k) {
    if (plan.moves[k].measures) {
      ASSERT_LT(std::abs(std::sin(plan.positions.axis[machine.find_axis("A")][k])), 1e-3);
    }
  }
}

TEST(LiuPlan, SaysWhichAxisTurnsForEachWallOfTheCrossCylinder) {
  const Machine machine = liu_machine();
  ScanPlanOptions options = liu_plan_options(liu_cross_cylinder(), {});
  options.along = options.between = 3;
  const ScanPlan plan = plan_scan(machine, liu_cross_cylinder().mesh, options);
  std::size_t by_c = 0, by_a = 0;
  for (std::size_t face = 0; face < plan.faces.size(); ++face) {
    if (plan.faces[face].kind != ScanPathKind::rotary) continue;
    const bool is_c = plan.faces[face].turning_axis == machine.find_axis("C");
    (is_c ? by_c : by_a) += 1;
    // The other one stands still while nothing is in the way.
    const std::size_t still = machine.find_axis(is_c ? "A" : "C");
    const PlannedMove* last = nullptr;
    double at = 0;
    for (std::size_t k = 0; k < plan.moves.size(); ++k) {
      const PlannedMove& move = plan.moves[k];
      if (move.face != face || !move.measures || move.normal.dot(move.beam) < 1 - 1e-9) continue;
      const double now = std::remainder(plan.positions.axis[still][k], pi);
      if (last != nullptr && last->line == move.line) {
        EXPECT_LT(std::abs(std::remainder(now - at, pi)), 1e-6);
      }
      last = &move;
      at = now;
    }
  }
  EXPECT_EQ(by_c, 1U);
  EXPECT_EQ(by_a, 2U);
}

}  // namespace
}  // namespace abbe
