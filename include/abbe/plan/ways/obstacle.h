#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What carries an obstacle.
enum class ObstacleCarrier {
  base,   ///< the bed; the mesh is in the machine frame
  table,  ///< what the last workpiece-side axis carries; the mesh is in the workpiece frame
  axis    ///< what an axis carries; the mesh is in the machine frame, as it stands with every axis at zero
};

/// A body that the tool must not touch.
struct Obstacle {
  std::string name;   ///< for messages: "box 1", "fixture.stl"
  TriangleMesh mesh;  ///< mm; at least one triangle
  ObstacleCarrier carrier = ObstacleCarrier::base;
  std::size_t axis = 0;  ///< of ObstacleCarrier::axis: index into Machine::axes
};

/// A box with sides along the axes of its frame, triangles outwards.
/// @param from, to  opposite corners in any order, mm
TriangleMesh box_mesh(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// A ball of flat faces that encloses the given one, by 2 % of its radius at most, triangles outwards.
/// @param radius  mm, above zero
TriangleMesh ball_mesh(const Eigen::Vector3d& centre, double radius);

/// What stands for the tool and its holder: all points within `radius` of the line that begins in the functional point
/// and goes `length` towards the spindle (Machine::tool_direction). Zero and zero: the functional point alone.
struct ToolShape {
  double radius = 0;  ///< mm
  double length = 0;  ///< mm
};

}  // namespace abbe
