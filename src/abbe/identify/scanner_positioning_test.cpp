#include "abbe/identify/scanner_positioning.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
using Points = std::vector<Eigen::Vector3d>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

nlohmann::json reference() {
  std::ifstream file(std::string(ABBE_GOLDEN) + "/yin/positioning.json");
  return nlohmann::json::parse(file);
}

Points read_points(const std::string& name, std::vector<std::size_t>* labels = nullptr) {
  std::ifstream file(std::string(ABBE_GOLDEN) + "/yin/positioning_exact_" + name + ".csv");
  std::string line;
  std::getline(file, line);
  Points points;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    Eigen::Vector3d p;
    char comma = 0;
    std::size_t label = 0;
    cells >> p.x() >> comma >> p.y() >> comma >> p.z() >> comma >> label;
    points.push_back(p);
    if (labels != nullptr) labels->push_back(label);
  }
  EXPECT_FALSE(points.empty()) << name;
  return points;
}

PositioningScans exact_scans() {
  PositioningScans scans;
  scans.along_x = read_points("PX");
  scans.along_y = read_points("PY");
  scans.circles = {read_points("C1"), read_points("C2")};
  scans.sphere = read_points("S");
  scans.sphere_height = 95;
  scans.moved_since = {150, -60, 0};
  return scans;
}

/// The workpiece's surfaces: cylinder of Table A4, z = 205, x = 155.
std::vector<Shape> workpiece() {
  std::ifstream file(std::string(ABBE_GOLDEN) + "/yin/p0_A4_cylinder.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  Shape cylinder, top, side;
  cylinder.kind = ShapeKind::cylinder;
  cylinder.point = {json["cyl_axis_x"].get<double>(), json["cyl_axis_y"].get<double>(), 0};
  cylinder.direction = Eigen::Vector3d::UnitZ();
  cylinder.radius = json["R"];
  top.kind = side.kind = ShapeKind::plane;
  top.point = {0, 0, 205};
  top.direction = Eigen::Vector3d::UnitZ();
  side.point = {155, 0, 0};
  side.direction = Eigen::Vector3d::UnitX();
  return {cylinder, top, side};
}

RigidTransform transform_of(const nlohmann::json& rows) {
  RigidTransform t;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) t.rotation(i, k) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
    t.translation[i] = rows[static_cast<std::size_t>(i)][3];
  }
  return t;
}
Eigen::Vector3d vector_of(const nlohmann::json& v) {
  return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

Eigen::Matrix3Xd columns(const Points& points) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = points[i];
  return result;
}

void expect_near(const RigidTransform& a, const RigidTransform& b, double mm) {
  EXPECT_LT((a.translation - b.translation).norm(), mm);
  EXPECT_LT((a.rotation - b.rotation).norm(), 1e-12);
}

TEST(ScannerPositioning, EqualsTheReferenceInEveryStep) {
  const nlohmann::json exact = reference()["exact"];
  const ScannerPosition found = locate_scanner(exact_scans());
  ASSERT_EQ(found.status, PositioningStatus::ok) << found.reason;
  EXPECT_LT((found.x_direction - vector_of(exact["nx"])).norm(), 1e-12);
  EXPECT_LT((found.y_direction - vector_of(exact["ny"])).norm(), 1e-12);
  EXPECT_LT((found.axis_direction - vector_of(exact["L"])).norm(), 1e-12);
  EXPECT_LT((found.sphere_centre - vector_of(exact["os"])).norm(), 1e-9);
  EXPECT_LT((found.on_axis - vector_of(exact["osc"])).norm(), 1e-9);
  EXPECT_LT((found.table_from_scanner.rotation * found.on_axis - vector_of(exact["oR"])).norm(), 1e-9);
  expect_near(found.table_from_scanner, transform_of(exact["DMB"]), 1e-9);
  EXPECT_LT(found.axis_tilt.norm() + std::abs(found.squareness), 1e-12);

  std::vector<std::size_t> labels;
  const Points surface = read_points("M", &labels);
  const FineRegistration registered =
      register_to_features(columns(surface), workpiece(), labels, transform_of(reference()["setup"]["initial_DMW"]));
  ASSERT_EQ(registered.status, FineRegistrationStatus::ok);
  expect_near(registered.mesh_from_scan, transform_of(exact["DMW"]), 1e-9);
  const Placement placement = locate_workpiece(found, registered);
  expect_near(placement.table_from_workpiece.inverse(), transform_of(exact["DBW"]), 1e-9);
  const PositioningParameters table3 = positioning_parameters(placement, true);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(table3.translation[i], exact["par"][static_cast<std::size_t>(i)].get<double>(), 1e-9);
    EXPECT_NEAR(table3.angles[i] / kDegree, exact["par"][static_cast<std::size_t>(i + 3)].get<double>(), 1e-10);
  }
  // The other reading of Table 3 is another set of numbers, 1.7 mm apart in this case.
  const PositioningParameters other = positioning_parameters(placement, false);
  expect_near({rotation_xyz(other.angles), other.translation}, placement.table_from_workpiece, 1e-9);
  EXPECT_GT((other.translation + table3.translation).norm(), 0.1);
}

TEST(ScannerPositioning, PrintedSignsWouldMissTheTable) {
  // (17) with t_z = z_sR - z_p, (18) with + (x1 - x0): from the reference's own intermediate results.
  const nlohmann::json exact = reference()["exact"];
  const RigidTransform truth = transform_of(exact["DMB"]);
  const Eigen::Vector3d o = vector_of(exact["oR"]);
  const Eigen::Vector3d printed(150 - o.x(), -60 - o.y(), o.z() - 95);
  EXPECT_NEAR((printed - truth.translation).x(), 300, 1e-6);
  EXPECT_NEAR((printed - truth.translation).y(), -120, 1e-6);
  EXPECT_NEAR((printed - truth.translation).z(), 2 * (o.z() - 95), 1e-6);
}

TEST(ScannerPositioning, StatedCovarianceIsThatOfRepeatedMeasurements) {
  const PositioningScans exact = exact_scans();
  std::vector<std::size_t> labels;
  const Points all = read_points("M", &labels);
  Points third;
  std::vector<std::size_t> labels_of_third;
  for (std::size_t i = 0; i < all.size(); i += 3) {
    third.push_back(all[i]);
    labels_of_third.push_back(labels[i]);
  }
  const Eigen::Matrix3Xd surface = columns(third);
  const RigidTransform start = transform_of(reference()["exact"]["DMW"]);
  const Placement truth = {transform_of(reference()["exact"]["DBW"]).inverse()};
  const Eigen::Vector3d centre = vector_of(reference()["exact"]["os"]);
  RandomStream random(42);
  constexpr int kRuns = 250;
  double scanner_squares = 0, placement_squares = 0, parameter_squares = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto noise = [&](double sigma) -> Eigen::Vector3d {
      return sigma * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    };
    PositioningScans scans = exact;
    scans.target_noise = 0.010;
    scans.sphere_noise = 0.020;
    scans.height_noise = 0.005;
    for (Points* points : {&scans.along_x, &scans.along_y, &scans.circles[0], &scans.circles[1]}) {
      for (Eigen::Vector3d& p : *points) p += noise(0.010);
    }
    for (Eigen::Vector3d& p : scans.sphere) p += 0.020 * random.normal() * (p - centre).normalized();
    scans.sphere_height += 0.005 * random.normal();
    Eigen::Matrix3Xd scanned = surface;
    for (Eigen::Index i = 0; i < scanned.cols(); ++i) {
      scanned.col(i) += noise(0.020);
      if (random.uniform() < 0.05) scanned.col(i).z() -= random.uniform(0.2, 2);
    }
    const ScannerPosition found = locate_scanner(scans);
    ASSERT_EQ(found.status, PositioningStatus::ok) << found.reason;
    const FineRegistration registered = register_to_features(scanned, workpiece(), labels_of_third, start);
    ASSERT_EQ(registered.status, FineRegistrationStatus::ok);
    const auto motion = [](const RigidTransform& measured, const RigidTransform& from, const Eigen::Vector3d& at) {
      const RigidTransform off = measured * from.inverse();
      Eigen::Matrix<double, 6, 1> v;
      v << off * at - at, rotation_vector(off.rotation);
      return v;
    };
    const auto error =
        motion(found.table_from_scanner, transform_of(reference()["exact"]["DMB"]), Eigen::Vector3d::Zero());
    scanner_squares += error.dot(found.covariance.ldlt().solve(error)) / 6 / kRuns;
    const Placement placement = locate_workpiece(found, registered);
    const auto placed =
        motion(placement.table_from_workpiece, truth.table_from_workpiece, truth.table_from_workpiece.translation);
    placement_squares += placed.dot(placement.covariance->ldlt().solve(placed)) / 6 / kRuns;
    const PositioningParameters parameters = positioning_parameters(placement, true);
    Eigen::Matrix<double, 6, 1> six;
    const PositioningParameters exactly = positioning_parameters(truth, true);
    six << parameters.translation - exactly.translation, parameters.angles - exactly.angles;
    parameter_squares += six.dot(parameters.covariance.ldlt().solve(six)) / 6 / kRuns;
  }
  // Mean of chi-square over its degrees of freedom: 1 within 3 times sqrt(2 / (6 * 250)) = 0.11.
  EXPECT_NEAR(scanner_squares, 1, 0.12);
  EXPECT_NEAR(placement_squares, 1, 0.12);
  EXPECT_NEAR(parameter_squares, placement_squares, 0.01);
}

TEST(ScannerPositioning, WhatContradictsItselfIsRefused) {
  PositioningScans scans = exact_scans();
  scans.turned_positively = false;
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::inconsistent);
  scans = exact_scans();
  for (Points& circle : scans.circles) std::reverse(circle.begin(), circle.end());
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::inconsistent);
  scans.turned_positively = false;
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::ok);
  scans = exact_scans();
  for (Points& circle : scans.circles) {
    // Half turns: either sense.
    const Eigen::Vector3d far = circle[6];
    circle = {circle[0], far, circle[0], far, circle[0]};
  }
  EXPECT_NE(locate_scanner(scans).status, PositioningStatus::ok);
  scans = exact_scans();
  scans.along_x.resize(1);
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::bad_line);
  scans = exact_scans();
  scans.along_y = scans.along_x;
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::bad_line);
  scans = exact_scans();
  for (Points& circle : scans.circles) circle.resize(1);
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::bad_circles);
  scans = exact_scans();
  scans.sphere.resize(3);
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::bad_sphere);
}

}  // namespace
}  // namespace abbe
