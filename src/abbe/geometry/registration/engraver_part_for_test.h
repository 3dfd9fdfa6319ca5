#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "abbe/geometry/fits/shapes.h"
#include "abbe/geometry/rigid_transform.h"

/// For tests: a part like that of Yin's laser engraver, and scans of it.
namespace abbe::engraver {

/// A cylinder segment between two planes.
inline std::vector<Shape> part() {
  Shape cylinder, top, side;
  cylinder.kind = ShapeKind::cylinder;
  cylinder.point = {75, -506, 0};
  cylinder.direction = Eigen::Vector3d::UnitZ();
  cylinder.radius = 528;
  top.kind = side.kind = ShapeKind::plane;
  top.point = {0, 0, 205};
  top.direction = Eigen::Vector3d::UnitZ();
  side.point = {155, 0, 0};
  side.direction = Eigen::Vector3d::UnitX();
  return {cylinder, top, side};
}

struct Scan {
  Eigen::Matrix3Xd points;  ///< [3, 450] mm, scanner's frame
  std::vector<std::size_t> labels;
};

/// @param noise     mm, of each coordinate
/// @param outliers  part of the points that stand off by 0.2 to 2.2 mm along y of the part
inline Scan scan_of(const RigidTransform& part_from_scan, double noise, double outliers, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0, noise > 0 ? noise : 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  Scan scan;
  scan.points.resize(3, 450);
  const RigidTransform back = part_from_scan.inverse();
  for (int i = 0; i < 450; ++i) {
    const std::size_t label = static_cast<std::size_t>(i % 3);
    const double x = 80 + 70 * uniform(generator), z = 130 + 70 * uniform(generator), depth = 30 * uniform(generator);
    const double y = -506 + std::sqrt(528.0 * 528.0 - (x - 75) * (x - 75));
    Eigen::Vector3d p = label == 0   ? Eigen::Vector3d(x, y, z)
                        : label == 1 ? Eigen::Vector3d(x, y - depth, 205)
                                     : Eigen::Vector3d(155, y - depth, z);
    if (noise > 0) p += Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
    if (uniform(generator) < outliers) p.y() += 0.2 + 2 * uniform(generator);
    scan.points.col(i) = back * p;
    scan.labels.push_back(label);
  }
  return scan;
}

}  // namespace abbe::engraver
